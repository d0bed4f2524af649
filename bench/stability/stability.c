/* The table of rows, and how one is run. */
#include "bench/stability/stability.h"

#include <stdio.h>
#include <string.h>

#include "bench/stability/stability_bench.h"

const struct gz_stability_row gz_stability_rows[] = {
	{ "brightness",
	  "a box of constant density is as bright as with fine steps, at any step and spacing",
	  true, false, gz_stability_brightness },
	{ "thin",
	  "wires and shells one voxel thick lose no pixel in the fovea at steps to 4 voxels", true,
	  false, gz_stability_thin },
	{ "lost",
	  "what standard shows in the fovea is not lost there, and a bounded share elsewhere",
	  false, false, gz_stability_lost },
	{ "tremble", "the gaze trembles by 1 px: no change in the fovea, little elsewhere", false,
	  false, gz_stability_tremble },
	{ "border", "error has no step where a border of spacings sweeps over the picture", false,
	  false, gz_stability_border },
	{ "pursuit", "the gaze moves and steps vary: no change in the fovea, little elsewhere",
	  false, false, gz_stability_pursuit },
	{ "gaze", "every pixel is written for a gaze anywhere or nowhere, and sharp where it is",
	  false, false, gz_stability_gaze },
	{ "saccade", "after a saccade of 20 degrees the first frame is sharp in the fovea", false,
	  false, gz_stability_saccade },
	{ "volumes", "lines, single voxels, slices and odd types of voxel are as the reference",
	  true, false, gz_stability_volumes },
	{ "camera", "inside, on a face, along an axis, orthographic: as the reference, no seams",
	  false, false, gz_stability_camera },
	{ "transfer", "all transparent and all opaque are as the reference", false, false,
	  gz_stability_transfer },
	{ "spike", "a spike one entry wide is pre-integrated exactly, at any step", true, false,
	  gz_stability_spike },
	{ "sizes", "1x1, 7x3, 8191x1 and 16384x2 are written whole, 16385 is refused", true, false,
	  gz_stability_sizes },
	{ "churn", "memory stays as it is while method and size change each frame", false, true,
	  gz_stability_churn },
	{ NULL, NULL, false, false, NULL },
};

const char *gz_stability_verdict_text(enum gz_stability_verdict verdict)
{
	static const char *const texts[] = { "holds", "fails", "refused", "does not apply" };
	return texts[verdict];
}

void gz_stability_outcome_free(struct gz_stability_outcome *outcome)
{
	gz_image_free(&outcome->worst.got_crop);
	gz_image_free(&outcome->worst.wanted_crop);
	*outcome = (struct gz_stability_outcome) { 0 };
}

static void judge(struct gz_stability_outcome *outcome)
{
	if (outcome->verdict != GZ_STABILITY_HOLDS)
		return;
	for (int i = 0; i < outcome->number_count; i++)
		if (!(outcome->numbers[i].value <= outcome->numbers[i].bound)) /* NaN fails */
			outcome->verdict = GZ_STABILITY_FAILS;
}

enum gz_result gz_stability_run(struct gz_stability_bench *bench,
				const struct gz_stability_row *row,
				struct gz_stability_outcome *outcome)
{
	gz_stability_outcome_free(outcome);
	if (!bench->tested.maker || !bench->has_method)
		return GZ_ERR_INVAL;
	bench->said[0] = '\0';
	bench->failed = GZ_OK;
	const enum gz_result result = row->run(bench, outcome);
	if (result != GZ_OK && bench->failed == GZ_OK)
		return result; /* not the backend's doing */
	if (result != GZ_OK) {
		outcome->verdict = bench->failed == GZ_ERR_UNSUPPORTED ? GZ_STABILITY_REFUSED
								       : GZ_STABILITY_FAILS;
		snprintf(outcome->note, sizeof outcome->note, "%s",
			 bench->said[0] ? bench->said : gz_result_text(bench->failed));
	}
	judge(outcome);
	return GZ_OK;
}
