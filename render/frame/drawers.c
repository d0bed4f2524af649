#include "render/frame/drawers.h"

#include <stdlib.h>
#include <string.h>

#define GZ_LOG_MODULE "picture"

/* Objects of a picture. Chosen: an atlas of the brain has 116 regions. */
enum { OBJECTS_MAX = 1024 };

/* List the techniques of some objects in the order of drawing: the opaque ones, then the last one.
 * Returns how many there are; GZ_DRAWERS_MAX + 1: too many. */
static size_t list_techniques(const struct gz_object *objects, size_t count,
			      const struct gz_technique *out_techniques[GZ_DRAWERS_MAX])
{
	size_t found = 0;
	for (size_t i = 0; i < count; i++) {
		size_t at = 0;
		while (at < found && out_techniques[at] != objects[i].technique)
			at++;
		if (at < found)
			continue;
		if (found == GZ_DRAWERS_MAX)
			return GZ_DRAWERS_MAX + 1;
		out_techniques[found++] = objects[i].technique;
	}
	for (size_t i = 0; i + 1 < found; i++)
		if (out_techniques[i]->sharing != GZ_SHARES_AS_OPAQUE) {
			const struct gz_technique *last = out_techniques[i];
			out_techniques[i] = out_techniques[found - 1];
			out_techniques[found - 1] = last;
		}
	return found;
}

/* Check that the techniques, in the order of drawing, share a picture. */
static enum gz_result check_sharing(const struct gz_drawers *drawers,
				    const struct gz_technique *const *techniques, size_t count)
{
	const struct gz_technique *last = techniques[count - 1];
	for (size_t i = 0; i + 1 < count; i++) {
		if (techniques[i]->sharing == GZ_SHARES_AS_OPAQUE &&
		    last->sharing == GZ_SHARES_AS_CLEAR)
			continue;
		gz_err(drawers->log,
		       "%s and %s cannot draw into one picture; set technique or render.technique "
		       "so that one draws what both show",
		       techniques[i]->name, last->name);
		return GZ_ERR_UNSUPPORTED;
	}
	return GZ_OK;
}

static enum gz_result check_counts(const struct gz_drawers *drawers,
				   const struct gz_object *objects, size_t count,
				   const struct gz_technique *technique)
{
	size_t own = 0;
	for (size_t i = 0; i < count; i++)
		own += objects[i].technique == technique;
	if (own <= technique->objects_max)
		return GZ_OK;
	gz_err(drawers->log, "%s draws at most %zu objects in a picture, not %zu", technique->name,
	       technique->objects_max, own);
	return GZ_ERR_UNSUPPORTED;
}

/* Check that drawers can show all the objects, and list their techniques. */
static enum gz_result check_objects(const struct gz_drawers *drawers,
				    const struct gz_object *objects, size_t count,
				    const struct gz_technique *out_techniques[GZ_DRAWERS_MAX],
				    size_t *out_count)
{
	if (count < 1) {
		gz_err(drawers->log,
		       "no object is visible; set visible = yes for one of the scene's");
		return GZ_ERR_UNSUPPORTED;
	}
	if (count > OBJECTS_MAX) {
		gz_err(drawers->log, "a picture shows at most %d objects, not %zu", OBJECTS_MAX,
		       count);
		return GZ_ERR_UNSUPPORTED;
	}
	*out_count = list_techniques(objects, count, out_techniques);
	if (*out_count > GZ_DRAWERS_MAX) {
		gz_err(drawers->log, "a picture has at most %d techniques", GZ_DRAWERS_MAX);
		return GZ_ERR_UNSUPPORTED;
	}
	enum gz_result result = check_sharing(drawers, out_techniques, *out_count);
	for (size_t i = 0; i < *out_count && result == GZ_OK; i++)
		result = check_counts(drawers, objects, count, out_techniques[i]);
	return result;
}

