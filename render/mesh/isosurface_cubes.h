/* The cubes between four rows of voxels: how many triangles they have, and which. Compiled once for
 * each instruction set: isosurface_kernels.h. */
#ifndef GZ_RENDER_MESH_ISOSURFACE_CUBES_H
#define GZ_RENDER_MESH_ISOSURFACE_CUBES_H

#include "render/data/volume.h"
#include "render/mesh/cube_tables.h"
#include "render/mesh/isosurface_rows.h"

/* Find the four rows from @p row on. */
static struct gz_iso_beam beam_at(const struct gz_iso_job *job, size_t row)
{
	const size_t rows = (size_t)job->volume->dims[1], slices = (size_t)job->volume->dims[2];
	const bool more_y = row % rows + 1 < rows, more_z = row / rows + 1 < slices;
	struct gz_iso_beam beam = { .cubes = more_y && more_z };
	for (size_t r = 0; r < 4; r++) {
		beam.row[r] = row + (more_y ? r & 1 : 0) + (more_z ? (r >> 1) * rows : 0);
		beam.bits[r] = job->bits + beam.row[r] * job->words;
	}
	return beam;
}

/* The cubes of a word whose corners are not all alike. */
static uint32_t find_active(const struct gz_iso_windows *windows, uint32_t inner)
{
	const uint64_t *row = windows->row;
	const uint64_t any = row[0] | row[1] | row[2] | row[3];
	const uint64_t all = row[0] & row[1] & row[2] & row[3];
	return (uint32_t)((any | any >> 1) & ~(all & all >> 1)) & inner;
}

/* The case of cube @p i of a word: cube_tables.h. */
static unsigned case_at(const struct gz_iso_windows *windows, unsigned i)
{
	unsigned found = 0;
	for (unsigned r = 0; r < 4; r++)
		found |= (unsigned)(windows->row[r] >> i & 3) << 2 * r;
	return found;
}

/* How far the corners' values are above the isovalue. */
static void corner_heights(const struct gz_iso_job *job, const struct gz_iso_beam *beam, size_t x,
			   double out_heights[8])
{
	const struct gz_volume *volume = job->volume;
	for (size_t corner = 0; corner < 8; corner++) {
		const size_t index =
			beam->row[corner >> 1] * (size_t)volume->dims[0] + x + (corner & 1);
		out_heights[corner] = gz_voxel_stored(volume->type, volume->voxels, index) -
				      (double)job->isovalue;
	}
}

/*
 * Whether the surface on a face separates the other two corners, so that the lowest and the highest
 * corner are joined. The saddle of a bilinear interpolation has the height (lowest * highest - one
 * * other) / (lowest + highest - one - other), and the sign of the denominator is that of `lowest`.
 * The cubes beside the face compute the same products; NaN makes both say no.
 */
static bool lowest_joined(const double heights[8], unsigned face)
{
	const unsigned axis = face >> 1, lowest = (face & 1) << axis;
	const unsigned u = 1U << (axis == 0 ? 1 : 0), v = 1U << (axis == 2 ? 1 : 2);
	return heights[lowest] * heights[lowest | u | v] >=
	       heights[lowest | u] * heights[lowest | v];
}

/* The variant of a case with ambiguous faces, by the values at the corners. Not inlined: most cubes
 * have none. */
static __attribute__((noinline)) unsigned decide_variant(const struct gz_iso_job *job,
							 const struct gz_iso_beam *beam, size_t x,
							 unsigned set)
{
	double heights[8];
	corner_heights(job, beam, x, heights);
	unsigned variant = gz_cube_first[set], bit = 1;
	for (unsigned face = 0; face < 6; face++) {
		if (!(gz_cube_ambiguous[set] >> face & 1))
			continue;
		variant += lowest_joined(heights, face) ? bit : 0;
		bit <<= 1;
	}
	return variant;
}

/* The variant of a cube of case @p set. */
static inline unsigned variant_of(const struct gz_iso_job *job, const struct gz_iso_beam *beam,
				  size_t x, unsigned set)
{
	return gz_cube_ambiguous[set] ? decide_variant(job, beam, x, set) : gz_cube_first[set];
}

/* The triangles of the cubes of a word. */
static uint32_t count_triangles(const struct gz_iso_job *job, const struct gz_iso_beam *beam,
				const struct gz_iso_windows *windows, size_t at)
{
	uint32_t count = 0;
	uint32_t active = find_active(windows, gz_iso_inner(job, at));
	for (; active; active &= active - 1) {
		const unsigned i = (unsigned)__builtin_ctz(active);
		const unsigned variant =
			variant_of(job, beam, at * GZ_ISO_WORD + i, case_at(windows, i));
		count += (uint32_t)gz_cube_offset[variant + 1] - gz_cube_offset[variant];
	}
	return count;
}

