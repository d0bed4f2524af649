#include "render/illustration/shared/illustrate_picture.h"

#include <stdlib.h>
#include <string.h>

const enum gz_plane_kind gz_illustrate_found_kinds[GZ_ILLUSTRATE_FOUND] = {
	[GZ_ILLUSTRATE_TONE] = GZ_PLANE_VALUE,
	[GZ_ILLUSTRATE_DEPTH] = GZ_PLANE_VALUE,
	[GZ_ILLUSTRATE_IDS] = GZ_PLANE_ID,
	[GZ_ILLUSTRATE_DISTANCE] = GZ_PLANE_VALUE,
};

enum gz_result gz_illustrate_picture_open(struct gz_illustrate_picture *picture)
{
	return gz_shading_picture_create(&picture->shading);
}

const struct gz_shading_measures *gz_illustrate_picture_measures(
	const struct gz_illustrate_picture *picture)
{
	return picture->measured ? &picture->measures : NULL;
}

void gz_illustrate_picture_close(struct gz_illustrate_picture *picture)
{
	gz_shading_picture_destroy(&picture->shading);
	for (int layer = 0; layer < GZ_ILLUSTRATE_LAYERS_MAX; layer++)
		for (int i = 0; i < GZ_ILLUSTRATE_FOUND; i++)
			gz_plane_free(&picture->planes[layer][i]);
	free(picture->sums);
	free(picture->shares);
	free(picture->together);
	gz_illustrate_drawing_free(&picture->drawing);
	*picture = (struct gz_illustrate_picture) { 0 };
}

/* Room for what is blended of layers behind each other. */
static enum gz_result make_blend_room(struct gz_illustrate_picture *picture, size_t pixels)
{
	if (picture->blend_room >= pixels)
		return GZ_OK;
	free(picture->sums);
	free(picture->shares);
	free(picture->together);
	picture->together = calloc(pixels, sizeof *picture->together);
	picture->sums = calloc(pixels, sizeof *picture->sums);
	picture->shares = calloc(pixels, sizeof *picture->shares);
	const bool complete = picture->sums && picture->shares && picture->together;
	picture->blend_room = complete ? pixels : 0;
	return picture->blend_room > 0 ? GZ_OK : GZ_ERR_NO_MEM;
}

enum gz_result gz_illustrate_picture_prepare(struct gz_illustrate_picture *picture,
					     const struct gz_illustrate_scene *scene,
					     const struct gz_illustrate_shot *shot)
{
	const struct gz_plan *plan = shot->plan;
	enum gz_result result = GZ_OK;
	picture->measured = shot->look->automatic && shot->look->show == GZ_SHOW_SHADING;
	picture->measures = (struct gz_shading_measures) { 0 };
	picture->layers = scene->transparent ? GZ_ILLUSTRATE_LAYERS_MAX : 1;
	picture->plane_count = gz_illustrate_shot_measured(shot) > 0 ? GZ_ILLUSTRATE_FOUND
								     : GZ_ILLUSTRATE_DISTANCE;
	for (int layer = 0; layer < picture->layers; layer++)
		for (int i = 0; i < picture->plane_count && result == GZ_OK; i++)
			result = gz_plane_resize(&picture->planes[layer][i],
						 gz_illustrate_found_kinds[i], plan->width,
						 plan->height);
	if (result == GZ_OK && picture->layers > 1)
		result = make_blend_room(picture, (size_t)plan->width * (size_t)plan->height);
	if (result == GZ_OK)
		result = gz_illustrate_drawing_begin(&picture->drawing, scene, shot);
	return result;
}

/* What one picture is composed of. */
struct illustrate_composing {
	struct gz_illustrate_picture *picture;
	const struct gz_illustrate_scene *scene;
	const struct gz_illustrate_frame *frame;
	struct gz_workers *workers;
};

/* Whether marks draw the picture. */
static bool is_drawn(const struct gz_illustrate_picture *picture)
{
	return picture->drawing.drawn;
}

/* Compose the map of one layer, or its pixels. Those behind the front one take over its tone curve.
 */
static enum gz_result compose_layer(const struct illustrate_composing *composing, int layer,
				    uint32_t *out_pixels, const float **out_map)
{
	struct gz_illustrate_picture *picture = composing->picture;
	const struct gz_plane *planes = picture->planes[layer];
	const struct gz_shading_frame frame = {
		.width = planes[GZ_ILLUSTRATE_IDS].width,
		.height = planes[GZ_ILLUSTRATE_IDS].height,
		.tone = planes[GZ_ILLUSTRATE_TONE].words,
		.depth = planes[GZ_ILLUSTRATE_DEPTH].words,
		.ids = planes[GZ_ILLUSTRATE_IDS].words,
		.object_distance_mm = picture->plane_count > GZ_ILLUSTRATE_DISTANCE
					      ? planes[GZ_ILLUSTRATE_DISTANCE].words
					      : NULL,
		.near = composing->frame->near_mm,
		.far = composing->frame->far_mm,
		.importances = composing->scene->importances,
		.weights = composing->frame->weights,
		.objects = composing->scene->id_count,
		.keeps_curve = layer > 0,
		.lines_apart = is_drawn(picture) ? picture->drawing.layer_lines : NULL,
	};
	if (picture->measured && layer == 0)
		gz_shading_measure(&frame, &picture->measures);
	return gz_shading_picture_compose(picture->shading, &frame, &composing->frame->settings,
					  composing->workers, out_pixels, out_map);
}

