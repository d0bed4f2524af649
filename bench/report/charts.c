#include "bench/report/charts.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <spawn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#include "protocol/gaze.h"

#define GZ_LOG_MODULE "report"

/* The scripts of charts/, embedded. */
extern const char gz_chart_common_gp[], gz_chart_curves_gp[], gz_chart_heat_gp[],
	gz_chart_boxes_gp[];

static const struct {
	const char *file, *text;
} scripts[] = {
	{ "common.gp", gz_chart_common_gp },
	{ "curves.gp", gz_chart_curves_gp },
	{ "heat.gp", gz_chart_heat_gp },
	{ "boxes.gp", gz_chart_boxes_gp },
};

/* ---- running gnuplot ---- */

/* Variables that a child needs to find its parts. */
static const char *const kept[] = { "PATH", "HOME", "LD_LIBRARY_PATH", "XDG_CACHE_HOME" };

enum { KEPT = sizeof kept / sizeof kept[0], VARIABLE_SIZE = 8192 };

static enum gz_result spawn_child(const char *folder, char *const *arguments, const char *output,
				  char *const *environment, pid_t *out_pid)
{
	posix_spawn_file_actions_t actions;
	if (posix_spawn_file_actions_init(&actions) != 0)
		return GZ_ERR_NO_MEM;
	posix_spawn_file_actions_addchdir_np(&actions, folder);
	posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
	posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, output,
					 O_WRONLY | O_CREAT | O_TRUNC, 0666);
	posix_spawn_file_actions_adddup2(&actions, STDOUT_FILENO, STDERR_FILENO);
	const int error =
		posix_spawnp(out_pid, arguments[0], &actions, NULL, arguments, environment);
	posix_spawn_file_actions_destroy(&actions);
	if (error == 0)
		return GZ_OK;
	return error == ENOENT || error == EACCES || error == ENOTDIR ? GZ_ERR_NOT_FOUND
								      : GZ_ERR_IO;
}

enum gz_result gz_child_run(const char *folder, char *const *arguments, const char *output,
			    int *out_status)
{
	char variables[KEPT][VARIABLE_SIZE], locale[] = "LC_ALL=C.UTF-8";
	char *environment[KEPT + 2] = { locale };
	int count = 1;
	for (int i = 0; i < KEPT; i++) {
		const char *value = getenv(kept[i]);
		if (value &&
		    snprintf(variables[i], VARIABLE_SIZE, "%s=%s", kept[i], value) < VARIABLE_SIZE)
			environment[count++] = variables[i];
	}
	pid_t pid;
	int status;
	const enum gz_result result = spawn_child(folder, arguments, output, environment, &pid);
	if (result != GZ_OK)
		return result;
	while (waitpid(pid, &status, 0) < 0)
		if (errno != EINTR)
			return GZ_ERR_IO;
	*out_status = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
	return GZ_OK;
}

struct gz_canvas gz_canvas_of(enum gz_canvas_kind kind)
{
	if (kind == GZ_CANVAS_NARROW)
		return (struct gz_canvas) { kind, 360, 340, 52, 12, 34, 48, 13 };
	return (struct gz_canvas) { kind, 1000, 500, 70, 24, 40, 56, 16 };
}

void gz_charts_path(const struct gz_charts *charts, const char *file, char out_path[GZ_PATH_SIZE])
{
	if (snprintf(out_path, GZ_PATH_SIZE, "%s/%s", charts->work, file) >= GZ_PATH_SIZE)
		out_path[0] = '\0'; /* opening it fails and says so */
}

void gz_chart_add_cell(struct gz_text *table, const char *text)
{
	for (; *text; text++) {
		const char byte = (unsigned char)*text < ' ' || *text == '"' ? ' ' : *text;
		gz_text_add_bytes(table, &byte, 1);
	}
}

