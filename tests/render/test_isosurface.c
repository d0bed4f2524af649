/* Surfaces of known fields have the right size, shape and topology; those of any field are closed.
 */
#include "suite.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/captured_log.h"
#include "base/workers.h"
#include "mesh_fields.h"
#include "render/mesh/cube_tables.h"
#include "render/mesh/isosurface.h"
#include "render/mesh/mesh_measure.h"
#include "render/raycast/shared/macrocells.h"

#define PI 3.14159265358979323846

static const double EVEN[3] = { 1, 1, 1 };

static struct gz_mesh surface_of(const struct gz_volume *volume, double isovalue)
{
	const struct gz_isosurface_request request = { .volume = volume, .isovalue = isovalue };
	struct gz_mesh mesh;
	assert_int_equal(gz_isosurface_make(&request, NULL, NULL, &mesh), GZ_OK);
	return mesh;
}

static struct gz_mesh_measures measures_of(const struct gz_mesh *mesh)
{
	struct gz_mesh_measures measures;
	assert_int_equal(gz_mesh_measure(mesh, &measures), GZ_OK);
	return measures;
}

static void assert_near_share(double value, double wanted, double share)
{
	if (fabs(value - wanted) > share * wanted)
		fail_msg("%.9g is not within %g %% of %.9g", value, 100 * share, wanted);
}

/* The edges of cubes whose ends lie on two sides of the isovalue. */
static size_t crossed_edges(const struct gz_volume *volume, double isovalue)
{
	const size_t stride[3] = { 1, (size_t)volume->dims[0],
				   (size_t)volume->dims[0] * (size_t)volume->dims[1] };
	size_t count = 0;
	for (size_t i = 0; i < gz_volume_voxel_count(volume); i++)
		for (int axis = 0; axis < 3; axis++) {
			const size_t at = i / stride[axis] % (size_t)volume->dims[axis];
			if (at + 1 == (size_t)volume->dims[axis])
				continue;
			const double from = gz_voxel_stored(volume->type, volume->voxels, i);
			const double to =
				gz_voxel_stored(volume->type, volume->voxels, i + stride[axis]);
			count += (from >= isovalue) != (to >= isovalue);
		}
	return count;
}

static void assert_closed(const struct gz_mesh *mesh)
{
	const struct gz_mesh_measures measures = measures_of(mesh);
	if (!gz_mesh_closed(&measures))
		fail_msg("%zu triangles: %zu edges on a border, %zu crowded, %zu turned",
			 mesh->triangle_count, measures.border_edges, measures.crowded_edges,
			 measures.turned_edges);
}

static void assert_sound(const struct gz_mesh *mesh)
{
	for (size_t v = 0; v < mesh->vertex_count; v++) {
		double length = 0;
		for (int axis = 0; axis < 3; axis++) {
			assert_true(isfinite(mesh->positions[v][axis]));
			length += (double)mesh->normals[v][axis] * (double)mesh->normals[v][axis];
		}
		assert_float_equal(length, 1, 1e-5);
	}
	for (size_t i = 0; i < 3 * mesh->triangle_count; i++)
		assert_true(mesh->triangles[i / 3][i % 3] < mesh->vertex_count);
}

