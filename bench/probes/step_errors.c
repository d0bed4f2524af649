/* Prints how much longer steps change what rays through a scene's volume see, what growth of steps
 * follows, and how long it took to find out:
 *
 *     step_errors SCENE... */
#include <stdio.h>
#include <stdlib.h>

#include "base/clock.h"
#include "base/log.h"
#include "render/raycast/shared/step_errors.h"
#include "render/scene/scene.h"

struct measured {
	struct gz_step_errors errors;
	double take_ms, measure_ms;
};

static enum gz_result measure(const struct gz_scene *scene, struct gz_transfer_table *table,
			      struct measured *out_measured)
{
	struct gz_ray_values values = { 0 };
	const bool nearest = gz_ray_samples_nearest(&scene->settings.rays, &scene->volume);
	const int64_t start_ns = gz_clock_now_ns();
	enum gz_result result = gz_ray_values_take(&scene->volume, nearest, &values);
	const int64_t taken_ns = gz_clock_now_ns();
	gz_transfer_table_bake(&scene->transfer, &scene->volume, table);
	const int64_t baked_ns = gz_clock_now_ns();
	if (result == GZ_OK)
		result = gz_step_errors_measure(&values, table, &out_measured->errors);
	out_measured->take_ms = gz_ns_to_ms(taken_ns - start_ns);
	out_measured->measure_ms = gz_ns_to_ms(gz_clock_now_ns() - baked_ns);
	gz_ray_values_free(&values);
	return result;
}

static void print(const char *name, const struct gz_scene *scene, const struct measured *measured)
{
	const struct gz_ray_params *rays = &scene->settings.rays;
	static const double multiples[] = { 1, 1.4, 2, 3, 4, 8 };
	static const double limits[] = { 0.00625, 0.0125, 0.025 };
	printf("%s\n  values in %.1f ms, errors in %.1f ms, %sknown; change by steps of", name,
	       measured->take_ms, measured->measure_ms, measured->errors.known ? "" : "not ");
	for (size_t i = 0; i < sizeof multiples / sizeof *multiples; i++)
		printf(" %g: %.4f", multiples[i],
		       gz_step_error_at(&measured->errors, multiples[i] / rays->ray_sampling_rate,
					rays->background));
	printf("\n  growth for a limit of");
	for (size_t i = 0; i < sizeof limits / sizeof *limits; i++)
		printf(" %g: %.2f", limits[i],
		       gz_plan_step_growth(gz_step_errors_longest(&measured->errors,
								  rays->background, limits[i]) *
					   rays->ray_sampling_rate));
	printf("\n");
}

int main(int argc, char **argv)
{
	struct gz_log log;
	struct gz_transfer_table *table = calloc(1, sizeof *table);
	enum gz_result result = table ? GZ_OK : GZ_ERR_NO_MEM;
	gz_log_init(&log, NULL, NULL, "*:warn");
	for (int i = 1; i < argc && result == GZ_OK; i++) {
		struct gz_scene scene;
		struct measured measured;
		result = gz_scene_load(argv[i], NULL, &log, &scene);
		if (result != GZ_OK)
			break;
		result = measure(&scene, table, &measured);
		if (result == GZ_OK)
			print(argv[i], &scene, &measured);
		gz_scene_free(&scene);
	}
	free(table);
	return result == GZ_OK ? EXIT_SUCCESS : EXIT_FAILURE;
}
