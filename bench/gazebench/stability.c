/* gazebench stability: where methods fail, on a scene of the user's and their driver. */
#include "bench/stability/stability.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>

#include "bench/gazebench/gazebench.h"
#include "bench/study/stage.h"
#include "render/plan/method.h"
#include "render/scene/scene.h"
#include "render/scene/techniques.h"

#define GZ_LOG_MODULE "gazebench"

enum { LIST_SIZE = 1024, CHURN_FRAMES = 10000, VARIANTS_MAX = 64, ROWS_MAX = 32, TEXT_SIZE = 256 };

struct settings {
	struct gz_command_common common;
	char backends[LIST_SIZE];
	char methods[LIST_SIZE];
	char rows[LIST_SIZE];
	int size[2];
	char out[GZ_PATH_SIZE];
	bool json;
};

static const struct gz_option options[] = {
	GZ_COMMAND_HELP_OPTION,
	{ .key = "backend",
	  .type = GZ_OPTION_STRING,
	  .offset = offsetof(struct settings, backends),
	  .max = LIST_SIZE,
	  .preset = "",
	  .help = "backends to test: cpu,gl (default: all that run here)" },
	{ .key = "methods",
	  .type = GZ_OPTION_STRING,
	  .offset = offsetof(struct settings, methods),
	  .max = LIST_SIZE,
	  .preset = "",
	  .help = "METHOD[:OPTION=VALUE…],…, options of [foveation] and [render] (default: all "
		  "methods)" },
	{ .key = "rows",
	  .type = GZ_OPTION_STRING,
	  .offset = offsetof(struct settings, rows),
	  .max = LIST_SIZE,
	  .preset = "",
	  .help = "rows to run: tremble,border (default: all)" },
	{ .key = "size",
	  .type = GZ_OPTION_SIZE,
	  .offset = offsetof(struct settings, size),
	  .min = 1,
	  .max = GZ_IMAGE_SIDE_MAX,
	  .preset = "960x540",
	  .help = "picture size, px" },
	{ .key = "out",
	  .type = GZ_OPTION_STRING,
	  .offset = offsetof(struct settings, out),
	  .max = GZ_PATH_SIZE,
	  .preset = "",
	  .help = "folder for pictures of failures, made when needed (default: NAME-stability)" },
	{ .key = "json",
	  .type = GZ_OPTION_BOOL,
	  .offset = offsetof(struct settings, json),
	  .preset = "false",
	  .help = "print the table as JSON" },
};

/* A method as it was asked for. */
struct variant {
	char text[TEXT_SIZE];
	struct gz_variant_settings settings;
	bool every_step_rule; /* it does not set its own */
};

/* A command's run. */
struct session {
	struct settings settings;
	const struct gz_log *log;
	struct gz_scene scene;
	struct gz_stability_bench *bench;
	struct variant variants[VARIANTS_MAX];
	int variant_count;
	const char *backend; /* in use */
	int held, failed, refused, apart;
	bool printed; /* a row */
	/* What became of the rows of the backend in use: "" where they did not run. */
	const char *verdicts[ROWS_MAX][VARIANTS_MAX];
};

/* Whether a list "a,b" names something; an empty one names everything. */
static bool lists(const char *list, const char *name)
{
	char item[LIST_SIZE];
	bool listed = *list == '\0';
	while (!listed && gz_list_next(&list, item, sizeof item))
		listed = strcmp(item, name) == 0;
	return listed;
}

typedef const char *name_at(size_t index);

static const char *backend_at(size_t index)
{
	return gz_techniques[0]->backends[index];
}

static const char *row_at(size_t index)
{
	return gz_stability_rows[index].name;
}

