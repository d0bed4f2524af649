#include "render/mesh/isosurface.h"

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "render/mesh/isosurface_kernels.h"
#include "render/mesh/isosurface_rows.h"

#define GZ_LOG_MODULE "mesh"

/* Rows that a thread takes at once. Chosen: thousands of parts for a volume worth sharing, and
 * neighbouring rows, which read the same voxels, for one thread. */
enum { ROWS_PER_PART = 32 };

/* One step of the extraction over all rows. */
struct row_step {
	const struct gz_iso_job *job;
	void (*row)(const struct gz_iso_job *job, size_t row);
	size_t rows;
};

static void do_rows(void *user, size_t part, int worker)
{
	(void)worker;
	const struct row_step *step = user;
	const size_t end = (part + 1) * ROWS_PER_PART;
	for (size_t row = part * ROWS_PER_PART; row < end && row < step->rows; row++)
		step->row(step->job, row);
}

static void do_all_rows(const struct gz_iso_job *job, struct gz_workers *workers, size_t rows,
			void (*row)(const struct gz_iso_job *job, size_t row))
{
	struct row_step step = { job, row, rows };
	const size_t parts = (rows + ROWS_PER_PART - 1) / ROWS_PER_PART;
	if (workers)
		gz_workers_run(workers, do_rows, &step, parts);
	else
		for (size_t part = 0; part < parts; part++)
			do_rows(&step, part, 0);
}

static void write_row(const struct gz_iso_job *job, size_t row)
{
	job->kernels->write_vertices(job, row);
	job->kernels->write_triangles(job, row);
}

/* Where the voxels of an axis are, mm; the origin is the centre of the box. */
static float *place_voxels(int dim, double spacing)
{
	float *places = malloc((size_t)dim * sizeof *places);
	for (int i = 0; places && i < dim; i++)
		places[i] = (float)((i + 0.5 - 0.5 * dim) * spacing);
	return places;
}

static size_t block_rows(const struct gz_value_blocks *blocks)
{
	return (size_t)blocks->dims[1] * (size_t)blocks->dims[2];
}

static enum gz_result allocate_job(struct gz_iso_job *job)
{
	const struct gz_volume *volume = job->volume;
	job->words = ((size_t)volume->dims[0] + GZ_ISO_WORD - 1) / GZ_ISO_WORD + 1;
	job->row_count = (size_t)volume->dims[1] * (size_t)volume->dims[2];
	const size_t bit_bytes = job->row_count * job->words * sizeof *job->bits;
	const size_t row_bytes = (job->row_count + 1) * sizeof *job->rows;
	if (!gz_memory_fits_machine(bit_bytes + row_bytes))
		return GZ_ERR_NO_MEM;
	job->bits = malloc(bit_bytes);
	job->rows = malloc(row_bytes);
	bool complete = job->bits && job->rows;
	for (int axis = 0; axis < 3; axis++) {
		job->places[axis] = place_voxels(volume->dims[axis], volume->spacing[axis]);
		complete = complete && job->places[axis];
		job->per_mm[axis] = (float)(1 / volume->spacing[axis]);
	}
	if (job->blocks) {
		job->known = malloc(block_rows(job->blocks) * job->words);
		complete = complete && job->known;
	}
	return complete ? GZ_OK : GZ_ERR_NO_MEM;
}

static void free_job(struct gz_iso_job *job)
{
	free(job->bits);
	free(job->rows);
	free(job->known);
	for (int axis = 0; axis < 3; axis++)
		free(job->places[axis]);
}

/* Turn the counts of all rows into the numbers of their first vertex and triangle. Sums that do not
 * fit are refused before they are used. */
static void sum_rows(struct gz_iso_job *job, uint64_t *out_vertices, uint64_t *out_triangles)
{
	uint64_t vertices = 0, triangles = 0;
	job->rows[job->row_count] = (struct gz_iso_row) { 0 };
	for (size_t row = 0; row <= job->row_count; row++) {
		struct gz_iso_row *at = &job->rows[row];
		const uint32_t more_vertices = at->vertex, more_triangles = at->triangle;
		at->vertex = (uint32_t)vertices;
		at->triangle = (uint32_t)triangles;
		vertices += more_vertices;
		triangles += more_triangles;
	}
	*out_vertices = vertices;
	*out_triangles = triangles;
}

