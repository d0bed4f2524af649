#include "render/surface/cpu/surface_caster.h"

#include <float.h>
#include <math.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/clock.h"
#include "base/workers.h"
#include "render/contrast/contrast.h"
#include "render/mesh/isosurface.h"
#include "render/raycast/cpu/cast.h"
#include "render/raycast/cpu/cpu_raycaster.h"
#include "render/raycast/shared/macrocells.h"
#include "render/raycast/shared/ray_content.h"
#include "render/reconstruct/cpu/kept_picture.h"
#include "render/reconstruct/cpu/kept_tiles.h"
#include "render/reconstruct/cpu/lattice.h"
#include "render/reconstruct/cpu/reconstruct.h"
#include "render/surface/cpu/surface_cast.h"
#include "render/surface/cpu/surface_tree.h"

#define GZ_LOG_MODULE "isosurface"

/* Tiles that a thread takes at a time: neighbours share branches of the tree, which stay in the
 * thread's cache. Measured: 64 take 4 % less time than 16, and 256 no less than 64. */
enum { TILES_A_PART = 64 };

/* Rays lie close together if their distance at the centre of what is shown is at most this share of
 * a triangle's edge. Measured: the cranium's triangles have edges of 1 mm, and it is faster to
 * follow rays 0.3 mm apart together, and each of those 0.6 mm apart by itself. */
#define COHERENT_SHARE 0.4

/* Triangles whose edges are measured. Chosen: their mean is within a twentieth of that of all. */
enum { EDGES_MEASURED = 1024 };

/* Planes that one casting can fill. */
enum picture_plane { PLANE_COLOURS, PLANE_DEPTH, PLANE_IDS, PLANE_COUNT };

/* The volume whose surface rays find in its voxels. */
struct field {
	const struct gz_volume *volume; /* NULL: none */
	uint64_t revision;              /* of its data */
	struct gz_macrocells cells;
	double isovalue; /* for which the cells are classified */
	bool current;    /* they are */
};

struct gz_surface_caster {
	const struct gz_log *log;
	struct gz_workers *workers;
	const struct gz_surface_kernel *kernel;
	struct gz_surface_meshes meshes;
	struct gz_surface_mesh *listed;    /* as kernels read them */
	struct gz_corner_normals *normals; /* of the triangles of all meshes in turn */
	struct gz_surface_tree tree;
	bool tree_current;
	double edge_mm; /* mean edge of the tree's triangles; INFINITY: it has none */
	int source;     /* enum gz_surface_source: what the tree was made for */
	struct field field;
	struct gz_cube_pictures cube;
	uint64_t revision;          /* of what keeps light back: next_revision() */
	struct gz_surface_cast own; /* what the shade of the picture reads */
	double shade_ms;            /* for surfaces, since the last picture */
	struct gz_lattices lattices[PLANE_COUNT];
	struct gz_contrasts contrasts; /* of the tiles of a round */
	struct gz_ray_content content; /* of the last picture */
	struct gz_kept_tiles kept;
	struct gz_kept_picture kept_picture;
	char description[64];
};

/* What the workers of a frame share. */
struct surface_job {
	struct gz_surface_cast cast;
	gz_surface_tile_function *tile;
	const struct gz_plan *plan;
	size_t first;                 /* tile of this round */
	double coherent_spacing;      /* greatest, px: gz_surface_tile.coherent */
	struct gz_ray_hits *hits;     /* NULL: not wanted */
	struct gz_lattices *lattices; /* PLANE_COUNT; those without a plane are not filled */
	struct gz_kept_tiles *kept;   /* NULL: every ray is cast */
	atomic_uint_fast64_t kept_rays;
	uint32_t *words[PLANE_COUNT]; /* NULL: not wanted */
};

static const struct gz_surface_kernel *find_surface_kernel(const char *simd)
{
	static const struct gz_surface_kernel *const kernels[] = {
#ifdef GZ_CAST_X86
		&gz_surface_avx512,
		&gz_surface_avx2,
#endif
		&gz_surface_portable,
	};
	const struct gz_cast_kernels *found = gz_cast_kernels_find(simd);
	for (size_t i = 0; found && i < sizeof kernels / sizeof kernels[0]; i++)
		if (strcmp(kernels[i]->name, found->name) == 0)
			return kernels[i];
	return NULL;
}