/* Refuse unknown names and list the known ones. */
static bool check_list(const char *list, const char *what, name_at *at, const struct gz_log *log)
{
	char item[LIST_SIZE], known[LIST_SIZE] = "";
	for (size_t i = 0; at(i); i++) {
		const size_t used = strlen(known);
		snprintf(known + used, sizeof known - used, "%s%s", i ? ", " : "", at(i));
	}
	while (list && *list && gz_list_next(&list, item, sizeof item)) {
		size_t i = 0;
		while (at(i) && strcmp(at(i), item) != 0)
			i++;
		if (!at(i)) {
			gz_err(log, "--%s: there is no \"%s\": there are %s", what, item, known);
			return false;
		}
	}
	return true;
}

static bool check_lists(const struct settings *settings, const struct gz_log *log)
{
	return check_list(settings->backends, "backend", backend_at, log) &&
	       check_list(settings->rows, "rows", row_at, log);
}

/* The scene's file name without its ending, for the folder. */
static void default_folder(const char *scene, char *out, size_t size)
{
	const char *slash = strrchr(scene, '/');
	const char *name = slash ? slash + 1 : scene;
	const char *dot = strrchr(name, '.');
	snprintf(out, size, "%.*s-stability", dot && dot > name ? (int)(dot - name) : 200, name);
}

/* The picture of a failure; its path, or "" without one. */
static enum gz_result write_picture(struct session *session, const struct gz_stability_row *row,
				    const char *method, const struct gz_stability_outcome *outcome,
				    char *out_path, size_t size)
{
	const char *folder = session->settings.out;
	out_path[0] = '\0';
	if (outcome->verdict != GZ_STABILITY_FAILS || !outcome->worst.got_crop.pixels)
		return GZ_OK;
	if (mkdir(folder, 0777) != 0 && errno != EEXIST) {
		gz_err(session->log, "%s: cannot be made: %s; --out names another folder", folder,
		       strerror(errno));
		return GZ_ERR_IO;
	}
	const int length = snprintf(out_path, size, "%s/%s-%s-%s.png", folder, session->backend,
				    row->name, method);
	if (length >= (int)size) {
		gz_err(session->log, "%s: the path is too long", folder);
		return GZ_ERR_IO;
	}
	/* An option's value may be a path. */
	for (char *c = out_path + strlen(folder) + 1; *c; c++)
		if (*c == '/' || *c == ':')
			*c = '_';
	return gz_stability_write_picture(outcome, out_path, session->log);
}

static void print_row_text(const char *method, const struct gz_stability_outcome *outcome,
			   const char *picture)
{
	const struct gz_stability_pixel *worst = &outcome->worst;
	printf("  %-9s %-14s ", method, gz_stability_verdict_text(outcome->verdict));
	for (int i = 0; i < outcome->number_count; i++)
		printf("%s%.4g %s (at most %.4g)", i ? ", " : " ", outcome->numbers[i].value,
		       outcome->numbers[i].what, outcome->numbers[i].bound);
	printf("%s%s\n", outcome->number_count ? "" : " ",
	       outcome->number_count ? "" : outcome->note);
	if (outcome->note[0] && outcome->number_count)
		printf("    %s\n", outcome->note);
	if (outcome->verdict != GZ_STABILITY_FAILS)
		return;
	for (int i = 0; i < outcome->number_count; i++)
		if (!(outcome->numbers[i].value <= outcome->numbers[i].bound))
			printf("    %.4g: %s\n", outcome->numbers[i].value,
			       outcome->numbers[i].where);
	if (worst->known)
		printf("    worst at %d, %d: got %d %d %d, wanted %d %d %d\n", worst->x, worst->y,
		       worst->got[0], worst->got[1], worst->got[2], worst->wanted[0],
		       worst->wanted[1], worst->wanted[2]);
	if (picture[0])
		printf("    %s\n", picture);
}

static void print_json_text(const char *text)
{
	putchar('"');
	for (const unsigned char *c = (const unsigned char *)text; *c; c++) {
		if (*c == '"' || *c == '\\')
			printf("\\%c", *c);
		else if (*c < 32)
			printf("\\u%04x", *c);
		else
			putchar(*c);
	}
	putchar('"');
}