/* Make room for a mesh of so many vertices and triangles, or say why there is none. */
static enum gz_result allocate_surface(const struct gz_iso_job *job, uint64_t vertices,
				       uint64_t triangles, const struct gz_log *log,
				       struct gz_mesh *mesh)
{
	const uint64_t most = job->elements_max;
	const bool fits = vertices <= most && triangles <= most;
	const enum gz_result result =
		fits ? gz_mesh_allocate(vertices, triangles, mesh) : GZ_ERR_FULL;
	if (result == GZ_ERR_FULL)
		gz_err(log,
		       "the surface has %" PRIu64 " vertices and %" PRIu64
		       " triangles, more than %" PRIu64
		       "; choose another isovalue or a smaller volume",
		       vertices, triangles, most);
	else if (result != GZ_OK)
		gz_err(log,
		       "not enough memory for a surface of %" PRIu64 " vertices and %" PRIu64
		       " triangles",
		       vertices, triangles);
	return result;
}

static enum gz_result extract(struct gz_iso_job *job, struct gz_workers *workers,
			      const struct gz_log *log, struct gz_mesh *mesh)
{
	uint64_t vertices, triangles;
	if (job->blocks)
		do_all_rows(job, workers, block_rows(job->blocks), gz_iso_find_known);
	do_all_rows(job, workers, job->row_count, gz_iso_classify_row);
	do_all_rows(job, workers, job->row_count, job->kernels->count_row);
	sum_rows(job, &vertices, &triangles);
	const enum gz_result result = allocate_surface(job, vertices, triangles, log, mesh);
	if (result != GZ_OK)
		return result;
	job->mesh = mesh;
	do_all_rows(job, workers, job->row_count, write_row);
	return GZ_OK;
}

static enum gz_result extract_in_memory(struct gz_iso_job *job, struct gz_workers *workers,
					const struct gz_log *log, struct gz_mesh *out_mesh)
{
	enum gz_result result = allocate_job(job);
	if (result == GZ_OK)
		result = extract(job, workers, log, out_mesh);
	else
		gz_err(log, "not enough memory to find the surface of a volume of %d x %d x %d",
		       job->volume->dims[0], job->volume->dims[1], job->volume->dims[2]);
	free_job(job);
	return result;
}

/* Why there can be no surface; NULL if there may be one. */
void gz_isosurface_warn_of_emptiness(const struct gz_volume *volume, double isovalue,
				     const struct gz_log *log)
{
	const double a = volume->slope * volume->stored_min + volume->intercept;
	const double b = volume->slope * volume->stored_max + volume->intercept;
	if (volume->dims[0] < 2 || volume->dims[1] < 2 || volume->dims[2] < 2)
		gz_warn(log,
			"the surface is empty: the volume has %d x %d x %d voxels, and a surface "
			"needs two along each axis",
			volume->dims[0], volume->dims[1], volume->dims[2]);
	else
		gz_warn(log,
			"the surface is empty: the isovalue %g does not separate any voxels; they "
			"range from %g to %g",
			isovalue, fmin(a, b), fmax(a, b));
}

/* Whether the range of the voxels rules a surface out. A range that is not a number rules nothing
 * out. */
static bool certainly_empty(const struct gz_volume *volume, float isovalue)
{
	return volume->dims[0] < 2 || volume->dims[1] < 2 || volume->dims[2] < 2 ||
	       (double)isovalue <= volume->stored_min || (double)isovalue > volume->stored_max;
}

enum gz_result gz_isosurface_make(const struct gz_isosurface_request *request,
				  struct gz_workers *workers, const struct gz_log *log,
				  struct gz_mesh *out_mesh)
{
	const struct gz_volume *volume = request->volume;
	if (!isfinite(request->isovalue)) {
		gz_err(log, "isovalue %g: must be a finite number", request->isovalue);
		return GZ_ERR_INVAL;
	}
	if (!volume->voxels) {
		gz_err(log, "a surface needs all voxels in memory, and the volume is stored in "
			    "bricks; use the file that it was made from");
		return GZ_ERR_UNSUPPORTED;
	}
	struct gz_iso_job job = {
		.kernels = request->portable ? &gz_iso_kernels_portable : gz_iso_kernels_find(),
		.volume = volume,
		.blocks = request->blocks,
		.isovalue = (float)((request->isovalue - volume->intercept) / volume->slope),
		.falling = volume->slope < 0,
		.elements_max = gz_mesh_count_limit(request->elements_max),
	};
	struct gz_mesh mesh = { 0 };
	if (!certainly_empty(volume, job.isovalue)) {
		const enum gz_result result = extract_in_memory(&job, workers, log, &mesh);
		if (result != GZ_OK)
			return result;
	}
	if (mesh.triangle_count == 0)
		gz_isosurface_warn_of_emptiness(request->volume, request->isovalue, log);
	*out_mesh = mesh;
	return GZ_OK;
}