bool gz_surface_caster_present(void)
{
	return true;
}

enum gz_result gz_surface_caster_check(const struct gz_backend_params *params,
				       const struct gz_log *log)
{
	return gz_cpu_raycaster_check(params, log);
}

static enum gz_result start_surface_workers(struct gz_surface_caster *caster,
					    const struct gz_backend_params *params)
{
	enum gz_result result = gz_surface_caster_check(params, caster->log);
	if (result != GZ_OK)
		return result;
	caster->kernel = find_surface_kernel(params->simd);
	result = gz_workers_create(params->threads, &caster->workers);
	if (result != GZ_OK) {
		gz_err(caster->log, "cannot start %d threads: %s", params->threads,
		       gz_result_text(result));
		return result;
	}
	snprintf(caster->description, sizeof caster->description, "%s, %d threads",
		 caster->kernel->name, gz_workers_count(caster->workers));
	return gz_surface_tree_open(&caster->tree, caster->kernel->isa, caster->log);
}

enum gz_result gz_surface_caster_create(const struct gz_backend_params *params,
					const struct gz_log *log,
					struct gz_surface_caster **out_caster)
{
	static const struct gz_backend_params defaults = { 0 };
	struct gz_surface_caster *caster = calloc(1, sizeof *caster);
	if (!caster)
		return GZ_ERR_NO_MEM;
	caster->log = caster->meshes.log = log;
	const enum gz_result result = start_surface_workers(caster, params ? params : &defaults);
	if (result != GZ_OK) {
		gz_surface_caster_destroy(&caster);
		return result;
	}
	*out_caster = caster;
	return GZ_OK;
}

enum gz_result gz_surface_caster_show(struct gz_surface_caster *caster,
				      const struct gz_object *objects, size_t count)
{
	struct gz_surface_mesh *listed = calloc(count > 0 ? count : 1, sizeof *listed);
	if (!listed)
		return GZ_ERR_NO_MEM;
	const enum gz_result result = gz_surface_meshes_show(&caster->meshes, objects, count);
	if (result != GZ_OK) {
		free(listed);
		return result;
	}
	free(caster->listed);
	caster->listed = listed;
	caster->tree_current = false;
	gz_ray_content_forget(&caster->content);
	return GZ_OK;
}

/* List the meshes as kernels read them. */
static enum gz_result list_meshes(struct gz_surface_caster *caster)
{
	const struct gz_surface_meshes *meshes = &caster->meshes;
	free(caster->normals);
	const enum gz_result result = gz_corner_normals_make(meshes->shown, meshes->count,
							     caster->workers, &caster->normals);
	if (result != GZ_OK) {
		gz_err(caster->log, "no memory for the normals of the surface's triangles");
		return result;
	}
	const struct gz_corner_normals *normals = caster->normals;
	for (size_t i = 0; i < meshes->count; i++) {
		caster->listed[i] = (struct gz_surface_mesh) {
			.positions = (const float *)meshes->shown[i].positions,
			.triangles = (const uint32_t *)meshes->shown[i].triangles,
			.normals = normals,
			.id = meshes->items[i].object.id,
		};
		if (normals)
			normals += meshes->shown[i].triangle_count;
	}
	return GZ_OK;
}

static double length_of(const float vector[3])
{
	const double x = vector[0], y = vector[1], z = vector[2];
	return sqrt(x * x + y * y + z * z);
}

static double edge_of(const struct gz_mesh *mesh, size_t triangle)
{
	const float *from = mesh->positions[mesh->triangles[triangle][0]];
	const float *to = mesh->positions[mesh->triangles[triangle][1]];
	const float edge[3] = { to[0] - from[0], to[1] - from[1], to[2] - from[2] };
	return length_of(edge);
}

