/* gazebench: what each saving costs. */
#include "bench/gazebench/gazebench.h"

#include <jansson.h>
#include <stdio.h>
#include <string.h>

#include "render/plan/method.h"
#include "render/raycast/shared/ray_params.h"
#include "render/scene/techniques.h"

/* clang-format off */
static const struct gz_command *const commands[] = {
	&gazebench_run,
	&gazebench_merge,
	&gazebench_report,
	&gazebench_suggest,
	&gazebench_accumulate,
	&gazebench_techniques,
	&gazebench_clip,
	&gazebench_compare,
	&gazebench_filter,
	&gazebench_answers,
	&gazebench_stability,
	NULL,
};
/* clang-format on */

/* ---- gazebench --list ---- */

/* One thing to name. */
struct item {
	const char *kind, *name, *text;
};

static const struct item items[] = {
	{ "path", "sweep:s",
	  "the mirrored S of Bauer 2018, 584 points; sweep:s:N takes N (preset sweep:s:64)" },
	{ "path", "grid:NxM", "the middles of N columns and M rows of cells" },
	{ "path", "random:N", "N places by the seed" },
	{ "path", "centre", "where the camera looks at" },
	{ "path", "X,Y", "one place, from 0,0 top left to 1,1" },
	{ "path", "FILE.csv", "places of a table, shares of the picture" },
	{ "path", "FILE.csv:WxH", "the same in pixels of a picture of this size" },
	{ "path", "FILE.gzl", "a recording, one point a fixation" },
	{ "path", "FILE.gzl:samples", "a recording, one point a sample" },
	{ "metric", "psnr_db", "peak signal-to-noise ratio, dB" },
	{ "metric", "ssim", "structural similarity, 1 = identical" },
	{ "metric", "flip", "LDR-FLIP, 0 = identical" },
	{ "metric", "flicker", "change while the gaze trembles by a pixel, levels of 255" },
	{ "metric", "turning_error",
	  "visible change beyond that of standard while the camera turns, levels of 255" },
	{ "metric", "camera_path_error", "the same while the camera follows --camera-path" },
	{ "where", "all", "each pixel counts alike" },
	{ "where", "foveal", "pixels within 2.5 degrees of the gaze count" },
	{ "where", "perceived", "pixels count by what the eye sees there" },
	{ "against", "standard", "the picture of full resolution, of the same backend" },
	{ "against", "converged",
	  "one of an eighth of a voxel a step, rays followed to their end" },
};

static void print_item(json_t *list, const char *kind, const char *name, const char *text)
{
	if (list)
		json_array_append_new(
			list, json_pack("{ss ss ss}", "kind", kind, "name", name, "text", text));
	else
		printf("%-8s %-22s %s\n", kind, name, text);
}

/* An option with its range and default. */
static void print_option(json_t *list, const struct gz_option *option, const char *name)
{
	const bool limited = option->type != GZ_OPTION_STRING;
	char allowed[512] = "";
	if (limited)
		gz_option_allowed(option, allowed, sizeof allowed);
	if (list)
		json_array_append_new(list, json_pack("{ss ss ss ss* ss*}", "kind", "option",
						      "name", name, "text", option->help, "allowed",
						      limited ? allowed : NULL, "preset",
						      option->preset));
	else if (limited)
		printf("%-8s %-22s %s (%s%s%s)\n", "option", name, option->help, allowed,
		       option->preset ? "; preset " : "", option->preset ? option->preset : "");
	else
		printf("%-8s %-22s %s\n", "option", name, option->help);
}

static void print_backend(json_t *list, const char *name)
{
	static const struct gz_backend_params defaults;
	struct gz_drawer *drawer = NULL;
	const bool runs = gz_techniques[0]->create(name, &defaults, NULL, &drawer) == GZ_OK;
	print_item(list, "backend", name,
		   runs ? drawer->ops->describe(drawer) : "does not run on this machine");
	gz_drawer_destroy(&drawer);
}

static void print_options(json_t *list, const struct gz_option *options, size_t count)
{
	for (size_t i = 0; i < count; i++) {
		const char *dot = strchr(options[i].key, '.');
		const bool taken = strncmp(options[i].key, "foveation.", 10) == 0 ||
				   strncmp(options[i].key, "render.", 7) == 0;
		if (dot && taken && strcmp(dot, ".method") != 0)
			print_option(list, &options[i], dot + 1);
	}
}

static int print_list(bool as_json)
{
	json_t *list = as_json ? json_array() : NULL;
	for (int i = 0; i < GZ_METHOD_COUNT; i++)
		print_item(list, "method", gz_method_names[i], gz_methods[i].help);
	print_options(list, gz_foveation_options, gz_foveation_option_count);
	print_options(list, gz_ray_options, gz_ray_option_count);
	for (size_t i = 0; i < sizeof items / sizeof items[0]; i++)
		print_item(list, items[i].kind, items[i].name, items[i].text);
	for (const struct gz_technique *const *technique = gz_techniques; *technique; technique++)
		print_item(list, "technique", (*technique)->name, (*technique)->help);
	for (const char *const *name = gz_techniques[0]->backends; *name; name++)
		print_backend(list, *name);
	if (list) {
		json_dumpf(list, stdout, JSON_INDENT(1));
		printf("\n");
		json_decref(list);
	}
	return fflush(stdout) == 0 ? GAZEBENCH_DONE : GAZEBENCH_FAILED;
}

/* ---- the program ---- */

/* --list is no command; --json may follow it. */
static bool asks_for_list(int argc, char **argv)
{
	return argc >= 2 && strcmp(argv[1], "--list") == 0 &&
	       (argc == 2 || (argc == 3 && strcmp(argv[2], "--json") == 0));
}

int main(int argc, char **argv)
{
	if (asks_for_list(argc, argv))
		return print_list(argc == 3);
	const struct gz_command_program program = {
		.name = "gazebench",
		.version = GAZECAST_VERSION,
		.purpose = "Measure what foveated rendering saves and what it costs in error, and "
			   "chart one against the other.\n\n`gazebench --list [--json]` names "
			   "methods, their options, paths, metrics and backends.",
		.exits = "0 done, 1 failed or refused, 2 called wrongly (no such option, method, "
			 "size), 3 a partial\nresult that can be resumed, 4 a stability row does "
			 "not hold",
		.commands = commands,
	};
	return gz_command_main(&program, argc, argv);
}