static void all_instruction_sets_make_the_same_mesh(void **state)
{
	(void)state;
	static const int dims[3] = { 70, 33, 21 };
	static const double uneven[3] = { 0.8, 1.1, 0.6 };
	for (int type = 0; type < GZ_VOXEL_TYPE_COUNT; type++)
		for (int noise = 0; noise < 2; noise++) {
			struct gz_volume volume =
				noise ? field_noise(dims, (enum gz_voxel_type)type, 5, 0)
				      : field_volume(field_ring, dims, uneven,
						     (enum gz_voxel_type)type);
			struct gz_isosurface_request request = {
				.volume = &volume,
				.isovalue = !noise                 ? 0.1
					    : type == GZ_VOXEL_F32 ? 0.4
								   : 100,
			};
			struct gz_mesh best, portable;
			assert_int_equal(gz_isosurface_make(&request, NULL, NULL, &best), GZ_OK);
			request.portable = true;
			assert_int_equal(gz_isosurface_make(&request, NULL, NULL, &portable),
					 GZ_OK);
			assert_int_equal(best.vertex_count, portable.vertex_count);
			assert_int_equal(best.triangle_count, portable.triangle_count);
			assert_true(best.triangle_count > 1000);
			assert_memory_equal(best.positions, portable.positions,
					    best.vertex_count * sizeof best.positions[0]);
			assert_memory_equal(best.normals, portable.normals,
					    best.vertex_count * sizeof best.normals[0]);
			assert_memory_equal(best.triangles, portable.triangles,
					    best.triangle_count * sizeof best.triangles[0]);
			gz_mesh_free(&best);
			gz_mesh_free(&portable);
			gz_volume_free(&volume);
		}
}

static void ball_has_the_area_and_volume_of_a_ball(void **state)
{
	(void)state;
	static const double uneven[3] = { 0.8, 1.1, 0.6 };
	static const int dims[2][3] = { { 70, 70, 70 }, { 70, 45, 75 } };
	for (int type = 0; type < GZ_VOXEL_TYPE_COUNT; type++)
		for (int k = 0; k < 2; k++) {
			struct gz_volume volume = field_volume(
				field_ball, dims[k], k ? uneven : EVEN, (enum gz_voxel_type)type);
			struct gz_mesh mesh = surface_of(&volume, 0.01);
			const struct gz_mesh_measures measures = measures_of(&mesh);
			const double radius = 19.99;
			assert_near_share(measures.area, 4 * PI * radius * radius, 0.005);
			assert_near_share(measures.volume, 4 / 3.0 * PI * pow(radius, 3), 0.005);
			assert_int_equal(measures.euler, 2);
			assert_true(gz_mesh_closed(&measures));
			assert_sound(&mesh);
			for (size_t v = 0; v < mesh.vertex_count; v++) {
				const float *p = mesh.positions[v], *n = mesh.normals[v];
				const double away =
					sqrt((double)(p[0] * p[0] + p[1] * p[1] + p[2] * p[2]));
				const double out =
					(double)(p[0] * n[0] + p[1] * n[1] + p[2] * n[2]) / away;
				assert_float_equal(away, radius, 0.06);
				assert_true(out > 0.995);
			}
			gz_mesh_free(&mesh);
			gz_volume_free(&volume);
		}
}

static void ring_has_the_area_and_volume_of_a_torus_and_one_handle(void **state)
{
	(void)state;
	static const int dims[3] = { 60, 60, 24 };
	for (int type = 0; type < GZ_VOXEL_TYPE_COUNT; type++) {
		struct gz_volume volume =
			field_volume(field_ring, dims, EVEN, (enum gz_voxel_type)type);
		struct gz_mesh mesh = surface_of(&volume, 0.01);
		const struct gz_mesh_measures measures = measures_of(&mesh);
		assert_near_share(measures.area, 4 * PI * PI * 18 * 6.99, 0.005);
		assert_near_share(measures.volume, 2 * PI * PI * 18 * 6.99 * 6.99, 0.005);
		assert_int_equal(measures.euler, 0);
		assert_true(gz_mesh_closed(&measures));
		gz_mesh_free(&mesh);
		gz_volume_free(&volume);
	}
}