/* gz_iso_kernels.count_row */
static void count_iso_row(const struct gz_iso_job *job, size_t row)
{
	const struct gz_iso_beam beam = beam_at(job, row);
	int edges[3] = { 0 };
	uint32_t triangles = 0;
	for (size_t at = 0; at + 1 < job->words; at++) {
		struct gz_iso_windows windows;
		if (!gz_iso_windows_read(&beam, at, &windows))
			continue;
		for (int axis = 0; axis < 3; axis++)
			edges[axis] += __builtin_popcount(
				gz_iso_crossed(&windows, axis, gz_iso_inner(job, at)));
		if (beam.cubes)
			triangles += count_triangles(job, &beam, &windows, at);
	}
	job->rows[row] = (struct gz_iso_row) {
		.vertex = (uint32_t)(edges[0] + edges[1] + edges[2]),
		.triangle = triangles,
		.x_edges = (uint16_t)edges[0],
		.y_edges = (uint16_t)edges[1],
	};
}

/* Four numbers of vertices; compilers make one register of them. */
typedef uint32_t four_vertices __attribute__((vector_size(16)));

/* The vertices of the next crossed edges, and where the next triangle goes. */
struct cube_walk {
	four_vertices x;    /* of each row of the beam */
	four_vertices y, z; /* twice that of the first pair of rows, twice that of the second */
	uint32_t *triangle;
	int second, third; /* places of a triangle's corners: exchanged if data values fall */
};

/* At the first cube of a beam. */
static struct cube_walk start_walk(const struct gz_iso_job *job, const struct gz_iso_beam *beam)
{
	struct cube_walk walk = {
		.triangle = job->mesh->triangles[0] + 3 * (size_t)job->rows[beam->row[0]].triangle,
		.second = job->falling ? 2 : 1,
		.third = job->falling ? 1 : 2,
	};
	for (int r = 0; r < 4; r++) {
		const struct gz_iso_row *above = &job->rows[beam->row[r & 2]];
		const struct gz_iso_row *behind = &job->rows[beam->row[r >> 1]];
		walk.x[r] = job->rows[beam->row[r]].vertex;
		walk.y[r] = above->vertex + above->x_edges;
		walk.z[r] = behind->vertex + behind->x_edges + behind->y_edges;
	}
	return walk;
}

/* For each edge that starts at a corner in @p corners and is crossed according to @p edges: all
 * bits, else none. */
static inline four_vertices crossed_at(unsigned edges, four_vertices corners)
{
	const four_vertices all = { edges, edges, edges, edges };
	return (four_vertices)((all & corners) == corners);
}

/* Write the triangles of a cube and walk on to the next one. */
static inline void write_cube(struct cube_walk *walk, unsigned set, unsigned variant)
{
	/* A bit for each edge along an axis, at the corner where it starts. The first two edges
	 * along y, and the last two, are of the same rows, and so are those along z. */
	const four_vertices x = crossed_at(set ^ set >> 1, (four_vertices) { 1, 4, 16, 64 });
	const four_vertices y = crossed_at(set ^ set >> 2, (four_vertices) { 1, 1, 16, 16 });
	const four_vertices z = crossed_at(set ^ set >> 4, (four_vertices) { 1, 1, 4, 4 });
	const four_vertices later = { 0, UINT32_MAX, 0, UINT32_MAX };
	/* subtracting all bits adds 1 */
	const four_vertices vertex[3] = { walk->x, walk->y - (y & later), walk->z - (z & later) };
	const uint32_t *number = (const uint32_t *)vertex;
	const uint8_t *corner = gz_cube_corners + 3 * (size_t)gz_cube_offset[variant];
	const uint8_t *end = gz_cube_corners + 3 * (size_t)gz_cube_offset[variant + 1];
	uint32_t *triangle = walk->triangle;
	for (; corner < end; corner += 3, triangle += 3) {
		triangle[0] = number[corner[0]];
		triangle[walk->second] = number[corner[1]];
		triangle[walk->third] = number[corner[2]];
	}
	walk->triangle = triangle;
	walk->x -= x;
	walk->y -= y;
	walk->z -= z;
}

/* gz_iso_kernels.write_triangles */
static void write_iso_triangles(const struct gz_iso_job *job, size_t row)
{
	if (job->rows[row].triangle == job->rows[row + 1].triangle)
		return;
	const struct gz_iso_beam beam = beam_at(job, row);
	struct cube_walk walk = start_walk(job, &beam);
	for (size_t at = 0; at + 1 < job->words; at++) {
		struct gz_iso_windows windows;
		if (!gz_iso_windows_read(&beam, at, &windows))
			continue;
		uint32_t active = find_active(&windows, gz_iso_inner(job, at));
		for (; active; active &= active - 1) {
			const unsigned i = (unsigned)__builtin_ctz(active);
			const unsigned set = case_at(&windows, i);
			write_cube(&walk, set, variant_of(job, &beam, at * GZ_ISO_WORD + i, set));
		}
	}
}

#endif
