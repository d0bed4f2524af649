#include "render/raycast/shared/step_bound.h"

#include <stdlib.h>

#include "base/clock.h"

#define GZ_LOG_MODULE "raycast"

/* The measure does not know light, which changes more than colours do. Chosen on tooth and cranium
 * (docs/results.md). */
#define LIT_SHARE 0.5

/* Larger volumes are not measured: they may lie on a disk, where each value is read by itself.
 * Chosen: smaller ones fit into memory. */
#define MEASURED_BYTES_MAX ((size_t)4 << 30)

void gz_step_bound_forget_volume(struct gz_step_bound *bound)
{
	bound->errors_hold = false;
	gz_ray_values_free(&bound->values);
}

void gz_step_bound_set_function(struct gz_step_bound *bound, const struct gz_transfer *function)
{
	struct gz_transfer plain = *function;
	plain.emphasis = (struct gz_transfer_emphasis) { 0 };
	if (gz_transfer_same(&bound->function, &plain))
		return;
	bound->function = plain;
	bound->errors_hold = false;
}

void gz_step_bound_free(struct gz_step_bound *bound)
{
	gz_ray_values_free(&bound->values);
	*bound = (struct gz_step_bound) { 0 };
}

static enum gz_result measure_errors(struct gz_step_bound *bound, const struct gz_volume *volume,
				     bool nearest)
{
	struct gz_transfer_table *table = calloc(1, sizeof *table);
	enum gz_result result = table ? GZ_OK : GZ_ERR_NO_MEM;
	if (result == GZ_OK && (!bound->values.stored || bound->values_nearest != nearest))
		result = gz_ray_values_take(volume, nearest, &bound->values);
	if (result == GZ_OK) {
		gz_transfer_table_bake(&bound->function, volume, table);
		result = gz_step_errors_measure(&bound->values, table, &bound->errors);
	}
	free(table);
	return result;
}

/* @return time that it took, ms */
static double follow_errors(struct gz_step_bound *bound, const struct gz_volume *volume,
			    bool nearest, const struct gz_log *log)
{
	if (bound->errors_hold && bound->values_nearest == nearest)
		return 0;
	const int64_t start_ns = gz_clock_now_ns();
	if (measure_errors(bound, volume, nearest) != GZ_OK) {
		bound->errors = (struct gz_step_errors) { 0 };
		gz_warn(log, "no memory to measure what longer steps change: they grow as if "
			     "nothing were known of the volume");
	}
	bound->values_nearest = nearest;
	bound->errors_hold = true;
	return gz_ns_to_ms(gz_clock_now_ns() - start_ns);
}

double gz_step_bound_plan(struct gz_step_bound *bound, const struct gz_volume *volume,
			  const struct gz_ray_params *rays, const struct gz_log *log,
			  struct gz_plan_request *request)
{
	const struct gz_foveation *foveation = request->foveation;
	/* gz_plan_update() refuses what is not valid. */
	if (!gz_foveation_valid(foveation) || foveation->acuity_step_error >= 1 ||
	    !gz_plan_steps_by_acuity(foveation) || volume->bricks ||
	    gz_volume_bytes(volume) > MEASURED_BYTES_MAX)
		return 0;
	const double spent_ms =
		follow_errors(bound, volume, gz_ray_samples_nearest(rays, volume), log);
	if (!bound->errors.known)
		return spent_ms;
	const double share = gz_ray_params_lit(rays) ? LIT_SHARE : 1;
	const double longest = gz_step_errors_longest(&bound->errors, rays->background,
						      share * foveation->acuity_step_error);
	request->step_growth = gz_plan_step_growth(longest * rays->ray_sampling_rate);
	return spent_ms;
}
