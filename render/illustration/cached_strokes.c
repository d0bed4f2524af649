#include "render/illustration/cached_strokes.h"

#include <math.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "render/illustration/kept_numbers.h"

/* What a file holds, in floats: the number of strokes in two, their length and the mesh's area;
 * then of each stroke its nodes and the length before it; then of each node its place and normal.
 */
enum {
	AT_STROKES = 0,
	AT_LENGTH = 2,
	AT_AREA = AT_LENGTH + GZ_KEPT_DOUBLE_FLOATS,
	STROKES_HEAD = AT_AREA + GZ_KEPT_DOUBLE_FLOATS,
	STROKE_FLOATS = 2,
	NODE_FLOATS = 6,
	FLOATS_MAX = 1 << 26,
};

/* Of a number of two floats. */
#define HALF_WHOLE ((size_t)1 << 16)

static enum gz_result make_strokes_key(const struct gz_mesh *mesh,
				       const struct gz_cached_strokes_kind *kind,
				       struct gz_mesh_key *out_key)
{
	/* Another way to trace needs another number. */
	char purpose[128];
	snprintf(purpose, sizeof purpose, "mesh strokes 1, %zu, %d, %.17g, %d", kind->points,
		 kind->passes, kind->share, kind->across);
	return gz_mesh_key_make(mesh, purpose, out_key);
}

static void keep_stroke(const struct gz_hatch_strokes *strokes, size_t index, float **stroke_floats,
			float **node_floats)
{
	const struct gz_hatch_stroke *stroke = &strokes->strokes[index];
	(*stroke_floats)[0] = (float)stroke->count;
	(*stroke_floats)[1] = stroke->before_mm;
	*stroke_floats += STROKE_FLOATS;
	for (uint32_t i = 0; i < stroke->count; i++) {
		const struct gz_hatch_node *node = &strokes->nodes[stroke->first + i];
		memcpy(*node_floats, node->place, sizeof node->place);
		memcpy(*node_floats + 3, node->normal, sizeof node->normal);
		*node_floats += NODE_FLOATS;
	}
}

enum gz_result gz_cached_strokes_store(const struct gz_mesh *mesh,
				       const struct gz_cached_strokes_kind *kind,
				       const struct gz_mesh_cache_place *place,
				       const struct gz_log *log,
				       const struct gz_hatch_strokes *strokes)
{
	const size_t floats = STROKES_HEAD + STROKE_FLOATS * strokes->stroke_count +
			      NODE_FLOATS * strokes->node_count;
	struct gz_mesh_key key;
	if (floats > FLOATS_MAX)
		return GZ_ERR_FULL;
	const struct gz_mesh_cache_array all = { malloc(floats * sizeof(float)), floats };
	enum gz_result result = all.values ? make_strokes_key(mesh, kind, &key) : GZ_ERR_NO_MEM;
	if (result == GZ_OK) {
		float *stroke_floats = all.values + STROKES_HEAD;
		float *node_floats = stroke_floats + STROKE_FLOATS * strokes->stroke_count;
		all.values[AT_STROKES] = (float)(strokes->stroke_count / HALF_WHOLE);
		all.values[AT_STROKES + 1] = (float)(strokes->stroke_count % HALF_WHOLE);
		gz_keep_double(strokes->length_mm, all.values + AT_LENGTH);
		gz_keep_double(strokes->area_mm2, all.values + AT_AREA);
		for (size_t i = 0; i < strokes->stroke_count; i++)
			keep_stroke(strokes, i, &stroke_floats, &node_floats);
		result = gz_mesh_cache_store(place, &key, &all, 1, log);
	}
	free(all.values);
	return result;
}

/* How many strokes and nodes the floats say and have room for. */
static bool read_counts(const struct gz_mesh_cache_array *all, struct gz_hatch_strokes *out_strokes)
{
	size_t high, low;
	if (all->count < STROKES_HEAD ||
	    !gz_kept_whole(all->values[AT_STROKES], 0, HALF_WHOLE - 1, &high) ||
	    !gz_kept_whole(all->values[AT_STROKES + 1], 0, HALF_WHOLE - 1, &low))
		return false;
	const size_t rest = all->count - STROKES_HEAD, strokes = high * HALF_WHOLE + low;
	if (strokes > rest / STROKE_FLOATS || (rest - STROKE_FLOATS * strokes) % NODE_FLOATS != 0)
		return false;
	out_strokes->stroke_count = strokes;
	out_strokes->node_count = (rest - STROKE_FLOATS * strokes) / NODE_FLOATS;
	return true;
}

/* Strokes of two nodes or more that follow each other and have all nodes, none longer before them
 * than all are. */
static bool read_strokes(const float *floats, struct gz_hatch_strokes *strokes)
{
	size_t first = 0, count;
	float before = 0;
	for (size_t i = 0; i < strokes->stroke_count; i++, floats += STROKE_FLOATS) {
		if (!gz_kept_whole(floats[0], 2, GZ_KEPT_WHOLE_MAX, &count) ||
		    count > strokes->node_count - first || !(floats[1] >= before))
			return false;
		before = floats[1];
		strokes->strokes[i] =
			(struct gz_hatch_stroke) { (uint32_t)first, (uint32_t)count, before };
		first += count;
	}
	return first == strokes->node_count;
}

static enum gz_result read_kept_strokes(const struct gz_mesh_cache_array *all,
					struct gz_hatch_strokes *out_strokes)
{
	struct gz_hatch_strokes strokes = { 0 };
	if (!read_counts(all, &strokes))
		return GZ_ERR_FORMAT;
	strokes.length_mm = gz_kept_double(all->values + AT_LENGTH);
	strokes.area_mm2 = gz_kept_double(all->values + AT_AREA);
	strokes.strokes = malloc((strokes.stroke_count + 1) * sizeof *strokes.strokes);
	strokes.nodes = malloc((strokes.node_count + 1) * sizeof *strokes.nodes);
	enum gz_result result = strokes.strokes && strokes.nodes ? GZ_OK : GZ_ERR_NO_MEM;
	const float *floats = all->values + STROKES_HEAD;
	if (result == GZ_OK && !read_strokes(floats, &strokes))
		result = GZ_ERR_FORMAT;
	floats += STROKE_FLOATS * strokes.stroke_count;
	for (size_t i = 0; i < strokes.node_count && result == GZ_OK; i++, floats += NODE_FLOATS) {
		memcpy(strokes.nodes[i].place, floats, sizeof strokes.nodes[i].place);
		memcpy(strokes.nodes[i].normal, floats + 3, sizeof strokes.nodes[i].normal);
	}
	if (result == GZ_OK)
		*out_strokes = strokes;
	else
		gz_hatch_strokes_free(&strokes);
	return result;
}

enum gz_result gz_cached_strokes_load(const struct gz_mesh *mesh,
				      const struct gz_cached_strokes_kind *kind,
				      const struct gz_mesh_cache_place *place,
				      const struct gz_log *log,
				      struct gz_hatch_strokes *out_strokes)
{
	struct gz_mesh_cache_array all;
	struct gz_mesh_key key;
	enum gz_result result = make_strokes_key(mesh, kind, &key);
	if (result == GZ_OK)
		result = gz_mesh_cache_load_whole(place, &key, FLOATS_MAX, log, &all);
	if (result != GZ_OK)
		return result;
	result = read_kept_strokes(&all, out_strokes);
	free(all.values);
	return result;
}