static void surface_of_falling_values_faces_outwards(void **state)
{
	(void)state;
	static const int dims[3] = { 50, 50, 50 };
	struct gz_volume volume = field_volume(field_ball, dims, EVEN, GZ_VOXEL_U16);
	struct gz_mesh rising = surface_of(&volume, 0.01);
	uint16_t *voxels = volume.voxels;
	for (size_t i = 0; i < gz_volume_voxel_count(&volume); i++)
		voxels[i] = (uint16_t)(65535 - voxels[i]);
	volume.slope = -volume.slope;
	volume.intercept = 8;
	gz_volume_find_range(&volume);
	struct gz_mesh falling = surface_of(&volume, 0.01);
	const struct gz_mesh_measures a = measures_of(&rising), b = measures_of(&falling);
	assert_true(b.volume > 0);
	assert_near_share(b.volume, a.volume, 1e-6);
	assert_near_share(b.area, a.area, 1e-6);
	assert_int_equal(falling.vertex_count, rising.vertex_count);
	for (size_t v = 0; v < rising.vertex_count; v++)
		for (int axis = 0; axis < 3; axis++)
			assert_float_equal(rising.normals[v][axis], falling.normals[v][axis], 1e-4);
	gz_mesh_free(&rising);
	gz_mesh_free(&falling);
	gz_volume_free(&volume);
}

/* A cube of eight voxels in the middle of a volume whose other voxels are 0. */
static struct gz_volume cube_alone(const float corners[8])
{
	static const int dims[3] = { 4, 4, 4 };
	struct gz_volume volume = field_noise(dims, GZ_VOXEL_F32, 1, 1);
	float *voxels = volume.voxels;
	for (size_t c = 0; c < 8; c++)
		voxels[21 + (c & 1) + 4 * (c >> 1 & 1) + 16 * (c >> 2)] = corners[c];
	gz_volume_find_range(&volume);
	return volume;
}

static void every_case_of_a_cube_is_closed(void **state)
{
	(void)state;
	uint32_t seed = 7;
	for (int set = 1; set < 256; set++)
		for (int round = 0; round < 20; round++) {
			float corners[8];
			for (int c = 0; c < 8; c++) {
				const double height = 0.5 * field_random(&seed);
				corners[c] = (float)(set >> c & 1 ? 0.5 + height : 0.5 * height);
			}
			struct gz_volume volume = cube_alone(corners);
			struct gz_mesh mesh = surface_of(&volume, 0.5);
			assert_int_equal(mesh.vertex_count, crossed_edges(&volume, 0.5));
			assert_closed(&mesh);
			assert_true(measures_of(&mesh).volume > 0);
			gz_mesh_free(&mesh);
			gz_volume_free(&volume);
		}
}

static void variants_of_a_case_use_exactly_its_crossed_edges(void **state)
{
	(void)state;
	for (unsigned set = 0; set < 256; set++) {
		const int end = set < 255 ? gz_cube_first[set + 1] : gz_cube_variants;
		assert_int_equal(end - gz_cube_first[set],
				 1 << __builtin_popcount(gz_cube_ambiguous[set]));
		unsigned crossed = 0;
		for (unsigned e = 0; e < 12; e++) {
			const unsigned axis = e / 4, u = axis == 0 ? 1 : 0, v = axis == 2 ? 1 : 2;
			const unsigned from = (e & 1) << u | (e >> 1 & 1) << v;
			crossed |= ((set >> from ^ set >> (from | 1U << axis)) & 1) << e;
		}
		for (int variant = gz_cube_first[set]; variant < end; variant++) {
			unsigned used = 0;
			for (int i = 3 * gz_cube_offset[variant];
			     i < 3 * gz_cube_offset[variant + 1]; i++)
				used |= 1U << gz_cube_corners[i];
			assert_int_equal(used, crossed);
		}
	}
}

static void saddle_decides_whether_opposite_corners_join(void **state)
{
	(void)state;
	/* Corners 1 and 2 or 0 and 3 of one face are full. Their product of heights against that of
	 * the empty ones is 0.16 : 0.04, then 0.01 : 0.16. */
	for (int lowest = 0; lowest < 2; lowest++)
		for (int joined = 0; joined < 2; joined++) {
			const float full = joined ? 0.9F : 0.6F, empty = joined ? 0.3F : 0.1F;
			const float corners[8] = { lowest ? full : empty, lowest ? empty : full,
						   lowest ? empty : full, lowest ? full : empty };
			struct gz_volume volume = cube_alone(corners);
			struct gz_mesh mesh = surface_of(&volume, 0.5);
			assert_closed(&mesh);
			assert_int_equal(measures_of(&mesh).euler, joined ? 2 : 4);
			gz_mesh_free(&mesh);
			gz_volume_free(&volume);
		}
}