/* Sort objects by technique into items. */
static void sort_objects(const struct gz_object *objects, size_t count, struct gz_object *sorted,
			 struct gz_technique_drawer *items, size_t item_count)
{
	for (size_t i = 0; i < item_count; i++) {
		items[i].objects = sorted;
		items[i].object_count = 0;
		for (size_t k = 0; k < count; k++)
			if (objects[k].technique == items[i].technique)
				items[i].objects[items[i].object_count++] = objects[k];
		sorted += items[i].object_count;
	}
}

/* Keep the drawer of a technique that stays. */
static void keep_drawer(struct gz_drawers *drawers, struct gz_technique_drawer *item)
{
	for (size_t i = 0; i < drawers->count; i++)
		if (drawers->items[i].technique == item->technique) {
			item->drawer = drawers->items[i].drawer;
			drawers->items[i].drawer = NULL;
		}
}

/* The backend of an item: the one that is asked for. Of several techniques, those that lack it
 * choose for themselves; the last one makes the picture and has no choice. */
static const char *backend_of(const struct gz_drawers *drawers,
			      const struct gz_technique_drawer *item)
{
	const struct gz_technique_drawer *last = &drawers->items[drawers->count - 1];
	if (!drawers->backend || item == last)
		return drawers->backend;
	for (const char *const *name = item->technique->backends; *name; name++)
		if (strcmp(*name, drawers->backend) == 0)
			return drawers->backend;
	return "auto";
}

/* Open the drawer of an item if it is not, and show its objects. */
static enum gz_result show_item(const struct gz_drawers *drawers, struct gz_technique_drawer *item)
{
	enum gz_result result = GZ_OK;
	if (!item->drawer)
		result = item->technique->create(backend_of(drawers, item), drawers->backend_params,
						 drawers->log, &item->drawer);
	return result == GZ_OK
		       ? item->drawer->ops->show(item->drawer, item->objects, item->object_count)
		       : result;
}

enum gz_result gz_drawers_show(struct gz_drawers *drawers, const struct gz_object *objects,
			       size_t count)
{
	const struct gz_technique *techniques[GZ_DRAWERS_MAX];
	struct gz_technique_drawer items[GZ_DRAWERS_MAX] = { 0 };
	size_t item_count = 0;
	enum gz_result result = check_objects(drawers, objects, count, techniques, &item_count);
	struct gz_object *sorted = result == GZ_OK ? malloc(count * sizeof *sorted) : NULL;
	if (!sorted) {
		gz_drawers_close(drawers);
		return result == GZ_OK ? GZ_ERR_NO_MEM : result;
	}
	for (size_t i = 0; i < item_count; i++) {
		items[i].technique = techniques[i];
		keep_drawer(drawers, &items[i]);
	}
	sort_objects(objects, count, sorted, items, item_count);
	gz_drawers_close(drawers);
	free(drawers->objects);
	drawers->objects = sorted;
	drawers->count = item_count;
	memcpy(drawers->items, items, sizeof items);
	for (size_t i = 0; i < item_count && result == GZ_OK; i++)
		result = show_item(drawers, &drawers->items[i]);
	return result;
}

struct gz_drawer *gz_drawers_last(const struct gz_drawers *drawers)
{
	return drawers->count > 0 ? drawers->items[drawers->count - 1].drawer : NULL;
}

/* Add what one drawer has cost to what those before it have. */
static void add_stats(const struct gz_frame_stats *before, struct gz_frame_stats *stats)
{
	stats->samples += before->samples;
	stats->prepare_ms += before->prepare_ms;
	stats->prepare_within_ms += before->prepare_within_ms;
	stats->cast_ms += before->cast_ms;
	stats->reconstruct_ms += before->reconstruct_ms;
	stats->bricks_coming += before->bricks_coming;
}

/* What the drawers of a picture keep back of the light. */
struct shades {
	struct gz_shade of[GZ_DRAWERS_MAX];     /* by drawer */
	struct gz_shade others[GZ_DRAWERS_MAX]; /* those that fall on one drawer */
};

_Static_assert(GZ_DRAWERS_MAX <= GZ_SHADES_MAX, "a shot holds the shades of all other drawers");