/* Add the map of a layer, as far as those before it let it through. The lines of a drawing are let
 * through alike. */
static void blend_layer(const struct illustrate_composing *composing, int layer, const float *map,
			size_t pixels)
{
	const struct gz_illustrate_picture *picture = composing->picture;
	const struct gz_illustrate_scene *scene = composing->scene;
	const uint32_t *ids = picture->planes[layer][GZ_ILLUSTRATE_IDS].words;
	float *sums = picture->sums, *shares = picture->shares;
	float *lines = is_drawn(picture) ? picture->drawing.layer_lines : NULL;
	for (size_t i = 0; i < pixels; i++) {
		const size_t id = ids[i];
		const bool is_object = id > 0 && id <= scene->id_count;
		const float opacity = is_object ? scene->opacities[id - 1] : 1;
		sums[i] += shares[i] * opacity * map[i];
		if (lines)
			lines[i] = 1 - shares[i] * opacity * (1 - lines[i]);
		shares[i] *= 1 - opacity;
	}
}

/* Add the marks of a layer to the drawing. */
static enum gz_result draw_layer(const struct illustrate_composing *composing, int layer,
				 const float *map, size_t pixels)
{
	struct gz_illustrate_picture *picture = composing->picture;
	const bool blended = picture->layers > 1;
	for (size_t i = 0; i < pixels && blended; i++)
		picture->together[i] = picture->sums[i] + picture->shares[i];
	const struct gz_drawn_layer drawn = {
		.depth = &picture->planes[layer][GZ_ILLUSTRATE_DEPTH],
		.ids = &picture->planes[layer][GZ_ILLUSTRATE_IDS],
		.brightness = blended ? picture->together : map,
		.alone = !blended,
	};
	return gz_illustrate_drawing_add(&picture->drawing, composing->scene, &drawn,
					 composing->workers);
}

/* Compose a layer, and add it to those before it. */
static enum gz_result add_layer(const struct illustrate_composing *composing, int layer,
				struct gz_image *image)
{
	const struct gz_illustrate_picture *picture = composing->picture;
	const size_t pixels = (size_t)image->width * (size_t)image->height;
	const bool blended = picture->layers > 1, drawn = is_drawn(picture);
	const float *map = NULL;
	const enum gz_result result =
		compose_layer(composing, layer, blended || drawn ? NULL : gz_image_words(image),
			      blended || drawn ? &map : NULL);
	if (result == GZ_OK && blended)
		blend_layer(composing, layer, map, pixels);
	return result == GZ_OK && drawn ? draw_layer(composing, layer, map, pixels) : result;
}

static enum gz_result compose_layers(const struct illustrate_composing *composing,
				     struct gz_image *image)
{
	struct gz_illustrate_picture *picture = composing->picture;
	const size_t pixels = (size_t)image->width * (size_t)image->height;
	const bool blended = picture->layers > 1;
	enum gz_result result = GZ_OK;
	for (size_t i = 0; i < pixels && blended; i++) {
		picture->sums[i] = 0;
		picture->shares[i] = 1;
	}
	for (int layer = 0; layer < picture->layers && result == GZ_OK; layer++)
		result = add_layer(composing, layer, image);
	if (result == GZ_OK && is_drawn(picture))
		return gz_illustrate_drawing_finish(&picture->drawing, composing->workers, image);
	if (result == GZ_OK && blended)
		gz_shading_grey(picture->sums, pixels, gz_image_words(image));
	return result;
}

static enum gz_result copy_plane(const struct gz_plane *from, struct gz_plane *to)
{
	if (!to)
		return GZ_OK;
	const enum gz_result result = gz_plane_resize(to, from->kind, from->width, from->height);
	if (result == GZ_OK)
		memcpy(to->words, from->words,
		       (size_t)from->width * (size_t)from->height * sizeof *to->words);
	return result;
}

enum gz_result gz_illustrate_picture_compose(struct gz_illustrate_picture *picture,
					     const struct gz_illustrate_scene *scene,
					     const struct gz_illustrate_frame *frame,
					     struct gz_workers *workers, struct gz_image *image,
					     const struct gz_illustrate_planes *planes)
{
	const struct illustrate_composing composing = { picture, scene, frame, workers };
	const struct gz_plane *nearest = picture->planes[0];
	enum gz_result result = compose_layers(&composing, image);
	if (result == GZ_OK && planes)
		result = copy_plane(&nearest[GZ_ILLUSTRATE_DEPTH], planes->depth);
	if (result == GZ_OK && planes)
		result = copy_plane(&nearest[GZ_ILLUSTRATE_IDS], planes->ids);
	return result;
}