void gz_chart_set_text(struct gz_text *settings, const char *name, const char *text)
{
	gz_text_add(settings, "%s = '", name);
	for (; *text; text++) {
		const char byte = (unsigned char)*text < ' ' ? ' ' : *text;
		gz_text_add_bytes(settings, &byte, 1);
		if (byte == '\'') /* a quote within single quotes is two; nothing else counts */
			gz_text_add_bytes(settings, &byte, 1);
	}
	gz_text_add(settings, "'\n");
}

static enum gz_result write_scripts(const struct gz_charts *charts)
{
	enum gz_result result = GZ_OK;
	for (size_t i = 0; i < sizeof scripts / sizeof scripts[0] && result == GZ_OK; i++) {
		char path[GZ_PATH_SIZE];
		struct gz_text text = { 0 };
		gz_charts_path(charts, scripts[i].file, path);
		gz_text_add(&text, "%s", scripts[i].text);
		result = gz_text_write(&text, path, charts->log);
		gz_text_free(&text);
	}
	return result;
}

static enum gz_result look_for_gnuplot(struct gz_charts *charts)
{
	char program[] = "gnuplot", version[] = "--version";
	char *const arguments[] = { program, version, NULL };
	int status;
	const enum gz_result result = gz_child_run(charts->work, arguments, "said.txt", &status);
	if (result == GZ_ERR_NOT_FOUND) {
		gz_warn(charts->log, "gnuplot is not installed: there are no charts; install "
				     "gnuplot-nox and run the same command again");
		return GZ_OK;
	}
	charts->available = result == GZ_OK && status == 0;
	if (!charts->available)
		gz_warn(charts->log, "gnuplot does not run: there are no charts");
	return GZ_OK;
}

enum gz_result gz_charts_open(const char *folder, const struct gz_log *log,
			      struct gz_charts *out_charts)
{
	struct gz_charts charts = { .log = log };
	if (snprintf(charts.folder, sizeof charts.folder, "%s", folder) >=
		    (int)sizeof charts.folder ||
	    snprintf(charts.work, sizeof charts.work, "%s/charts-XXXXXX", folder) >=
		    (int)sizeof charts.work) {
		gz_err(log, "%s: the path is too long", folder);
		return GZ_ERR_IO;
	}
	if (!mkdtemp(charts.work)) {
		gz_err(log, "%s: cannot be written to: %s", folder, strerror(errno));
		return GZ_ERR_IO;
	}
	enum gz_result result = look_for_gnuplot(&charts);
	if (result == GZ_OK && charts.available)
		result = write_scripts(&charts);
	if (result == GZ_OK)
		*out_charts = charts;
	else
		gz_charts_close(&charts);
	return result;
}

static void remove_folder(const char *path)
{
	DIR *folder = opendir(path);
	const struct dirent *entry;
	while (folder && (entry = readdir(folder)))
		if (strcmp(entry->d_name, ".") != 0 && strcmp(entry->d_name, "..") != 0)
			unlinkat(dirfd(folder), entry->d_name, 0);
	if (folder)
		closedir(folder);
	rmdir(path);
}

void gz_charts_close(struct gz_charts *charts)
{
	if (charts->work[0])
		remove_folder(charts->work);
	for (size_t i = 0; i < charts->count; i++)
		for (int kind = 0; kind < GZ_CANVAS_KINDS; kind++)
			free(charts->charts[i].svg[kind]);
	free(charts->charts);
	*charts = (struct gz_charts) { 0 };
}

static struct gz_chart *find(const struct gz_charts *charts, const char *name)
{
	for (size_t i = 0; i < charts->count; i++)
		if (strcmp(charts->charts[i].name, name) == 0)
			return &charts->charts[i];
	return NULL;
}

const struct gz_chart *gz_charts_find(const struct gz_charts *charts, const char *name)
{
	return find(charts, name);
}