/* The mean edge of what is shown, from some triangles of all meshes. */
static double mean_edge_mm(const struct gz_surface_meshes *meshes)
{
	const size_t step = gz_surface_meshes_triangles(meshes) / EDGES_MEASURED + 1;
	double sum = 0;
	size_t count = 0;
	for (size_t i = 0; i < meshes->count; i++)
		for (size_t k = 0; k < meshes->shown[i].triangle_count; k += step, count++)
			sum += edge_of(&meshes->shown[i], k);
	return count > 0 ? sum / (double)count : INFINITY;
}

/* The first object that is a volume, by its number; meshes.count if none is. All volumes are one.
 */
static size_t find_volume_surface(const struct gz_surface_caster *caster)
{
	size_t i = 0;
	while (i < caster->meshes.count && caster->meshes.items[i].object.mesh)
		i++;
	return i;
}

/* An isovalue as the volume's voxels have it. */
static double stored_isovalue(const struct gz_volume *volume, double isovalue)
{
	return (isovalue - volume->intercept) / volume->slope;
}

/* A number that no surfaces of this process have had. */
static uint64_t next_revision(void)
{
	static atomic_uint_fast64_t last;
	return atomic_fetch_add(&last, 1) + 1;
}

/* Find the range of the volume's cells. */
static enum gz_result build_field(struct gz_surface_caster *caster, const struct gz_object *object)
{
	struct field *field = &caster->field;
	if (field->volume == object->volume && field->revision == object->data_revision)
		return GZ_OK;
	field->volume = NULL;
	field->current = false;
	if (gz_volume_voxel_count(object->volume) > GZ_SURFACE_VOXELS_MAX) {
		gz_err(caster->log,
		       "isosurface.source = voxels takes at most 2^31 voxels; set it to "
		       "triangles");
		return GZ_ERR_UNSUPPORTED;
	}
	const enum gz_result result = gz_macrocells_build(object->volume, &field->cells);
	if (result != GZ_OK) {
		gz_err(caster->log, "no memory for the cells of the volume's surface");
		return result;
	}
	field->volume = object->volume;
	field->revision = object->data_revision;
	return GZ_OK;
}

static bool shows_nowhere(const struct gz_macrocells *cells)
{
	const size_t count =
		(size_t)cells->dims[0] * (size_t)cells->dims[1] * (size_t)cells->dims[2];
	for (size_t i = 0; i < count; i++)
		if (cells->distance[i] == 0)
			return false;
	return true;
}

/* Find the cells of the volume that its surface crosses. */
static enum gz_result prepare_field(struct gz_surface_caster *caster, double isovalue)
{
	const size_t index = find_volume_surface(caster);
	struct field *field = &caster->field;
	if (index == caster->meshes.count || caster->source != GZ_SURFACE_VOXELS)
		return GZ_OK;
	const enum gz_result result = build_field(caster, &caster->meshes.items[index].object);
	if (result != GZ_OK)
		return result;
	if (field->current && field->isovalue == isovalue)
		return GZ_OK;
	gz_macrocells_classify_surface(&field->cells, stored_isovalue(field->volume, isovalue));
	if (shows_nowhere(&field->cells))
		gz_isosurface_warn_of_emptiness(field->volume, isovalue, caster->log);
	field->isovalue = isovalue;
	field->current = true;
	caster->revision = next_revision();
	return GZ_OK;
}

