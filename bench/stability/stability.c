/* The table of rows, and how one is run. */
#include "bench/stability/stability.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
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
	{ "turn",
	  "the camera turns: what comes and goes beyond standard is bounded, and not foveal", false,
	  false, gz_stability_turn },
	{ "kept",
	  "the camera turns: keeping earlier frames makes no frame worse, and the mean better",
	  false, false, gz_stability_kept },
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

static void judge_numbers(struct gz_stability_outcome *outcome)
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
	judge_numbers(outcome);
	return GZ_OK;
}

/* ---- outcomes ---- */

void gz_stability_name(struct gz_stability_outcome *outcome, int number, const char *what,
		       double bound)
{
	outcome->numbers[number].what = what;
	outcome->numbers[number].bound = bound;
	if (number >= outcome->number_count)
		outcome->number_count = number + 1;
}

int gz_stability_apart(const struct gz_image *a, const struct gz_image *b, size_t pixel)
{
	int most = 0;
	for (size_t i = 4 * pixel; i < 4 * pixel + 3; i++) {
		const int apart = abs(a->pixels[i] - b->pixels[i]);
		most = apart > most ? apart : most;
	}
	return most;
}

static enum gz_result crop_round(const struct gz_image *image, int x, int y, struct gz_image *out)
{
	const int width =
		image->width - x < GZ_STABILITY_CROP_PX ? image->width - x : GZ_STABILITY_CROP_PX;
	const int height =
		image->height - y < GZ_STABILITY_CROP_PX ? image->height - y : GZ_STABILITY_CROP_PX;
	const enum gz_result result = gz_image_resize(out, width, height);
	for (int row = 0; row < height && result == GZ_OK; row++)
		memcpy(out->pixels + (size_t)row * (size_t)width * 4,
		       image->pixels + ((size_t)(y + row) * (size_t)image->width + (size_t)x) * 4,
		       (size_t)width * 4);
	return result;
}

static int crop_start(int at, int size)
{
	const int most = size > GZ_STABILITY_CROP_PX ? size - GZ_STABILITY_CROP_PX : 0;
	const int start = at - GZ_STABILITY_CROP_PX / 2;
	return start < 0 ? 0 : start > most ? most : start;
}

static enum gz_result keep_pixel(struct gz_stability_outcome *outcome,
				 struct gz_stability_place place, bool fails)
{
	struct gz_stability_pixel *worst = &outcome->worst;
	const size_t width = (size_t)place.got->width;
	worst->known = true;
	worst->x = (int)(place.pixel % width);
	worst->y = (int)(place.pixel / width);
	memcpy(worst->got, place.got->pixels + 4 * place.pixel, 3);
	memcpy(worst->wanted, place.wanted->pixels + 4 * place.pixel, 3);
	if (!fails)
		return GZ_OK;
	worst->crop_x = crop_start(worst->x, place.got->width);
	worst->crop_y = crop_start(worst->y, place.got->height);
	enum gz_result result =
		crop_round(place.got, worst->crop_x, worst->crop_y, &worst->got_crop);
	if (result == GZ_OK)
		result =
			crop_round(place.wanted, worst->crop_x, worst->crop_y, &worst->wanted_crop);
	return result;
}

/* Relative excess of a number over its bound; the worst pixel is of the greatest. */
static double excess(const struct gz_stability_number *number)
{
	return (number->value - number->bound) / fmax(fabs(number->bound), 1e-3);
}

enum gz_result gz_stability_take(struct gz_stability_outcome *outcome, int number, double value,
				 struct gz_stability_place place, const char *format, ...)
{
	struct gz_stability_number *taken = &outcome->numbers[number];
	const bool first = taken->where[0] == '\0';
	if (!first && !(value > taken->value))
		return GZ_OK;
	taken->value = value;
	va_list arguments;
	va_start(arguments, format);
	vsnprintf(taken->where, sizeof taken->where, format, arguments);
	va_end(arguments);
	for (int i = 0; i < outcome->number_count; i++)
		if (excess(&outcome->numbers[i]) > excess(taken) && outcome->worst.known)
			return GZ_OK;
	return place.got ? keep_pixel(outcome, place, value > taken->bound) : GZ_OK;
}

/* ---- the picture beside a failure ---- */

enum { ENLARGED = 10, GAP = 8, STRONGER = 4 };

static void fill_grey(struct gz_image *image, uint8_t grey)
{
	for (size_t i = 0; i < (size_t)image->width * (size_t)image->height * 4; i++)
		image->pixels[i] = i % 4 == 3 ? 255 : grey;
}

/* A pixel of panel 0, 1 or 2. */
static void colour_of(const struct gz_stability_pixel *worst, int panel, int x, int y,
		      uint8_t out[3])
{
	const size_t at = 4 * ((size_t)y * (size_t)worst->got_crop.width + (size_t)x);
	for (size_t c = 0; c < 3; c++) {
		const int got = worst->got_crop.pixels[at + c],
			  wanted = worst->wanted_crop.pixels[at + c];
		const int difference = STRONGER * abs(got - wanted);
		out[c] = (uint8_t)(panel == 0   ? got
				   : panel == 1 ? wanted
						: (difference > 255 ? 255 : difference));
	}
}

static void put_panel(const struct gz_stability_pixel *worst, int panel, struct gz_image *target)
{
	const int left = panel * (worst->got_crop.width * ENLARGED + GAP) + GAP;
	for (int y = 0; y < worst->got_crop.height * ENLARGED; y++)
		for (int x = 0; x < worst->got_crop.width * ENLARGED; x++)
			colour_of(worst, panel, x / ENLARGED, y / ENLARGED,
				  target->pixels + 4 * ((size_t)(y + GAP) * (size_t)target->width +
							(size_t)(left + x)));
}

/* A frame round the worst pixel, outside of it. */
static void put_frame(const struct gz_stability_pixel *worst, int panel, struct gz_image *target)
{
	const int left = panel * (worst->got_crop.width * ENLARGED + GAP) + GAP +
			 (worst->x - worst->crop_x) * ENLARGED;
	const int top = GAP + (worst->y - worst->crop_y) * ENLARGED;
	for (int y = top - 2; y < top + ENLARGED + 2; y++)
		for (int x = left - 2; x < left + ENLARGED + 2; x++) {
			const bool inside =
				x >= left && x < left + ENLARGED && y >= top && y < top + ENLARGED;
			uint8_t *pixel = target->pixels +
					 4 * ((size_t)y * (size_t)target->width + (size_t)x);
			if (!inside) {
				pixel[0] = 255;
				pixel[1] = 220;
				pixel[2] = 0;
			}
		}
}

enum gz_result gz_stability_write_picture(const struct gz_stability_outcome *outcome,
					  const char *path, const struct gz_log *log)
{
	const struct gz_stability_pixel *worst = &outcome->worst;
	struct gz_image picture = { 0 };
	if (!worst->known || !worst->got_crop.pixels)
		return GZ_ERR_INVAL;
	enum gz_result result =
		gz_image_resize(&picture, 3 * worst->got_crop.width * ENLARGED + 4 * GAP,
				worst->got_crop.height * ENLARGED + 2 * GAP);
	if (result != GZ_OK)
		return result;
	fill_grey(&picture, 64);
	for (int panel = 0; panel < 3; panel++) {
		put_panel(worst, panel, &picture);
		put_frame(worst, panel, &picture);
	}
	result = gz_image_write_png(&picture, path, log);
	gz_image_free(&picture);
	return result;
}