static struct gz_chart *find_or_add(struct gz_charts *charts, const char *name)
{
	struct gz_chart *chart = find(charts, name);
	if (chart)
		return chart;
	struct gz_chart *grown =
		realloc(charts->charts, (charts->count + 1) * sizeof charts->charts[0]);
	if (!grown)
		return NULL;
	charts->charts = grown;
	chart = &charts->charts[charts->count++];
	*chart = (struct gz_chart) { 0 };
	snprintf(chart->name, sizeof chart->name, "%s", name);
	return chart;
}

static enum gz_result write_input(const struct gz_charts *charts, const struct gz_canvas *canvas,
				  const struct gz_text *settings, const struct gz_text *table)
{
	char path[GZ_PATH_SIZE];
	struct gz_text all = { 0 };
	gz_text_add(&all,
		    "canvas = '%s'\nwidth = %d\nheight = %d\nleft = %d\nright = %d\ntop = %d\n"
		    "bottom = %d\nfont_px = %d\nink = '#%06x'\ngrid = '#%06x'\nmute = '#%06x'\n"
		    "pale = '#%06x'\npage = '#%06x'\n",
		    canvas->kind == GZ_CANVAS_PNG ? "png" : "svg", canvas->width, canvas->height,
		    canvas->left, canvas->right, canvas->top, canvas->bottom, canvas->font_px,
		    GZ_COLOUR_INK, GZ_COLOUR_GRID, GZ_COLOUR_MUTE, GZ_COLOUR_PALE, GZ_COLOUR_PAGE);
	gz_text_add_bytes(&all, settings->bytes ? settings->bytes : "", settings->length);
	gz_charts_path(charts, "settings.gp", path);
	enum gz_result result = gz_text_write(&all, path, charts->log);
	gz_text_free(&all);
	gz_charts_path(charts, "data.tsv", path);
	if (result == GZ_OK)
		result = gz_text_write(table, path, charts->log);
	return result;
}

/* Its first line that says something. */
static void log_what_it_said(const struct gz_charts *charts, const char *name)
{
	char path[GZ_PATH_SIZE];
	struct gz_text said = { 0 };
	gz_charts_path(charts, "said.txt", path);
	if (gz_text_add_file(&said, path) != GZ_OK || said.length == 0)
		gz_text_add(&said, "it does not say why");
	const char *line = said.bytes + strspn(said.bytes, " ^\n");
	gz_err(charts->log, "gnuplot cannot draw %s: %.*s", name, (int)strcspn(line, "\n"), line);
	gz_text_free(&said);
}

/* Keep an SVG for the page, and the wide one as a file; move a PNG where it belongs. */
static enum gz_result take_output(struct gz_charts *charts, const char *name,
				  enum gz_canvas_kind kind)
{
	char from[GZ_PATH_SIZE], to[GZ_PATH_SIZE * 2 + 8];
	gz_charts_path(charts, "chart.out", from);
	snprintf(to, sizeof to, "%s/%s.%s", charts->folder, name,
		 kind == GZ_CANVAS_PNG ? "png" : "svg");
	if (kind == GZ_CANVAS_PNG) {
		if (rename(from, to) == 0)
			return GZ_OK;
		gz_err(charts->log, "%s: cannot be written: %s", to, strerror(errno));
		return GZ_ERR_IO;
	}
	struct gz_text svg = { 0 }, styled = { 0 };
	enum gz_result result = gz_text_add_file(&svg, from);
	if (result == GZ_OK && svg.length > 0)
		gz_palette_add_dark(&styled, svg.bytes);
	gz_text_free(&svg);
	if (result == GZ_OK && kind == GZ_CANVAS_WIDE)
		result = gz_text_write(&styled, to, charts->log);
	struct gz_chart *chart = result == GZ_OK ? find_or_add(charts, name) : NULL;
	if (!chart || styled.failed) {
		gz_text_free(&styled);
		return result == GZ_OK ? GZ_ERR_NO_MEM : result;
	}
	free(chart->svg[kind]);
	chart->svg[kind] = styled.bytes;
	return GZ_OK;
}