/* Make what the picture shows, meshes and their tree, and tell the time; 0: all was there. */
static enum gz_result prepare_surfaces(struct gz_surface_caster *caster,
				       const struct gz_surface_look *look, double *out_ms)
{
	bool new_meshes = false;
	*out_ms = 0;
	caster->source = look->source;
	enum gz_result result = prepare_field(caster, look->isovalue);
	const int64_t start_ns = gz_clock_now_ns();
	gz_surface_meshes_without_volumes(&caster->meshes, look->source == GZ_SURFACE_VOXELS);
	if (result == GZ_OK)
		result = gz_surface_meshes_make(&caster->meshes, look->isovalue, caster->workers,
						&new_meshes);
	caster->tree_current = caster->tree_current && caster->meshes.listed && !new_meshes;
	if (result != GZ_OK || caster->tree_current)
		return result;
	const int64_t made_ns = gz_clock_now_ns();
	result = list_meshes(caster);
	if (result == GZ_OK)
		result = gz_surface_tree_build(&caster->tree, caster->meshes.shown,
					       caster->meshes.count);
	if (result != GZ_OK)
		return result;
	caster->tree_current = true;
	caster->edge_mm = mean_edge_mm(&caster->meshes);
	caster->revision = next_revision();
	*out_ms = gz_ns_to_ms(gz_clock_now_ns() - start_ns);
	const struct gz_surface_size size = gz_surface_caster_size(caster);
	gz_debug(caster->log,
		 "%zu triangles: surfaces %.0f ms, %zu bytes; tree %.0f ms, %zu bytes; "
		 "normals %zu bytes",
		 size.triangles, gz_ns_to_ms(made_ns - start_ns), size.mesh_bytes,
		 gz_ns_to_ms(gz_clock_now_ns() - made_ns), size.tree_bytes, size.normal_bytes);
	return GZ_OK;
}

struct gz_surface_meshes *gz_surface_caster_meshes(struct gz_surface_caster *caster)
{
	return &caster->meshes;
}

struct gz_surface_size gz_surface_caster_size(const struct gz_surface_caster *caster)
{
	return (struct gz_surface_size) {
		.triangles = gz_surface_meshes_triangles(&caster->meshes),
		.mesh_bytes = gz_surface_meshes_bytes(&caster->meshes),
		.tree_bytes = (size_t)caster->tree.bytes,
		.normal_bytes =
			gz_surface_meshes_triangles(&caster->meshes) * sizeof caster->normals[0],
	};
}

static void colour_meshes(struct gz_surface_caster *caster, const struct gz_surface_look *look)
{
	for (size_t i = 0; i < caster->meshes.count; i++)
		gz_surface_colour(&caster->meshes.items[i], look, caster->listed[i].colour);
}

/* Put into the hits of all techniques what lies nearer. Surroundings lie behind everything, farther
 * than any depth, so that it shows behind translucent objects too. */
static void merge_hits(const struct gz_surface_hits *own, enum gz_surroundings around, size_t tile,
		       struct gz_ray_hits *all)
{
	const float behind = around == GZ_SURROUNDINGS_NONE ? INFINITY : FLT_MAX;
	float *depth = all->depth + tile * GZ_HITS_A_TILE;
	uint32_t *pixels = all->pixels + tile * GZ_HITS_A_TILE;
	for (int k = 0; k < GZ_HITS_A_TILE; k++)
		if (fminf(own->depth[k], behind) < depth[k]) {
			depth[k] = fminf(own->depth[k], behind);
			pixels[k] = own->pixels[k];
		}
}

/* The voxels of a field, as sample_trilinear() reads them, and its cells, as look_up_cell() does.
 */
static void fill_field_voxels(const struct field *from, struct gz_cast *voxels)
{
	const struct gz_macrocells *cells = &from->cells;
	const int32_t cell_strides[3] = { 1, cells->dims[0], cells->dims[0] * cells->dims[1] };
	gz_cast_fill_voxels(from->volume, voxels);
	voxels->reach = cells->reach;
	for (int axis = 0; axis < 3; axis++) {
		voxels->cell_last[axis] = (float)(cells->dims[axis] - 1);
		voxels->cell_stride[axis] = cell_strides[axis];
	}
}

static void fill_field(const struct gz_surface_caster *caster, struct gz_surface_cast *cast)
{
	const size_t index = find_volume_surface(caster);
	struct gz_surface_field *field = &cast->field;
	field->on = caster->source == GZ_SURFACE_VOXELS && index < caster->meshes.count;
	if (!field->on)
		return;
	const struct gz_volume *volume = caster->field.volume;
	double half[3], finest = INFINITY;
	gz_volume_half_extent(volume, half);
	field->number = (unsigned)index;
	field->type = volume->type;
	field->value = (float)stored_isovalue(volume, caster->field.isovalue);
	for (int axis = 0; axis < 3; axis++) {
		const double edge = 2 * half[axis] * caster->meshes.world_mm / volume->dims[axis];
		field->voxels_per_mm[axis] = (float)(1 / edge);
		finest = fmin(finest, edge);
	}
	field->step_mm = (float)finest;
	fill_field_voxels(&caster->field, &field->voxels);
}

