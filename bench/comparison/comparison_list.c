#include "bench/comparison/comparison_list.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "bench/study/stage.h"
#include "render/scene/techniques.h"

/* Edge of the pictures that tell whether an effect changes something, px. Chosen: shadows and
 * highlights cover many times a 96th of a picture. */
enum { PROBE_PX = 96 };

/* Numbers of slices, as Schlemminger et al. 2017 measured them. */
static const int slice_counts[] = { 64, 128, 512 };
static const char slices_key[] = "slices.count";

const char gz_comparison_reference_backend[] = "cpu";

enum gz_result gz_comparison_open(const struct gz_comparison_stage *stage,
				  const struct gz_technique *technique, const char *backend,
				  const struct gz_log *log, struct gz_picture_maker **out_maker)
{
	const struct gz_picture_maker_params params = { .backend = backend };
	const struct gz_object object = {
		.technique = technique,
		.id = 1,
		.volume = stage->volume,
		.transfer = stage->transfer,
	};
	struct gz_picture_maker *maker = NULL;
	enum gz_result result = gz_picture_maker_create(&params, log, &maker);
	if (result == GZ_OK)
		result = gz_picture_maker_show(maker, &object, 1);
	if (result == GZ_OK)
		*out_maker = maker;
	else
		gz_picture_maker_destroy(&maker);
	return result;
}

static bool list_room(void **items, size_t count, size_t size)
{
	void *grown = realloc(*items, (count + 1) * size);
	if (grown)
		*items = grown;
	return grown != NULL;
}

static enum gz_result add_gap(struct gz_comparison_list *list, const struct gz_comparison_gap *gap)
{
	if (!list_room((void **)&list->gaps, list->gap_count, sizeof *gap))
		return GZ_ERR_NO_MEM;
	list->gaps[list->gap_count++] = *gap;
	return GZ_OK;
}

static enum gz_result add_series(struct gz_comparison_list *list,
				 const struct gz_comparison_series *series)
{
	if (!list_room((void **)&list->series, list->count, sizeof *series))
		return GZ_ERR_NO_MEM;
	list->series[list->count++] = *series;
	return GZ_OK;
}

/* One series for each number of slices, or one. */
static enum gz_result add_counts(struct gz_comparison_list *list,
				 const struct gz_comparison_series *series)
{
	enum gz_result result = GZ_OK;
	if (!gz_technique_has_key(series->technique, slices_key))
		return add_series(list, series);
	for (size_t i = 0; i < sizeof slice_counts / sizeof slice_counts[0] && result == GZ_OK;
	     i++) {
		struct gz_comparison_series with = *series;
		char text[GZ_NAME_SIZE];
		snprintf(text, sizeof text, "%d", slice_counts[i]);
		with.slices = slice_counts[i];
		result = gz_technique_set(with.technique, &with.rays, slices_key, text);
		if (result == GZ_OK)
			result = add_series(list, &with);
	}
	return result;
}

/* Small pictures of the effects so far. */
struct probe {
	const struct gz_comparison_stage *stage;
	const char *effects; /* asked for; empty: all */
	struct gz_picture_maker *maker;
	struct gz_image images[GZ_EFFECT_COUNT];
	bool drawn[GZ_EFFECT_COUNT];
};

static bool draw_probe(struct probe *probe, size_t effect, const struct gz_ray_params *rays)
{
	const struct gz_foveation foveation = gz_foveation_full();
	const struct gz_picture_request request = {
		.camera = probe->stage->camera,
		.settings = rays,
		.foveation = &foveation,
		.display = probe->stage->display,
		.focus = gz_focus_at((struct gz_point) { 0.5F, 0.5F }),
		.width = PROBE_PX,
		.height = PROBE_PX,
		.image = &probe->images[effect],
	};
	struct gz_image *image;
	probe->drawn[effect] = gz_picture_make(probe->maker, &request, &image, NULL) == GZ_OK;
	return probe->drawn[effect];
}

/* Whether the picture differs from those of all effects before. */
static bool changes_something(const struct probe *probe, size_t effect)
{
	const size_t size = (size_t)PROBE_PX * PROBE_PX * 4;
	for (size_t i = 0; i < effect; i++)
		if (probe->drawn[i] &&
		    memcmp(probe->images[i].pixels, probe->images[effect].pixels, size) == 0)
			return false;
	return true;
}

