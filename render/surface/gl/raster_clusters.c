#include "render/surface/gl/raster_clusters.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "render/mesh/mesh_read.h"

/* Blocks along the longest edge of a mesh's box. Measured: fewer hold much that a layer at the gaze
 * does not show, and more cost as much to look at as they save. */
enum { EDGE_BLOCKS = 16, BLOCKS = EDGE_BLOCKS * EDGE_BLOCKS * EDGE_BLOCKS };

/* A mesh in sorting. */
struct sorting {
	const struct gz_mesh *mesh;
	double least[3];
	double blocks_per_mm;
	uint32_t (*triangles)[3]; /* sorted */
	uint16_t *blocks;         /* of each triangle of the mesh */
	struct gz_raster_clusters *clusters;
	size_t room; /* for clusters */
};

static const struct gz_raster_box empty_box = { { INFINITY, INFINITY, INFINITY },
						{ -INFINITY, -INFINITY, -INFINITY } };

static uint16_t block_of(const struct sorting *sorting, size_t triangle)
{
	const uint32_t *corners = sorting->mesh->triangles[triangle];
	int block = 0;
	for (int axis = 2; axis >= 0; axis--) {
		double sum = 0;
		for (int i = 0; i < 3; i++)
			sum += (double)sorting->mesh->positions[corners[i]][axis];
		const double at = (sum / 3 - sorting->least[axis]) * sorting->blocks_per_mm;
		const int index = at > 0 ? (int)fmin(at, EDGE_BLOCKS - 1) : 0;
		block = block * EDGE_BLOCKS + index;
	}
	return (uint16_t)block;
}

static struct gz_raster_box box_of(const struct sorting *sorting, size_t first, size_t end)
{
	struct gz_raster_box box = empty_box;
	for (size_t i = 3 * first; i < 3 * end; i++) {
		const float *position = sorting->mesh->positions[sorting->triangles[i / 3][i % 3]];
		for (int axis = 0; axis < 3; axis++) {
			box.least[axis] = fmin(box.least[axis], (double)position[axis]);
			box.greatest[axis] = fmax(box.greatest[axis], (double)position[axis]);
		}
	}
	return box;
}

static enum gz_result add_cluster(struct sorting *sorting, size_t first, size_t end)
{
	struct gz_raster_clusters *clusters = sorting->clusters;
	if (clusters->count == sorting->room) {
		const size_t room = sorting->room ? 2 * sorting->room : 256;
		struct gz_raster_cluster *items =
			realloc(clusters->items, room * sizeof *clusters->items);
		if (!items)
			return GZ_ERR_NO_MEM;
		clusters->items = items;
		sorting->room = room;
	}
	clusters->items[clusters->count++] =
		(struct gz_raster_cluster) { 3 * first, 3 * (end - first),
					     box_of(sorting, first, end) };
	return GZ_OK;
}

/* Sort the triangles [from, to) of the mesh by their blocks, each block's in their order. */
static enum gz_result sort_triangles(struct sorting *sorting, size_t from, size_t to)
{
	size_t ends[BLOCKS + 1] = { 0 };
	enum gz_result result = GZ_OK;
	for (size_t i = from; i < to; i++)
		ends[sorting->blocks[i] + 1]++;
	ends[0] = from;
	for (int block = 0; block < BLOCKS; block++)
		ends[block + 1] += ends[block];
	/* each start moves to the end of its block */
	for (size_t i = from; i < to; i++)
		memcpy(sorting->triangles[ends[sorting->blocks[i]]++], sorting->mesh->triangles[i],
		       sizeof sorting->triangles[0]);
	for (int block = 0; block < BLOCKS && result == GZ_OK; block++) {
		const size_t start = block > 0 ? ends[block - 1] : from;
		if (start < ends[block])
			result = add_cluster(sorting, start, ends[block]);
	}
	return result;
}

enum gz_result gz_raster_clusters_make(const struct gz_mesh *mesh, uint32_t (*out_triangles)[3],
				       struct gz_raster_clusters *out_clusters)
{
	struct gz_raster_clusters clusters = { 0 };
	struct gz_raster_box box = empty_box;
	const size_t own = mesh->triangle_count - mesh->shared_count;
	struct sorting sorting = { .mesh = mesh,
				   .triangles = out_triangles,
				   .blocks =
					   calloc(mesh->triangle_count + 1, sizeof *sorting.blocks),
				   .clusters = &clusters };
	if (!sorting.blocks)
		return GZ_ERR_NO_MEM;
	gz_mesh_bound(mesh, box.least, box.greatest);
	double longest = 0;
	for (int axis = 0; axis < 3; axis++)
		longest = fmax(longest, box.greatest[axis] - box.least[axis]);
	memcpy(sorting.least, box.least, sizeof sorting.least);
	sorting.blocks_per_mm = longest > 0 ? EDGE_BLOCKS / longest : 0;
	for (size_t i = 0; i < mesh->triangle_count; i++)
		sorting.blocks[i] = block_of(&sorting, i);
	enum gz_result result = sort_triangles(&sorting, 0, own);
	clusters.own_count = clusters.count;
	if (result == GZ_OK)
		result = sort_triangles(&sorting, own, mesh->triangle_count);
	free(sorting.blocks);
	if (result == GZ_OK)
		*out_clusters = clusters;
	else
		gz_raster_clusters_free(&clusters);
	return result;
}

/* A rectangle of the picture, pixels. */
struct pixel_rectangle {
	double from[2], to[2];
};

static bool shows_cluster(const struct gz_raster_cluster *cluster,
			  const struct gz_raster_view *view, const struct pixel_rectangle *seen,
			  const struct pixel_rectangle *hidden)
{
	return gz_raster_view_shows(view, &cluster->box, seen->from, seen->to) &&
	       !(hidden && gz_raster_view_holds(view, &cluster->box, hidden->from, hidden->to));
}

size_t gz_raster_clusters_choose(const struct gz_raster_clusters *clusters, size_t from, size_t to,
				 const struct gz_raster_view *view,
				 const struct gz_raster_layer *lattice,
				 struct gz_raster_run *out_runs)
{
	struct pixel_rectangle seen, hidden;
	bool hides = true;
	size_t count = 0;
	for (int axis = 0; axis < 2; axis++) {
		const int start = lattice->from[axis], spacing = lattice->spacing;
		seen.from[axis] = start - spacing;
		seen.to[axis] = start + (double)lattice->points[axis] * spacing;
		/* from the first to the last point that is not drawn */
		hidden.from[axis] = start + (double)lattice->hidden[0][axis] * spacing;
		hidden.to[axis] = start + (double)(lattice->hidden[1][axis] - 1) * spacing;
		hides = hides && hidden.from[axis] < hidden.to[axis];
	}
	for (size_t i = from; i < to; i++) {
		const struct gz_raster_cluster *cluster = &clusters->items[i];
		struct gz_raster_run *last = count > 0 ? &out_runs[count - 1] : NULL;
		if (!shows_cluster(cluster, view, &seen, hides ? &hidden : NULL))
			continue;
		if (last && last->first + last->corners == cluster->first)
			last->corners += cluster->corners;
		else
			out_runs[count++] =
				(struct gz_raster_run) { cluster->first, cluster->corners };
	}
	return count;
}

void gz_raster_clusters_free(struct gz_raster_clusters *clusters)
{
	free(clusters->items);
	*clusters = (struct gz_raster_clusters) { 0 };
}