static void cast_surface_rays(const struct surface_job *job, const struct gz_tile *tile,
			      uint32_t active, struct gz_surface_hits *out_hits)
{
	const struct gz_plan *plan = job->plan;
	const int spacing = plan->layers[tile->layer].spacing;
	struct gz_surface_tile rays = { .active = active,
					.step = plan->steps[tile->step],
					.coherent = spacing <= job->coherent_spacing };
	for (int k = 0; k < GZ_SURFACE_RAYS; k++) {
		const int column = gz_tile_columns[tile->pattern][k];
		rays.x[k] = (float)(tile->x - plan->view.shift[0] + column * spacing);
		rays.y[k] = (float)(tile->y - plan->view.shift[1] + gz_tile_rows[k] * spacing);
	}
	job->tile(&job->cast, &rays, out_hits);
}

_Static_assert(sizeof(struct gz_surface_hits) ==
		       PLANE_COUNT * GZ_KEPT_TILE_WORDS * sizeof(uint32_t),
	       "hits are kept as they are");

/* Cast a tile's rays, or take those of an earlier picture. Returns how many were taken. */
static uint64_t find_surface_hits(const struct surface_job *job, const struct gz_tile *tile,
				  uint32_t active, struct gz_surface_hits *out_hits)
{
	bool known = false;
	uint32_t *kept = NULL;
	if (job->kept)
		kept = gz_kept_tiles_take(job->kept, job->plan, tile, &known);
	if (known) {
		memcpy(out_hits, kept, sizeof *out_hits);
		return (uint64_t)__builtin_popcount(active);
	}
	cast_surface_rays(job, tile, active, out_hits);
	if (kept)
		memcpy(kept, out_hits, sizeof *out_hits);
	return 0;
}

static uint64_t cast_surface_tile(const struct surface_job *job, size_t number)
{
	const struct gz_tile *tile = &job->plan->tiles[number];
	const uint32_t active = gz_plan_tile_active(job->plan, tile);
	struct gz_surface_hits hits;
	uint32_t depth[GZ_SURFACE_RAYS];
	const uint64_t kept_rays = find_surface_hits(job, tile, active, &hits);
	if (job->hits)
		merge_hits(&hits, job->cast.frame.around.kind, number, job->hits);
	memcpy(depth, hits.depth, sizeof depth);
	const uint32_t *const found[PLANE_COUNT] = { hits.pixels, depth, hits.ids };
	for (int plane = 0; plane < PLANE_COUNT; plane++)
		if (job->words[plane])
			gz_lattices_store(&job->lattices[plane], job->plan, tile, active,
					  found[plane]);
	return kept_rays;
}

static void cast_surface_part(void *user, size_t part, int worker)
{
	struct surface_job *job = user;
	const size_t from = job->first + part * TILES_A_PART;
	const size_t end = from + TILES_A_PART;
	uint64_t kept_rays = 0;
	(void)worker;
	for (size_t i = from; i < end && i < job->plan->tile_count; i++)
		kept_rays += cast_surface_tile(job, i);
	atomic_fetch_add_explicit(&job->kept_rays, kept_rays, memory_order_relaxed);
}

static void cast_surface_tiles(struct gz_surface_caster *caster, struct surface_job *job)
{
	gz_workers_run(caster->workers, cast_surface_part, job,
		       (job->plan->tile_count - job->first + TILES_A_PART - 1) / TILES_A_PART);
}

/* Refine the plan where the colours of the last round's rays differ, and cast the new tiles, round
 * by round. */