static void surface_of_noise_is_closed(void **state)
{
	(void)state;
	static const int dims[4][3] = {
		{ 40, 37, 33 }, { 65, 20, 20 }, { 3, 33, 40 }, { 97, 5, 3 }
	};
	for (int type = 0; type < GZ_VOXEL_TYPE_COUNT; type++)
		for (uint32_t k = 0; k < 8; k++) {
			struct gz_volume volume =
				field_noise(dims[k % 4], (enum gz_voxel_type)type, k, 1);
			const double isovalue = type == GZ_VOXEL_F32 ? 0.5 : k < 4 ? 128 : 99.7;
			struct gz_mesh mesh = surface_of(&volume, isovalue);
			assert_true(mesh.triangle_count > 0);
			assert_int_equal(mesh.vertex_count, crossed_edges(&volume, isovalue));
			assert_closed(&mesh);
			assert_sound(&mesh);
			gz_mesh_free(&mesh);
			gz_volume_free(&volume);
		}
}

static void surface_of_few_values_equal_to_the_isovalue_is_closed(void **state)
{
	(void)state;
	static const int dims[3] = { 34, 20, 20 };
	struct gz_volume volume = field_noise(dims, GZ_VOXEL_U8, 5, 1);
	for (size_t i = 0; i < gz_volume_voxel_count(&volume); i++)
		((uint8_t *)volume.voxels)[i] /= 100;
	gz_volume_find_range(&volume);
	struct gz_mesh mesh = surface_of(&volume, 1);
	assert_true(mesh.triangle_count > 0);
	assert_closed(&mesh);
	assert_sound(&mesh);
	gz_mesh_free(&mesh);
	gz_volume_free(&volume);
}

/* A vertex on an outer face of the volume. */
static int lies_outside(const struct gz_volume *volume, const float position[3])
{
	for (int axis = 0; axis < 3; axis++)
		if (fabs((double)position[axis]) >= 0.5 * volume->dims[axis] - 0.5)
			return 1;
	return 0;
}

static void surface_that_leaves_the_volume_is_open_only_there(void **state)
{
	(void)state;
	static const int dims[3] = { 36, 20, 17 };
	struct gz_volume volume = field_noise(dims, GZ_VOXEL_F32, 3, 0);
	struct gz_mesh mesh = surface_of(&volume, 0.5);
	const struct gz_mesh_measures all = measures_of(&mesh);
	assert_true(all.border_edges > 0);
	assert_int_equal(all.crowded_edges, 0);
	assert_int_equal(all.turned_edges, 0);
	assert_int_equal(mesh.vertex_count, crossed_edges(&volume, 0.5));
	/* A vertex within the volume is closed by its triangles: each edge at it leaves it once and
	 * comes back once. */
	int *balance = calloc(mesh.vertex_count, sizeof *balance);
	for (size_t t = 0; t < mesh.triangle_count; t++)
		for (int c = 0; c < 3; c++) {
			const uint32_t at = mesh.triangles[t][c];
			const uint32_t next = mesh.triangles[t][(c + 1) % 3];
			const uint32_t last = mesh.triangles[t][(c + 2) % 3];
			balance[at] += (int)(next % 1021) - (int)(last % 1021);
		}
	size_t within = 0;
	for (size_t v = 0; v < mesh.vertex_count; v++) {
		if (lies_outside(&volume, mesh.positions[v]))
			continue;
		within++;
		assert_int_equal(balance[v], 0);
	}
	assert_true(within > 1000);
	free(balance);
	gz_mesh_free(&mesh);
	gz_volume_free(&volume);
}