static enum gz_result find_shades(const struct gz_drawers *drawers, const struct gz_shot *shot,
				  struct shades *shades)
{
	enum gz_result result = GZ_OK;
	for (size_t i = 0; i < drawers->count && result == GZ_OK; i++) {
		struct gz_drawer *drawer = drawers->items[i].drawer;
		if (drawer->ops->shade)
			result = drawer->ops->shade(drawer, shot, &shades->of[i]);
	}
	return result;
}

/* Put into the shot of one drawer the shades of the others. */
static void take_shades_of_others(size_t drawer, size_t count, struct shades *shades,
				  struct gz_shot *shot)
{
	shot->shades = shades->others;
	shot->shade_count = 0;
	for (size_t i = 0; i < count; i++)
		if (i != drawer && shades->of[i].find)
			shades->others[shot->shade_count++] = shades->of[i];
}

enum gz_result gz_drawers_draw(struct gz_drawers *drawers, const struct gz_shot *shot,
			       struct gz_image *image, struct gz_frame_stats *out_stats)
{
	const size_t last = drawers->count - 1;
	struct gz_frame_stats sum = { 0 }, stats = { 0 };
	struct gz_shot joined = *shot;
	struct shades shades = { 0 };
	enum gz_result result = GZ_OK;
	if (last > 0) {
		joined.hits = &drawers->hits;
		result = gz_ray_hits_clear(&drawers->hits, shot->plan);
	}
	if (last > 0 && result == GZ_OK)
		result = find_shades(drawers, shot, &shades);
	for (size_t i = 0; i < last && result == GZ_OK; i++) {
		struct gz_drawer *drawer = drawers->items[i].drawer;
		take_shades_of_others(i, drawers->count, &shades, &joined);
		result = drawer->ops->cast_hits(drawer, &joined, &stats);
		add_stats(&stats, &sum);
	}
	struct gz_drawer *drawer = drawers->items[last].drawer;
	take_shades_of_others(last, drawers->count, &shades, &joined);
	if (result == GZ_OK)
		result = drawer->ops->draw(drawer, &joined, image, &stats);
	add_stats(&sum, &stats);
	if (result == GZ_OK && out_stats)
		*out_stats = stats;
	return result;
}

/* One technique of a picture has objects behind each other, so the nearer pick is all that shows.
 */
enum gz_result gz_drawers_pick(struct gz_drawers *drawers, const struct gz_pick_request *request,
			       struct gz_pick *out_pick)
{
	struct gz_pick nearest = { 0 }, pick;
	enum gz_result result = GZ_OK;
	for (size_t i = 0; i < drawers->count && result == GZ_OK; i++) {
		struct gz_drawer *drawer = drawers->items[i].drawer;
		if (!drawer->ops->pick)
			continue;
		result = drawer->ops->pick(drawer, request, &pick);
		if (result == GZ_OK && pick.count > 0 &&
		    (nearest.count == 0 || pick.depths[0] < nearest.depths[0]))
			nearest = pick;
	}
	if (result == GZ_OK)
		*out_pick = nearest;
	return result;
}

enum gz_result gz_drawers_take_cpu(struct gz_drawers *drawers)
{
	struct gz_technique_drawer *last = &drawers->items[drawers->count - 1];
	gz_drawer_destroy(&last->drawer);
	const enum gz_result result = last->technique->create("cpu", drawers->backend_params,
							      drawers->log, &last->drawer);
	return result == GZ_OK ? show_item(drawers, last) : result;
}

bool gz_drawers_settings_same(const struct gz_drawers *drawers, const void *a, const void *b)
{
	for (size_t i = 0; i < drawers->count; i++)
		if (!gz_technique_settings_same(drawers->items[i].technique, a, b))
			return false;
	return true;
}

void gz_drawers_close(struct gz_drawers *drawers)
{
	for (size_t i = 0; i < drawers->count; i++)
		gz_drawer_destroy(&drawers->items[i].drawer);
	drawers->count = 0;
}

void gz_drawers_free(struct gz_drawers *drawers)
{
	gz_drawers_close(drawers);
	gz_ray_hits_free(&drawers->hits);
	free(drawers->objects);
	drawers->objects = NULL;
}