static enum gz_result cast_further_rounds(struct gz_surface_caster *caster, struct gz_plan *plan,
					  struct surface_job *job)
{
	for (int round = 1; round < gz_plan_rounds(plan); round++) {
		const enum gz_result result =
			gz_contrasts_plan_round(plan, &job->first, &job->lattices[PLANE_COLOURS],
						caster->workers, &caster->contrasts);
		if (result != GZ_OK || job->first == plan->tile_count)
			return result;
		for (int plane = 0; plane < PLANE_COUNT; plane++)
			if (job->words[plane])
				gz_lattices_unmark(&job->lattices[plane], plan, job->first);
		cast_surface_tiles(caster, job);
	}
	return GZ_OK;
}

/* Make room for the picture and the planes that are wanted. */
static enum gz_result prepare_planes(struct gz_surface_caster *caster, const struct gz_plan *plan,
				     struct gz_image *image, const struct gz_surface_planes *planes,
				     uint32_t *out_words[PLANE_COUNT])
{
	enum gz_result result = image ? gz_image_resize(image, plan->width, plan->height) : GZ_OK;
	if (result == GZ_OK && image)
		out_words[PLANE_COLOURS] = gz_image_words(image);
	if (result == GZ_OK && planes && planes->depth) {
		result = gz_plane_resize(planes->depth, GZ_PLANE_VALUE, plan->width, plan->height);
		out_words[PLANE_DEPTH] = planes->depth->words;
	}
	if (result == GZ_OK && planes && planes->ids) {
		result = gz_plane_resize(planes->ids, GZ_PLANE_ID, plan->width, plan->height);
		out_words[PLANE_IDS] = planes->ids->words;
	}
	for (int i = 0; i < PLANE_COUNT && result == GZ_OK; i++)
		if (out_words[i])
			result = gz_lattices_prepare(&caster->lattices[i], plan, out_words[i]);
	return result;
}

static void reconstruct_planes(struct gz_surface_caster *caster, const struct surface_job *job)
{
	static const enum gz_plane_kind kinds[PLANE_COUNT] = { GZ_PLANE_COLOUR, GZ_PLANE_VALUE,
							       GZ_PLANE_ID };
	const struct gz_row_filters *colours = gz_row_filters_find(caster->kernel->name);
	for (int i = 0; i < PLANE_COUNT; i++) {
		const struct gz_row_filters filters = gz_row_filters_of_plane(kinds[i], colours);
		if (job->words[i])
			gz_reconstruct(job->plan, &caster->lattices[i],
				       i == PLANE_COLOURS ? colours : &filters, caster->workers,
				       job->words[i]);
	}
}

/* What all rays of a picture share. After the surfaces are made. */
static void fill_surface_cast(struct gz_surface_caster *caster, const struct gz_surface_shot *shot,
			      const struct gz_ray_frame *frame, struct gz_surface_cast *cast)
{
	*cast = (struct gz_surface_cast) {
		.tree = caster->tree.scene,
		.meshes = caster->listed,
		.mesh_count = (unsigned)caster->meshes.count,
		.shades = shot->shades,
		.shade_count = shot->shade_count,
	};
	colour_meshes(caster, &shot->rays->surface);
	fill_field(caster, cast);
	cast->frame = gz_surface_frame_make(&caster->meshes, &caster->cube, shot->rays, frame);
}

/* The greatest spacing of rays that lie close together, px. */
static double coherent_spacing(const struct gz_surface_caster *caster,
			       const struct gz_surface_frame *frame)
{
	const double eye_mm = length_of(frame->origin00);
	const double apart_mm =
		length_of(frame->origin_dx) +
		length_of(frame->direction_dx) / length_of(frame->direction00) * eye_mm;
	return COHERENT_SHARE * caster->edge_mm / apart_mm;
}

/* struct gz_shade, find */
static void find_lit_by_kernel(const void *user, const struct gz_shade_places *places,
			       float out_shares[GZ_SHADE_PLACES])
{
	const struct gz_surface_caster *caster = user;
	caster->kernel->lit(&caster->own, places, out_shares);
}