static void not_a_number_and_infinities_leave_the_surface_closed(void **state)
{
	(void)state;
	static const int dims[3] = { 33, 20, 20 };
	uint32_t seed = 11;
	struct gz_volume volume = field_noise(dims, GZ_VOXEL_F32, 4, 1);
	const float odd[] = { NAN, INFINITY, -INFINITY, 3e38F, -3e38F, 1e-44F, -0.0F };
	float *voxels = volume.voxels;
	for (size_t i = 0; i < gz_volume_voxel_count(&volume); i++)
		if (voxels[i] != 0 && field_random(&seed) < 0.3)
			voxels[i] = odd[(size_t)(7 * field_random(&seed))];
	gz_volume_find_range(&volume);
	volume.stored_max = 3e38;
	volume.stored_min = -3e38;
	struct gz_mesh mesh = surface_of(&volume, 0.5);
	assert_true(mesh.triangle_count > 1000);
	assert_closed(&mesh);
	assert_sound(&mesh);
	gz_mesh_free(&mesh);
	gz_volume_free(&volume);
}

static void very_large_and_small_numbers_give_the_same_surface(void **state)
{
	(void)state;
	static const int dims[3] = { 50, 50, 50 };
	struct gz_volume volume = field_volume(field_ball, dims, EVEN, GZ_VOXEL_F32);
	struct gz_mesh wanted = surface_of(&volume, 0);
	float *voxels = volume.voxels;
	const float scales[2] = { 0x1p+122F, 0x1p-100F };
	for (int k = 0; k < 2; k++) {
		for (size_t i = 0; i < gz_volume_voxel_count(&volume); i++)
			voxels[i] *= scales[k];
		gz_volume_find_range(&volume);
		struct gz_mesh mesh = surface_of(&volume, 0);
		assert_int_equal(mesh.vertex_count, wanted.vertex_count);
		assert_memory_equal(mesh.positions, wanted.positions,
				    mesh.vertex_count * sizeof *mesh.positions);
		for (size_t v = 0; v < mesh.vertex_count; v++)
			for (int axis = 0; axis < 3; axis++)
				assert_float_equal(mesh.normals[v][axis], wanted.normals[v][axis],
						   1e-5);
		for (size_t i = 0; i < gz_volume_voxel_count(&volume); i++)
			voxels[i] /= scales[k];
		gz_mesh_free(&mesh);
	}
	gz_mesh_free(&wanted);
	gz_volume_free(&volume);
}

static void assert_same_mesh(const struct gz_mesh *a, const struct gz_mesh *b)
{
	assert_int_equal(a->vertex_count, b->vertex_count);
	assert_int_equal(a->triangle_count, b->triangle_count);
	assert_memory_equal(a->positions, b->positions, a->vertex_count * sizeof *a->positions);
	assert_memory_equal(a->normals, b->normals, a->vertex_count * sizeof *a->normals);
	assert_memory_equal(a->triangles, b->triangles, a->triangle_count * sizeof *a->triangles);
}

static void mesh_is_the_same_for_any_number_of_threads(void **state)
{
	(void)state;
	static const int dims[3] = { 70, 41, 39 };
	static const int threads[] = { 1, 2, 3, 7 };
	struct gz_volume volume = field_noise(dims, GZ_VOXEL_U16, 9, 0);
	struct gz_mesh wanted = surface_of(&volume, 100);
	for (size_t k = 0; k < sizeof threads / sizeof threads[0]; k++) {
		const struct gz_isosurface_request request = { .volume = &volume, .isovalue = 100 };
		struct gz_workers *workers = NULL;
		struct gz_mesh mesh;
		assert_int_equal(gz_workers_create(threads[k], &workers), GZ_OK);
		assert_int_equal(gz_isosurface_make(&request, workers, NULL, &mesh), GZ_OK);
		assert_same_mesh(&mesh, &wanted);
		gz_mesh_free(&mesh);
		gz_workers_destroy(&workers);
	}
	gz_mesh_free(&wanted);
	gz_volume_free(&volume);
}