/* Whether a list names something. An empty one names everything. */
static bool is_asked_for(const char *list, const char *wanted)
{
	char name[GZ_NAME_SIZE];
	const char *rest = list[0] ? list : NULL;
	while (gz_list_next(&rest, name, sizeof name))
		if (strcmp(name, wanted) == 0)
			return true;
	return !list[0];
}

static enum gz_result list_effects(struct probe *probe, struct gz_comparison_series *series,
				   struct gz_comparison_list *list)
{
	enum gz_result result = GZ_OK;
	for (size_t i = 0; i < GZ_EFFECT_COUNT && result == GZ_OK; i++) {
		series->effect = i;
		series->rays = *probe->stage->rays;
		result = gz_effect_apply(&gz_effects[i], series->technique, &series->rays);
		if (result != GZ_OK)
			break;
		const struct gz_comparison_gap gap = {
			.technique = series->technique,
			.backend = series->backend,
			.effect = &gz_effects[i],
			.why = i == 0 ? GZ_ABSENT_BACKEND : GZ_ABSENT_EFFECT,
		};
		const bool had = !gz_effects[i].needs ||
				 gz_technique_has_key(series->technique, gz_effects[i].needs);
		const bool drawn = had && draw_probe(probe, i, &series->rays);
		const bool shows = drawn && changes_something(probe, i);
		if (is_asked_for(probe->effects, gz_effects[i].name))
			result = shows ? add_counts(list, series) : add_gap(list, &gap);
		if (!drawn && i == 0) /* not even that: this backend cannot show the volume */
			break;
	}
	return result;
}

static enum gz_result list_backend(const struct gz_comparison_stage *stage,
				   const struct gz_technique *technique, const char *backend,
				   const char *effects, struct gz_comparison_list *list)
{
	struct gz_comparison_series series = { .technique = technique, .backend = backend };
	struct probe probe = { .stage = stage, .effects = effects };
	/* Without a log: what does not run here is no fault, and the list of gaps tells it. */
	enum gz_result result = gz_comparison_open(stage, technique, backend, NULL, &probe.maker);
	if (result != GZ_OK) {
		const struct gz_comparison_gap gap = { .technique = technique,
						       .backend = backend,
						       .effect = &gz_effects[0],
						       .why = GZ_ABSENT_BACKEND };
		return result == GZ_ERR_NO_MEM ? result : add_gap(list, &gap);
	}
	result = list_effects(&probe, &series, list);
	gz_picture_maker_destroy(&probe.maker);
	for (size_t i = 0; i < GZ_EFFECT_COUNT; i++)
		gz_image_free(&probe.images[i]);
	return result;
}

/* Find which effects converged pictures can have, whatever is asked for. */
static enum gz_result find_converged_effects(const struct gz_comparison_stage *stage,
					     bool out_has[GZ_EFFECT_COUNT])
{
	struct gz_comparison_list list = { 0 };
	const enum gz_result result =
		list_backend(stage, gz_techniques[0], gz_comparison_reference_backend, "", &list);
	for (size_t i = 0; i < list.count; i++)
		out_has[list.series[i].effect] = true;
	gz_comparison_list_free(&list);
	return result;
}

static enum gz_result list_technique(const struct gz_comparison_stage *stage,
				     const struct gz_comparison_request *request,
				     const struct gz_technique *technique,
				     struct gz_comparison_list *list)
{
	enum gz_result result = GZ_OK;
	for (const char *const *name = technique->backends; *name && result == GZ_OK; name++)
		if (is_asked_for(request->backends, *name))
			result = list_backend(stage, technique, *name, request->effects, list);
	return result;
}

enum gz_result gz_comparison_list_make(const struct gz_comparison_stage *stage,
				       const struct gz_comparison_request *request,
				       struct gz_comparison_list *out_list)
{
	struct gz_comparison_list list = { 0 };
	enum gz_result result = find_converged_effects(stage, list.converged_has);
	for (size_t i = 0; gz_techniques[i] && result == GZ_OK; i++)
		if (gz_techniques[i]->shows & GZ_OBJECT_VOLUME &&
		    is_asked_for(request->techniques, gz_techniques[i]->name))
			result = list_technique(stage, request, gz_techniques[i], &list);
	if (result == GZ_OK)
		*out_list = list;
	else
		gz_comparison_list_free(&list);
	return result;
}

void gz_comparison_list_free(struct gz_comparison_list *list)
{
	for (size_t i = 0; i < list->count; i++)
		gz_picture_maker_destroy(&list->series[i].maker);
	free(list->series);
	free(list->gaps);
	*list = (struct gz_comparison_list) { 0 };
}
