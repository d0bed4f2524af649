/* The vertices on the crossed edges of a row of voxels: where they are, and their normals. Compiled
 * once for each instruction set: isosurface_kernels.h. */
#ifndef GZ_RENDER_MESH_ISOSURFACE_VERTICES_H
#define GZ_RENDER_MESH_ISOSURFACE_VERTICES_H

#include <math.h>

#include "render/data/volume.h"
#include "render/mesh/isosurface_cubes.h"
#include "render/mesh/isosurface_rows.h"

/* Vertices that are computed together, so that the loops over them become SIMD. Chosen: what they
 * need lies in the fastest cache. */
enum { BATCH = 96 };

/* Crossed edges along one axis that start in one row. */
struct edge_batch {
	size_t first; /* number of the first vertex */
	int count;
	uint32_t x[BATCH]; /* of the voxel where the edge starts */
	/* Of both ends: the stored value, and its gradient per mm. */
	float value[2][BATCH];
	float gradient[2][3][BATCH];
	/* Results. */
	float share[BATCH]; /* of the edge, before the vertex */
	float normal[3][BATCH];
};

/* How central differences are taken along an axis at the ends of an edge: at the border of the
 * volume, one-sided. */
struct difference {
	ptrdiff_t before, behind; /* voxels to the neighbours */
	float scale;              /* 1 / their distance, 1/mm */
};

/* Where a row and an axis lie in the volume. */
struct edge_row {
	const struct gz_iso_job *job;
	size_t row, y, z;
	int axis;
	ptrdiff_t step; /* voxels from the start of an edge to its end */
	/* Of both ends, along y and z. Along x it depends on the voxel. */
	struct difference across[2][2];
};

/* How the difference is taken along an axis at voxel @p at of it. */
static struct difference difference_at(const struct gz_iso_job *job, int axis, size_t at,
				       ptrdiff_t stride)
{
	const bool before = at > 0, behind = at + 1 < (size_t)job->volume->dims[axis];
	return (struct difference) {
		.before = before ? stride : 0,
		.behind = behind ? stride : 0,
		.scale = before && behind ? job->per_mm[axis] * 0.5F : job->per_mm[axis],
	};
}

/* The edges along an axis that start in a row. */
static struct edge_row edge_row_at(const struct gz_iso_job *job, size_t row, int axis)
{
	const struct gz_volume *volume = job->volume;
	const size_t rows = (size_t)volume->dims[1];
	const ptrdiff_t stride[3] = { 1, volume->dims[0],
				      (ptrdiff_t)volume->dims[0] * volume->dims[1] };
	struct edge_row at = {
		.job = job,
		.row = row,
		.y = row % rows,
		.z = row / rows,
		.axis = axis,
		.step = stride[axis],
	};
	for (size_t end = 0; end < 2; end++) {
		const size_t y = at.y + (axis == 1 ? end : 0), z = at.z + (axis == 2 ? end : 0);
		at.across[end][0] = difference_at(job, 1, y, stride[1]);
		at.across[end][1] = difference_at(job, 2, z, stride[2]);
	}
	return at;
}

/* Read what a batch needs, of one end of its edges. */
#define DEFINE_READ(name, type, difference_type)                                              \
	static void name(const struct edge_row *at, int end, struct edge_batch *batch)        \
	{                                                                                     \
		const struct gz_volume *volume = at->job->volume;                             \
		const type *row =                                                             \
			(const type *)volume->voxels + at->row * (size_t)volume->dims[0];     \
		const struct difference y = at->across[end][0], z = at->across[end][1];       \
		const uint32_t last = (uint32_t)volume->dims[0] - 1;                          \
		const float per_mm = at->job->per_mm[0];                                      \
		const uint32_t along = end && at->axis == 0;                                  \
		for (int i = 0; i < batch->count; i++) {                                      \
			const uint32_t x = batch->x[i] + along;                               \
			const type *v = row + batch->x[i] + (end ? at->step : 0);             \
			const bool inside = x > 0 && x < last;                                \
			batch->value[end][i] = (float)*v;                                     \
			batch->gradient[end][0][i] =                                          \
				(float)((difference_type)v[x < last] -                        \
					(difference_type)v[-(ptrdiff_t)(x > 0)]) *            \
				(inside ? per_mm * 0.5F : per_mm);                            \
			batch->gradient[end][1][i] = (float)((difference_type)v[y.behind] -   \
							     (difference_type)v[-y.before]) * \
						     y.scale;                                 \
			batch->gradient[end][2][i] = (float)((difference_type)v[z.behind] -   \
							     (difference_type)v[-z.before]) * \
						     z.scale;                                 \
		}                                                                             \
	}

DEFINE_READ(read_u8, uint8_t, int)
DEFINE_READ(read_u16, uint16_t, int)
DEFINE_READ(read_f32, float, float)

/* Read what a batch needs, of both ends of its edges. */
static void read_batch(const struct edge_row *at, struct edge_batch *batch)
{
	static void (*const readers[GZ_VOXEL_TYPE_COUNT])(const struct edge_row *, int,
							  struct edge_batch *) = {
		[GZ_VOXEL_U8] = read_u8,
		[GZ_VOXEL_U16] = read_u16,
		[GZ_VOXEL_F32] = read_f32,
	};
	for (int end = 0; end < 2; end++)
		readers[at->job->volume->type](at, end, batch);
}