static void print_json_pixel(const struct gz_stability_pixel *worst)
{
	if (worst->known)
		printf(", \"worst\": {\"x\": %d, \"y\": %d, \"got\": [%d, %d, %d], \"wanted\": "
		       "[%d, %d, %d]}",
		       worst->x, worst->y, worst->got[0], worst->got[1], worst->got[2],
		       worst->wanted[0], worst->wanted[1], worst->wanted[2]);
}

/* JSON has no NaN. */
static void print_json_number(const struct gz_stability_number *number)
{
	printf("{\"what\": ");
	print_json_text(number->what);
	if (isfinite(number->value))
		printf(", \"value\": %.9g", number->value);
	else
		printf(", \"value\": null");
	printf(", \"bound\": %.9g, \"where\": ", number->bound);
	print_json_text(number->where);
	printf("}");
}

static void print_rows_json(const struct session *session, const struct gz_stability_row *row,
			    const char *method, const struct gz_stability_outcome *outcome,
			    const char *picture)
{
	printf("%s\n  {\"backend\": \"%s\", \"row\": \"%s\", \"method\": \"%s\", \"holds\": ",
	       session->printed ? "," : "", session->backend, row->name, method);
	print_json_text(row->holds);
	printf(", \"verdict\": \"%s\", \"numbers\": [",
	       gz_stability_verdict_text(outcome->verdict));
	for (int i = 0; i < outcome->number_count; i++) {
		printf("%s", i ? ", " : "");
		print_json_number(&outcome->numbers[i]);
	}
	printf("]");
	print_json_pixel(&outcome->worst);
	printf(", \"note\": ");
	print_json_text(outcome->note);
	if (picture[0]) {
		printf(", \"picture\": ");
		print_json_text(picture);
	}
	printf("}");
}

static void count_rows(struct session *session, enum gz_stability_verdict verdict)
{
	session->held += verdict == GZ_STABILITY_HOLDS;
	session->failed += verdict == GZ_STABILITY_FAILS;
	session->refused += verdict == GZ_STABILITY_REFUSED;
	session->apart += verdict == GZ_STABILITY_APART;
}

/* Keep the verdict for the table; a row that runs once a backend is about all methods. */
static void keep_verdict(struct session *session, const struct gz_stability_row *row, int variant,
			 enum gz_stability_verdict verdict)
{
	static const char *const words[] = {
		[GZ_STABILITY_HOLDS] = "holds",
		[GZ_STABILITY_FAILS] = "FAILS",
		[GZ_STABILITY_REFUSED] = "refused",
		[GZ_STABILITY_APART] = "-",
	};
	const int last = row->every_method ? session->variant_count - 1 : variant;
	for (int i = variant; i <= last; i++)
		session->verdicts[row - gz_stability_rows][i] = words[verdict];
}

/* What held with the backend in use: a line for each row, a column for each method. */
static void print_verdicts(const struct session *session)
{
	printf("\n%-12s", session->backend);
	for (int i = 0; i < session->variant_count; i++)
		printf("  %-*s", i < session->variant_count - 1 ? 7 : 0, session->variants[i].text);
	for (const struct gz_stability_row *row = gz_stability_rows; row->name; row++) {
		if (!session->verdicts[row - gz_stability_rows][0])
			continue;
		printf("\n  %-10s", row->name);
		for (int i = 0; i < session->variant_count; i++) {
			const char *verdict = session->verdicts[row - gz_stability_rows][i];
			const int width = (int)fmax(7, (double)strlen(session->variants[i].text));
			const bool last = i == session->variant_count - 1;
			printf("  %-*s", last ? 0 : width, verdict ? verdict : "");
		}
	}
	printf("\n\n");
}