enum gz_result gz_surface_caster_shade(struct gz_surface_caster *caster,
				       const struct gz_surface_shot *shot,
				       struct gz_shade *out_shade)
{
	const struct gz_plan_view *view = &shot->plan->view;
	struct gz_ray_frame frame;
	if (caster->meshes.count < 1 || !gz_ray_params_valid(shot->rays))
		return GZ_ERR_INVAL;
	*out_shade = (struct gz_shade) { 0 };
	if (!shot->rays->surface.shadows || shot->rays->surface.material == GZ_MATERIAL_GLASS)
		return GZ_OK;
	double prepare_ms = 0;
	enum gz_result result = gz_camera_rays(shot->camera, view->width, view->height, &frame);
	if (result == GZ_OK)
		result = prepare_surfaces(caster, &shot->rays->surface, &prepare_ms);
	caster->shade_ms += prepare_ms;
	if (result != GZ_OK)
		return result;
	fill_surface_cast(caster, shot, &frame, &caster->own);
	*out_shade = (struct gz_shade) { .find = find_lit_by_kernel,
					 .user = caster,
					 .revision = caster->revision };
	return GZ_OK;
}

/* The tiles of earlier pictures that this one may take; NULL: none. After the surfaces are made. */
static struct gz_kept_tiles *find_kept_tiles(struct gz_surface_caster *caster,
					     const struct gz_surface_shot *shot,
					     const struct gz_ray_frame *frame)
{
	if (!shot->keeps_rays || shot->hits || shot->shade_count > 0) {
		gz_kept_tiles_free(&caster->kept);
		gz_kept_picture_free(&caster->kept_picture);
		return NULL;
	}
	const uint64_t revision = caster->revision + caster->cube.serial; /* both only go up */
	const uint64_t content = gz_ray_content_follow(&caster->content, shot->plan, shot->rays,
						       frame, NULL, revision);
	return gz_kept_tiles_begin(&caster->kept, shot->plan, content, PLANE_COUNT) ? &caster->kept
										    : NULL;
}

/* Cast the picture's rays, in one round or several, and fill the pixels between them. */
static enum gz_result cast_surface_picture(struct gz_surface_caster *caster,
					   const struct gz_surface_shot *shot,
					   struct surface_job *job, struct gz_image *image,
					   double *out_reconstruct_ms)
{
	cast_surface_tiles(caster, job);
	/* Contrasts are those of colours, and hits are told for the first round's tiles. */
	if (shot->refined && shot->plan->refines && image && !shot->hits) {
		const enum gz_result result = cast_further_rounds(caster, shot->refined, job);
		if (result != GZ_OK)
			return result;
	}
	const int64_t start_ns = gz_clock_now_ns();
	reconstruct_planes(caster, job);
	*out_reconstruct_ms = gz_ns_to_ms(gz_clock_now_ns() - start_ns);
	if (job->kept && image)
		gz_kept_picture_store(&caster->kept_picture, shot->plan, job->kept->content,
				      caster->workers, image);
	return GZ_OK;
}

/* Show the whole picture that was made before, if this one is the same and nothing but its colours
 * is wanted. */
static bool take_kept_picture(struct gz_surface_caster *caster, struct surface_job *job,
			      struct gz_image *image, const struct gz_surface_planes *planes)
{
	if (!job->kept || !image || planes ||
	    !gz_kept_picture_take(&caster->kept_picture, job->plan, job->kept->content,
				  caster->workers, image))
		return false;
	atomic_store(&job->kept_rays, job->plan->ray_count);
	return true;
}