/* Halves keep differences of the largest numbers finite; the quotient is the same. NaN, or two
 * infinities, put the vertex midway. */
static void find_shares(struct edge_batch *batch, float isovalue)
{
	for (int i = 0; i < batch->count; i++) {
		const float from = batch->value[0][i] * 0.5F, to = batch->value[1][i] * 0.5F;
		const float share = (isovalue * 0.5F - from) / (to - from);
		batch->share[i] = share >= 0 && share <= 1 ? share : 0.5F;
	}
}

/* The greater of two numbers; b if one is NaN. */
static float greater_of(float a, float b)
{
	return a > b ? a : b;
}

/*
 * Normals of length 1. Dividing by the greatest component first keeps squares of gradients of any
 * size within range. Without a gradient, the normal runs along the edge.
 */
static void find_normals(const struct edge_row *at, struct edge_batch *batch)
{
	const float sign = at->job->falling ? 1.0F : -1.0F, isovalue = at->job->isovalue;
	const float along[3] = { at->axis == 0, at->axis == 1, at->axis == 2 };
	for (int i = 0; i < batch->count; i++) {
		const float share = batch->share[i], rest = 1 - share;
		const float x = rest * batch->gradient[0][0][i] + share * batch->gradient[1][0][i];
		const float y = rest * batch->gradient[0][1][i] + share * batch->gradient[1][1][i];
		const float z = rest * batch->gradient[0][2][i] + share * batch->gradient[1][2][i];
		const float most = greater_of(greater_of(fabsf(x), fabsf(y)), fabsf(z));
		const float scale = sign / most;
		const float a = x * scale, b = y * scale, c = z * scale;
		const float square = a * a + b * b + c * c; /* 1 to 3, or not a number */
		const float unit = 1 / sqrtf(square);
		const float rises = batch->value[0][i] >= isovalue ? -sign : sign;
		const bool good = square > 0.5F && square < 4;
		batch->normal[0][i] = good ? a * unit : rises * along[0];
		batch->normal[1][i] = good ? b * unit : rises * along[1];
		batch->normal[2][i] = good ? c * unit : rises * along[2];
	}
}

/* Write the vertices of a batch. */
static void store_batch(const struct edge_row *at, const struct edge_batch *batch)
{
	const struct gz_iso_job *job = at->job;
	const float *x = job->places[0];
	const float y = job->places[1][at->y], z = job->places[2][at->z];
	float along[3] = { 0 };
	along[at->axis] = (float)job->volume->spacing[at->axis];
	float(*positions)[3] = job->mesh->positions + batch->first;
	float(*normals)[3] = job->mesh->normals + batch->first;
	for (int i = 0; i < batch->count; i++) {
		const float share = batch->share[i];
		positions[i][0] = x[batch->x[i]] + share * along[0];
		positions[i][1] = y + share * along[1];
		positions[i][2] = z + share * along[2];
		for (int a = 0; a < 3; a++)
			normals[i][a] = batch->normal[a][i];
	}
}

/* Compute a batch, write its vertices and empty it. */
static void finish_batch(const struct edge_row *at, struct edge_batch *batch)
{
	read_batch(at, batch);
	find_shares(batch, at->job->isovalue);
	find_normals(at, batch);
	store_batch(at, batch);
	batch->first += (size_t)batch->count;
	batch->count = 0;
}

/* Add the crossed edges of a word to a batch. */
static void add_to_batch(const struct edge_row *at, struct edge_batch *batch, size_t word,
			 uint32_t crossed)
{
	if (batch->count + GZ_ISO_WORD > BATCH)
		finish_batch(at, batch);
	for (; crossed; crossed &= crossed - 1)
		batch->x[batch->count++] =
			(uint32_t)(word * GZ_ISO_WORD) + (uint32_t)__builtin_ctz(crossed);
}

/* Write the vertices of all crossed edges along the three axes that start in a row. */
static void write_edges(const struct gz_iso_job *job, const struct gz_iso_beam *beam,
			const struct edge_row at[3], struct edge_batch batch[3])
{
	for (size_t word = 0; word + 1 < job->words; word++) {
		struct gz_iso_windows windows;
		if (!gz_iso_windows_read(beam, word, &windows))
			continue;
		const uint32_t inner = gz_iso_inner(job, word);
		for (int axis = 0; axis < 3; axis++)
			add_to_batch(&at[axis], &batch[axis], word,
				     gz_iso_crossed(&windows, axis, inner));
	}
	for (int axis = 0; axis < 3; axis++)
		finish_batch(&at[axis], &batch[axis]);
}

/* gz_iso_kernels.write_vertices */
static void write_iso_vertices(const struct gz_iso_job *job, size_t row)
{
	const struct gz_iso_row *own = &job->rows[row];
	if (own->vertex == own[1].vertex)
		return;
	const struct gz_iso_beam beam = beam_at(job, row);
	struct edge_row at[3];
	struct edge_batch batch[3];
	for (int axis = 0; axis < 3; axis++) {
		at[axis] = edge_row_at(job, row, axis);
		batch[axis].count = 0;
	}
	batch[0].first = own->vertex;
	batch[1].first = batch[0].first + own->x_edges;
	batch[2].first = batch[1].first + own->y_edges;
	write_edges(job, &beam, at, batch);
}

#endif