static enum gz_result run_row(struct session *session, const struct gz_stability_row *row,
			      int variant)
{
	const char *method = row->every_method ? "all" : session->variants[variant].text;
	struct gz_stability_outcome outcome = { 0 };
	char picture[GZ_PATH_SIZE];
	enum gz_result result = gz_stability_run(session->bench, row, &outcome);
	if (result != GZ_OK)
		gz_err(session->log, "row %s cannot be run: %s", row->name, gz_result_text(result));
	if (result == GZ_OK)
		result = write_picture(session, row, method, &outcome, picture, sizeof picture);
	if (result == GZ_OK) {
		if (session->settings.json)
			print_rows_json(session, row, method, &outcome, picture);
		else
			print_row_text(method, &outcome, picture);
		session->printed = true;
		fflush(stdout);
		count_rows(session, outcome.verdict);
		keep_verdict(session, row, variant, outcome.verdict);
	}
	gz_stability_outcome_free(&outcome);
	return result;
}

static enum gz_result run_variants(struct session *session, const struct gz_stability_row *row)
{
	enum gz_result result = GZ_OK;
	if (!session->settings.json)
		printf("%s %s: %s\n", session->backend, row->name, row->holds);
	for (int i = 0; i < session->variant_count && result == GZ_OK; i++) {
		const struct variant *variant = &session->variants[i];
		if (gz_command_interrupted())
			return GZ_ERR_CANCELLED;
		gz_stability_use_method(session->bench, &variant->settings.foveation,
					&variant->settings.rays, variant->every_step_rule);
		result = run_row(session, row, i);
		if (row->every_method)
			break;
	}
	return result;
}

static enum gz_result run_backend(struct session *session)
{
	/* gl's description has its own name. */
	const char *described = gz_stability_describe(session->bench);
	const bool named = strncmp(described, session->backend, strlen(session->backend)) == 0;
	if (!session->settings.json)
		printf("%s%s%s\n", named ? "" : session->backend, named ? "" : ": ", described);
	memset(session->verdicts, 0, sizeof session->verdicts);
	enum gz_result result = GZ_OK;
	for (const struct gz_stability_row *row = gz_stability_rows; row->name && result == GZ_OK;
	     row++)
		if (lists(session->settings.rows, row->name))
			result = run_variants(session, row);
	if (!session->settings.json)
		print_verdicts(session);
	return result;
}

/* Backends that do not run here are left out, unless they were asked for. */
static enum gz_result run_backends(struct session *session)
{
	enum gz_result result = GZ_OK;
	int ran = 0;
	for (size_t i = 0; gz_techniques[0]->backends[i] && result == GZ_OK; i++) {
		session->backend = gz_techniques[0]->backends[i];
		if (!lists(session->settings.backends, session->backend))
			continue;
		const enum gz_result runs =
			gz_stability_use_backend(session->bench, session->backend);
		if (runs != GZ_OK && session->settings.backends[0])
			return runs; /* logged */
		if (runs == GZ_OK)
			result = run_backend(session);
		ran += runs == GZ_OK;
	}
	return ran ? result : GZ_ERR_UNSUPPORTED;
}

static enum gz_result add_checked_method(struct session *session, const char *scene,
					 const char *text)
{
	const struct gz_variant_settings of_scene = { session->scene.settings.foveation,
						      session->scene.settings.rays };
	if (session->variant_count == VARIANTS_MAX) {
		gz_err(session->log, "--methods: more than %d", VARIANTS_MAX);
		return GZ_ERR_INVAL;
	}
	struct variant *variant = &session->variants[session->variant_count++];
	enum gz_result result = gz_variant_parse(text, &of_scene, session->log, &variant->settings);
	if (result != GZ_OK)
		return result;
	snprintf(variant->text, sizeof variant->text, "%s", text);
	variant->every_step_rule = !strstr(text, "step_rule=");
	/* The method table gets the bench's table if the user gives none. */
	struct gz_foveation *foveation = &variant->settings.foveation;
	if (foveation->table_file[0])
		result = gz_scene_load_table(scene, session->log, foveation);
	return result == GZ_ERR_INVAL ? GZ_ERR_FORMAT : result; /* the named file is at fault */
}