enum gz_result gz_surface_caster_draw(struct gz_surface_caster *caster,
				      const struct gz_surface_shot *shot, struct gz_image *image,
				      const struct gz_surface_planes *planes,
				      struct gz_frame_stats *out_stats)
{
	const struct gz_plan *plan = shot->plan;
	struct surface_job job = {
		.tile = caster->kernel->tile,
		.plan = plan,
		.hits = shot->hits,
		.lattices = caster->lattices,
	};
	struct gz_ray_frame frame;
	if (caster->meshes.count < 1 || !gz_ray_params_valid(shot->rays) || plan->layer_count < 1)
		return GZ_ERR_INVAL;
	enum gz_result result =
		gz_camera_rays(shot->camera, plan->view.width, plan->view.height, &frame);
	if (result == GZ_OK)
		result = prepare_planes(caster, plan, image, planes, job.words);
	double prepare_ms = 0;
	if (result == GZ_OK)
		result = prepare_surfaces(caster, &shot->rays->surface, &prepare_ms);
	if (result == GZ_OK)
		result = gz_cube_pictures_prepare(&caster->cube, &shot->rays->environment,
						  caster->log, &prepare_ms);
	if (result != GZ_OK)
		return result;
	const int64_t prepared_ns = gz_clock_now_ns();
	prepare_ms += caster->shade_ms;
	caster->shade_ms = 0;
	fill_surface_cast(caster, shot, &frame, &job.cast);
	job.coherent_spacing = coherent_spacing(caster, &job.cast.frame);
	job.kept = find_kept_tiles(caster, shot, &frame);
	double reconstruct_ms = 0;
	if (!take_kept_picture(caster, &job, image, planes))
		result = cast_surface_picture(caster, shot, &job, image, &reconstruct_ms);
	if (result != GZ_OK)
		return result;
	if (out_stats)
		*out_stats = (struct gz_frame_stats) {
			.rays = plan->ray_count,
			.keeps_rays = job.kept != NULL,
			.kept_rays = atomic_load(&job.kept_rays),
			.prepare_ms = prepare_ms,
			.prepare_within_ms = prepare_ms,
			.cast_ms = gz_ns_to_ms(gz_clock_now_ns() - prepared_ns) - reconstruct_ms,
			.reconstruct_ms = reconstruct_ms,
			.gpu_ms = NAN,
		};
	return GZ_OK;
}

enum gz_result gz_surface_caster_pick(struct gz_surface_caster *caster,
				      const struct gz_surface_shot *shot,
				      const struct gz_pick_request *request,
				      struct gz_pick *out_pick)
{
	const struct gz_surface_tile rays = {
		.x = { (float)(request->x - 0.5) },
		.y = { (float)(request->y - 0.5) },
		.active = 1,
		.step = 1,
	};
	struct gz_surface_cast cast;
	struct gz_surface_hits hits;
	struct gz_ray_frame frame;
	double prepare_ms = 0;
	if (caster->meshes.count < 1 || !gz_ray_params_valid(shot->rays))
		return GZ_ERR_INVAL;
	enum gz_result result =
		gz_camera_rays(request->camera, request->width, request->height, &frame);
	if (result == GZ_OK)
		result = prepare_surfaces(caster, &shot->rays->surface, &prepare_ms);
	if (result == GZ_OK)
		result = gz_cube_pictures_prepare(&caster->cube, &shot->rays->environment,
						  caster->log, &prepare_ms);
	if (result != GZ_OK)
		return result;
	fill_surface_cast(caster, shot, &frame, &cast);
	caster->kernel->tile(&cast, &rays, &hits);
	*out_pick = (struct gz_pick) {
		.count = hits.ids[0] > 0 ? 1 : 0,
		.ids = { hits.ids[0] },
		.depths = { (double)hits.depth[0] },
		.shares = { 1 },
	};
	return GZ_OK;
}

const char *gz_surface_caster_describe(const struct gz_surface_caster *caster)
{
	return caster->description;
}

void gz_surface_caster_destroy(struct gz_surface_caster **caster)
{
	struct gz_surface_caster *self = *caster;
	if (!self)
		return;
	gz_workers_destroy(&self->workers);
	gz_surface_tree_close(&self->tree);
	gz_surface_meshes_free(&self->meshes);
	gz_macrocells_free(&self->field.cells);
	gz_cube_pictures_free(&self->cube);
	free(self->listed);
	free(self->normals);
	for (int i = 0; i < PLANE_COUNT; i++)
		gz_lattices_free(&self->lattices[i]);
	gz_contrasts_free(&self->contrasts);
	gz_kept_tiles_free(&self->kept);
	gz_kept_picture_free(&self->kept_picture);
	free(self);
	*caster = NULL;
}