/* Also shows that blocks are read: made to say that a part is empty, they empty it. */
static void macrocells_change_nothing_but_what_is_read(void **state)
{
	(void)state;
	static const int dims[3] = { 75, 51, 50 };
	for (int type = 0; type < GZ_VOXEL_TYPE_COUNT; type++) {
		struct gz_volume volume =
			field_volume(field_ball, dims, EVEN, (enum gz_voxel_type)type);
		struct gz_macrocells cells = { 0 };
		assert_int_equal(gz_macrocells_build(&volume, &cells), GZ_OK);
		struct gz_value_blocks blocks = { .edge = GZ_MACROCELL_EDGE,
						  .least = cells.least,
						  .greatest = cells.greatest };
		memcpy(blocks.dims, cells.dims, sizeof blocks.dims);
		const struct gz_isosurface_request request = { .volume = &volume,
							       .isovalue = 0.3,
							       .blocks = &blocks };
		struct gz_mesh wanted = surface_of(&volume, 0.3), mesh;
		assert_int_equal(gz_isosurface_make(&request, NULL, NULL, &mesh), GZ_OK);
		assert_same_mesh(&mesh, &wanted);
		gz_mesh_free(&mesh);
		const size_t half =
			(size_t)cells.dims[0] * (size_t)cells.dims[1] * (size_t)(cells.dims[2] / 2);
		for (size_t i = 0; i < half; i++)
			cells.greatest[i] = cells.least[i] = (float)volume.stored_min;
		assert_int_equal(gz_isosurface_make(&request, NULL, NULL, &mesh), GZ_OK);
		assert_in_range(mesh.vertex_count, wanted.vertex_count / 4,
				wanted.vertex_count * 3 / 4);
		gz_mesh_free(&mesh);
		gz_mesh_free(&wanted);
		gz_macrocells_free(&cells);
		gz_volume_free(&volume);
	}
}

static void isovalue_outside_the_data_gives_an_empty_mesh_and_a_sentence(void **state)
{
	(void)state;
	static const int dims[3] = { 40, 40, 40 };
	struct gz_volume volume = field_volume(field_ball, dims, EVEN, GZ_VOXEL_U8);
	const double outside[] = { -8.1, -8, 8.1, 1e300, -1e300 };
	for (size_t k = 0; k < sizeof outside / sizeof outside[0]; k++) {
		const struct gz_isosurface_request request = { .volume = &volume,
							       .isovalue = outside[k] };
		struct captured_log log;
		struct gz_mesh mesh;
		captured_log_init(&log, "*:info");
		assert_int_equal(gz_isosurface_make(&request, NULL, &log.log, &mesh), GZ_OK);
		assert_int_equal(mesh.vertex_count, 0);
		assert_int_equal(mesh.triangle_count, 0);
		assert_int_equal(log.messages, 1);
		assert_non_null(strstr(log.last, "range from -8 to 8"));
		assert_int_equal(measures_of(&mesh).edges, 0);
		gz_mesh_free(&mesh);
	}
	gz_volume_free(&volume);
}

static void surface_of_more_elements_than_the_limit_is_refused_with_a_sentence(void **state)
{
	(void)state;
	static const int dims[3] = { 40, 40, 40 };
	struct gz_volume volume = field_volume(field_ball, dims, EVEN, GZ_VOXEL_U8);
	struct gz_isosurface_request request = { .volume = &volume };
	struct captured_log log;
	struct gz_mesh whole, mesh = { .vertex_count = 99 };
	char says[80];
	captured_log_init(&log, "*:info");
	assert_int_equal(gz_isosurface_make(&request, NULL, &log.log, &whole), GZ_OK);
	request.elements_max = whole.triangle_count; /* there are fewer vertices */
	assert_int_equal(gz_isosurface_make(&request, NULL, &log.log, &mesh), GZ_OK);
	assert_int_equal(log.messages, 0);
	gz_mesh_free(&mesh);
	mesh.vertex_count = 99;
	request.elements_max--;
	assert_int_equal(gz_isosurface_make(&request, NULL, &log.log, &mesh), GZ_ERR_FULL);
	assert_int_equal(log.messages, 1);
	snprintf(says, sizeof says, "%zu triangles, more than %zu; choose another isovalue",
		 whole.triangle_count, whole.triangle_count - 1);
	assert_non_null(strstr(log.last, says));
	assert_int_equal(mesh.vertex_count, 99);
	gz_mesh_free(&whole);
	gz_volume_free(&volume);
}