enum gz_result gz_charts_draw(struct gz_charts *charts, const char *script, const char *name,
			      const struct gz_canvas *canvas, const struct gz_text *settings,
			      const struct gz_text *table)
{
	if (!charts->available)
		return GZ_OK;
	enum gz_result result = write_input(charts, canvas, settings, table);
	if (result != GZ_OK)
		return result;
	char program[] = "gnuplot", defaults[] = "--default-settings", file[64];
	snprintf(file, sizeof file, "%s", script);
	char *const arguments[] = { program, defaults, file, NULL };
	int status;
	result = gz_child_run(charts->work, arguments, "said.txt", &status);
	if (result == GZ_OK && status != 0)
		result = GZ_ERR_IO;
	if (result == GZ_OK)
		return take_output(charts, name, canvas->kind);
	log_what_it_said(charts, name);
	return result;
}

/* ---- colours ---- */

struct entry {
	const char *method; /* NULL: none */
	uint32_t light, dark;
	int point;
};

static const struct entry entries[] = {
	{ "standard", 0x3d444d, 0xc9d1d9, 5 }, { "acuity", 0xb84700, 0xff9a52, 7 },
	{ "mdc", 0x0067a3, 0x62bbf2, 9 },      { "ddc", 0x00755a, 0x41cfa4, 13 },
	{ "mdc3", 0x7c3a9a, 0xd6a1f0, 11 },    { "uniform", 0x6b5f00, 0xd9c64a, 15 },
	{ "table", 0xa6265e, 0xf590b8, 4 },    { "contrast", 0x3457c9, 0x9db7ff, 3 },
	{ NULL, GZ_COLOUR_INK, 0xe6e9ed, 0 },  { NULL, GZ_COLOUR_GRID, 0x2c3239, 0 },
	{ NULL, GZ_COLOUR_MUTE, 0x9aa4af, 0 }, { NULL, GZ_COLOUR_PALE, 0x47505a, 0 },
	{ NULL, GZ_COLOUR_PAGE, 0x14171b, 0 },
};

struct gz_method_look gz_method_look(const char *method)
{
	for (size_t i = 0; i < sizeof entries / sizeof entries[0]; i++)
		if (entries[i].method && strcmp(entries[i].method, method) == 0)
			return (struct gz_method_look) { entries[i].light, entries[i].point };
	return (struct gz_method_look) { GZ_COLOUR_MUTE, 6 };
}

/* gnuplot writes a colour in two ways. */
static void add_rule(struct gz_text *out, const char *attribute, uint32_t light, uint32_t dark)
{
	const int r = (int)(light >> 16), g = (int)(light >> 8 & 255), b = (int)(light & 255);
	gz_text_add(out,
		    "[%s=\"rgb(%3d, %3d, %3d)\"],[%s=\"rgb(%d,%d,%d)\"]"
		    "{%s:#%06x}\n",
		    attribute, r, g, b, attribute, r, g, b, attribute, dark);
}

void gz_palette_add_dark(struct gz_text *out, const char *svg)
{
	const char *end = strstr(svg, "<svg");
	end = end ? strchr(end, '>') : NULL;
	if (!end) {
		gz_text_add(out, "%s", svg);
		return;
	}
	gz_text_add_bytes(out, svg, (size_t)(end + 1 - svg));
	gz_text_add(out, "\n<style>@media (prefers-color-scheme:dark){\n");
	for (size_t i = 0; i < sizeof entries / sizeof entries[0]; i++) {
		add_rule(out, "fill", entries[i].light, entries[i].dark);
		add_rule(out, "stroke", entries[i].light, entries[i].dark);
		add_rule(out, "color", entries[i].light, entries[i].dark);
	}
	gz_text_add(out, "}</style>%s", end + 1);
}