static enum gz_result add_variants(struct session *session, const char *scene)
{
	const char *list = session->settings.methods;
	char text[TEXT_SIZE];
	enum gz_result result = GZ_OK;
	if (*list == '\0')
		for (int i = 0; i < GZ_METHOD_COUNT && result == GZ_OK; i++)
			result = add_checked_method(session, scene, gz_method_names[i]);
	else
		while (result == GZ_OK && gz_list_next(&list, text, sizeof text))
			result = add_checked_method(session, scene, text);
	return result;
}

static enum gz_result make_bench(struct session *session)
{
	const struct settings *settings = &session->settings;
	const struct gz_scene_settings *scene = &session->scene.settings;
	const struct gz_stability_settings of_bench = {
		.scene = { .volume = &session->scene.volume,
			   .transfer = &session->scene.transfer,
			   .camera = scene->camera,
			   .rays = scene->rays },
		.display = session->scene.has_display
				   ? scene->display
				   : gz_display_default(settings->size[0], settings->size[1]),
		.width = settings->size[0],
		.height = settings->size[1],
		.churn_frames = CHURN_FRAMES,
		.log = session->log,
	};
	return gz_stability_create(&of_bench, &session->bench);
}

static int run_rows(struct session *session)
{
	gz_command_catch_signals();
	if (session->settings.json)
		printf("[");
	const enum gz_result result = run_backends(session);
	if (session->settings.json)
		printf("\n]\n");
	else
		printf("%d held, %d failed, %d refused, %d do not apply\n", session->held,
		       session->failed, session->refused, session->apart);
	if (result == GZ_ERR_CANCELLED)
		gz_err(session->log,
		       "interrupted: the rows above are complete, the others are missing");
	if (result != GZ_OK)
		return GAZEBENCH_FAILED;
	return session->failed ? GAZEBENCH_UNSTABLE : GAZEBENCH_DONE;
}

static int run_session(struct session *session, const char *path)
{
	if (!session->settings.out[0])
		default_folder(path, session->settings.out, sizeof session->settings.out);
	if (gz_scene_load(path, NULL, session->log, &session->scene) != GZ_OK)
		return GAZEBENCH_FAILED;
	const enum gz_result called = add_variants(session, path);
	if (called != GZ_OK)
		return called == GZ_ERR_INVAL ? GAZEBENCH_USAGE : GAZEBENCH_FAILED;
	if (make_bench(session) != GZ_OK)
		return GAZEBENCH_FAILED;
	return run_rows(session);
}

static int run_stability(int argc, char *const *argv, const struct gz_log *log)
{
	static struct session session;
	struct gz_operands operands;
	session.log = log;
	int status = gz_command_read_arguments(&gazebench_stability, argc, argv, log,
					       &session.settings, &operands);
	if (status != GZ_COMMAND_GO_ON)
		return status;
	if (operands.count != 1) {
		gz_err(log, "give one scene: gazebench stability SCENE");
		return GAZEBENCH_USAGE;
	}
	if (!check_lists(&session.settings, log))
		return GAZEBENCH_USAGE;
	status = run_session(&session, operands.items[0]);
	gz_stability_destroy(&session.bench);
	gz_scene_free(&session.scene);
	return status;
}

const struct gz_command gazebench_stability = {
	.program = "gazebench",
	.name = "stability",
	.operands = "SCENE",
	.operands_max = 1,
	.summary = "check, on a scene, where foveated methods fail",
	.details =
		"Prints a line for each row, method and backend: whether it holds, the measured "
		"value and its\n"
		"bound. Below a failure: what was rendered, the worst pixel, and the path of a "
		"picture\n"
		"(got, wanted, difference). A table of what held follows at the end of each "
		"backend.\n"
		"Rows about odd volumes use volumes of their own. docs/gazebench.md explains the "
		"rows.\n"
		"Exits with 4 if a row fails.\n",
	.options = options,
	.option_count = sizeof options / sizeof options[0],
	.run = run_stability,
};
