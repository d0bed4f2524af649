/* What a study ran on, and how it is run again. */
#include <stdio.h>
#include <string.h>

#include "base/text.h"
#include "bench/report/names.h"
#include "bench/report/page_parts.h"

static void add_fact(const char *name, const char *text, struct gz_text *out)
{
	if (!text[0])
		return;
	gz_text_add(out, "<dt>");
	gz_text_add_escaped(out, name);
	gz_text_add(out, "</dt><dd>");
	gz_text_add_escaped(out, text);
	gz_text_add(out, "</dd>\n");
}

static void add_count(const char *name, size_t count, struct gz_text *out)
{
	gz_text_add(out, "<dt>%s</dt><dd>%zu</dd>\n", name, count);
}

/* An argument as a shell takes it back. */
static void add_argument(const char *text, struct gz_text *out)
{
	static const char plain[] = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789"
				    "_-./:=,+@%";
	char one[2] = "";
	if (text[0] && strspn(text, plain) == strlen(text)) {
		gz_text_add_escaped(out, text);
		return;
	}
	gz_text_add_escaped(out, "'");
	for (; *text; text++) {
		one[0] = *text;
		gz_text_add_escaped(out, *text == '\'' ? "'\\''" : one);
	}
	gz_text_add_escaped(out, "'");
}

static bool path_is_new(const struct gz_study *study, size_t place)
{
	for (size_t i = 0; i < place; i++)
		if (strcmp(study->scenes[i].path, study->scenes[place].path) == 0)
			return false;
	return true;
}

/* The display, where it is known and the same for all scenes. */
static void add_display(const struct gz_study *study, struct gz_text *out)
{
	const struct gz_display *first = &study->scenes[0].display;
	for (size_t i = 0; i < study->scene_count; i++) {
		const struct gz_display *display = &study->scenes[i].display;
		if (!study->scenes[i].display_known || display->mm[0] != first->mm[0] ||
		    display->mm[1] != first->mm[1] || display->distance_mm != first->distance_mm)
			return;
	}
	char numbers[3][GZ_NUMBER_SIZE];
	gz_number_print(first->mm[0], numbers[0]);
	gz_number_print(first->mm[1], numbers[1]);
	gz_number_print(first->distance_mm, numbers[2]);
	gz_text_add(out, " \\\n  --display-mm &#39;%s %s&#39; --distance-mm %s", numbers[0],
		    numbers[1], numbers[2]);
}

static void add_command(const struct gz_study *study, struct gz_text *out)
{
	gz_text_add(out, "<pre class=\"scroll\" tabindex=\"0\"><code>gazebench run");
	for (size_t i = 0; i < study->scene_count; i++)
		if (path_is_new(study, i)) {
			gz_text_add(out, " ");
			add_argument(study->scenes[i].path, out);
		}
	gz_text_add(out, " --path ");
	add_argument(study->path, out);
	gz_text_add(out, " \\\n  --methods ");
	/* Standard is always measured. */
	const bool skip =
		study->variant_count > 1 && strcmp(study->variants[0].text, "standard") == 0;
	for (size_t i = skip; i < study->variant_count; i++) {
		gz_text_add(out, i > skip ? "," : "");
		add_argument(study->variants[i].text, out);
	}
	gz_text_add(out, " \\\n  --size ");
	for (size_t i = 0; i < study->size_count; i++)
		gz_text_add(out, "%s%dx%d", i > 0 ? "," : "", study->sizes[i][0],
			    study->sizes[i][1]);
	gz_text_add(out, " --backend ");
	for (size_t i = 0; i < study->backend_count; i++) {
		gz_text_add(out, i > 0 ? "," : "");
		add_argument(study->backends[i], out);
	}
	if (study->camera_count > 0)
		gz_text_add(out, " --cameras %u", study->camera_count);
	if (study->min_move_px > 0)
		gz_text_add(out, " --min-move %.10g", study->min_move_px);
	if (study->per_cell)
		gz_text_add(out, " --per-cell");
	gz_text_add(out, " \\\n  --frames %d --warm-up %d --seed %llu --errors %s",
		    study->frames_per_point, study->warm_up_frames, (unsigned long long)study->seed,
		    gz_study_accuracy_names[study->accuracy]);
	add_display(study, out);
	if (study->shard_count > 1)
		gz_text_add(out, " --shard %d/%d", study->shard + 1, study->shard_count);
	gz_text_add(out, " --out DIR</code></pre>\n");
}

static void add_scene(const struct gz_study_scene *scene, struct gz_text *out)
{
	char words[GZ_NAMES_SIZE], text[3 * GZ_NAMES_SIZE];
	gz_scene_words(scene, words);
	snprintf(text, sizeof text,
		 "%s: %d×%d×%d voxels, %dx%d px of %.4g×%.4g mm seen from %g mm, "
		 "SHA-256 %s",
		 words, scene->dims[0], scene->dims[1], scene->dims[2], scene->display.px[0],
		 scene->display.px[1], scene->display.mm[0], scene->display.mm[1],
		 scene->display.distance_mm, scene->hash);
	add_fact("scene", text, out);
}

void gz_page_origin(const struct gz_summary *summary, struct gz_text *out)
{
	const struct gz_study *study = summary->study;
	const struct gz_study_machine *machine = &study->machine;
	gz_text_add(out, "<section id=\"origin\">\n<h2>What it ran on</h2>\n<dl>\n");
	add_fact("processor", machine->host_cpu, out);
	add_fact("memory", machine->memory, out);
	add_fact("system", machine->system, out);
	for (size_t i = 0; i < study->backend_count; i++) {
		char name[GZ_NAMES_SIZE];
		snprintf(name, sizeof name, "backend %.100s", study->backends[i]);
		add_fact(name, machine->backends[i], out);
	}
	add_fact("compiler", machine->compiler, out);
	add_fact("program", machine->program, out);
	add_fact("commit", machine->commit, out);
	for (size_t i = 0; i < study->scene_count; i++)
		add_scene(&study->scenes[i], out);
	add_fact("path of the gaze", study->path, out);
	add_fact("its points, SHA-256", study->path_hash, out);
	add_count("points", study->point_count, out);
	add_count("frames counted at each", (size_t)study->frames_per_point, out);
	add_count("frames before, not counted", (size_t)study->warm_up_frames, out);
	gz_text_add(out, "<dt>seed</dt><dd>%llu</dd>\n</dl>\n", (unsigned long long)study->seed);
	gz_text_add(out, "<h2>The command</h2>\n");
	add_command(study, out);
	gz_text_add(out, "<p>Beside this page: <code>frames.csv</code> has every frame, "
			 "<code>summary.json</code> every number, and each chart is there as SVG "
			 "and PNG.</p>\n</section>\n");
}