static void volume_of_one_slice_gives_an_empty_mesh_and_a_sentence(void **state)
{
	(void)state;
	for (int axis = 0; axis < 3; axis++) {
		int dims[3] = { 20, 20, 20 };
		dims[axis] = 1;
		struct gz_volume volume = field_noise(dims, GZ_VOXEL_U8, 2, 0);
		const struct gz_isosurface_request request = { .volume = &volume, .isovalue = 99 };
		struct captured_log log;
		struct gz_mesh mesh;
		captured_log_init(&log, "*:info");
		assert_int_equal(gz_isosurface_make(&request, NULL, &log.log, &mesh), GZ_OK);
		assert_int_equal(mesh.triangle_count, 0);
		assert_non_null(strstr(log.last, "two along each axis"));
		gz_volume_free(&volume);
	}
}

static void what_has_no_surface_is_refused(void **state)
{
	(void)state;
	static const int dims[3] = { 4, 4, 4 };
	struct gz_volume volume = field_noise(dims, GZ_VOXEL_U8, 2, 0);
	struct gz_isosurface_request request = { .volume = &volume, .isovalue = NAN };
	struct captured_log log;
	struct gz_mesh mesh = { .vertex_count = 99 };
	captured_log_init(&log, "*:info");
	assert_int_equal(gz_isosurface_make(&request, NULL, &log.log, &mesh), GZ_ERR_INVAL);
	request.isovalue = INFINITY;
	assert_int_equal(gz_isosurface_make(&request, NULL, &log.log, &mesh), GZ_ERR_INVAL);
	assert_int_equal(log.messages, 2);
	struct gz_volume in_bricks = volume;
	in_bricks.voxels = NULL;
	request = (struct gz_isosurface_request) { .volume = &in_bricks, .isovalue = 99 };
	assert_int_equal(gz_isosurface_make(&request, NULL, &log.log, &mesh), GZ_ERR_UNSUPPORTED);
	assert_non_null(strstr(log.last, "bricks"));
	assert_int_equal(mesh.vertex_count, 99);
	gz_volume_free(&volume);
}

TEST_SUITE(isosurface)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(all_instruction_sets_make_the_same_mesh),
		cmocka_unit_test(ball_has_the_area_and_volume_of_a_ball),
		cmocka_unit_test(ring_has_the_area_and_volume_of_a_torus_and_one_handle),
		cmocka_unit_test(surface_of_falling_values_faces_outwards),
		cmocka_unit_test(every_case_of_a_cube_is_closed),
		cmocka_unit_test(variants_of_a_case_use_exactly_its_crossed_edges),
		cmocka_unit_test(saddle_decides_whether_opposite_corners_join),
		cmocka_unit_test(surface_of_noise_is_closed),
		cmocka_unit_test(surface_of_few_values_equal_to_the_isovalue_is_closed),
		cmocka_unit_test(surface_that_leaves_the_volume_is_open_only_there),
		cmocka_unit_test(not_a_number_and_infinities_leave_the_surface_closed),
		cmocka_unit_test(very_large_and_small_numbers_give_the_same_surface),
		cmocka_unit_test(mesh_is_the_same_for_any_number_of_threads),
		cmocka_unit_test(macrocells_change_nothing_but_what_is_read),
		cmocka_unit_test(isovalue_outside_the_data_gives_an_empty_mesh_and_a_sentence),
		cmocka_unit_test(
			surface_of_more_elements_than_the_limit_is_refused_with_a_sentence),
		cmocka_unit_test(volume_of_one_slice_gives_an_empty_mesh_and_a_sentence),
		cmocka_unit_test(what_has_no_surface_is_refused),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
