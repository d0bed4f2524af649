/* Surfaces of labels. */
#include "suite.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/captured_log.h"
#include "base/workers.h"
#include "render/mesh/label_surfaces.h"
#include "render/mesh/mesh_measure.h"

/* A volume of labels, made by a formula of the voxel's place. */
typedef double label_formula(int x, int y, int z);

static struct gz_volume make_labels(int edge, enum gz_voxel_type type, label_formula *formula)
{
	struct gz_volume volume = {
		.dims = { edge, edge, edge }, .spacing = { 1, 1, 1 }, .type = type, .slope = 1
	};
	assert_int_equal(gz_volume_allocate(&volume), GZ_OK);
	size_t i = 0;
	for (int z = 0; z < edge; z++)
		for (int y = 0; y < edge; y++)
			for (int x = 0; x < edge; x++, i++) {
				const double value = formula(x, y, z);
				if (type == GZ_VOXEL_U8)
					((uint8_t *)volume.voxels)[i] = (uint8_t)value;
				else if (type == GZ_VOXEL_U16)
					((uint16_t *)volume.voxels)[i] = (uint16_t)value;
				else
					((float *)volume.voxels)[i] = (float)value;
			}
	gz_volume_find_range(&volume);
	return volume;
}

static struct gz_label_surfaces make_surfaces_of(const struct gz_volume *volume, int smoothing,
						 int threads)
{
	struct gz_label_surfaces surfaces;
	struct gz_workers *workers = NULL;
	const struct gz_label_look look = { .smoothing = smoothing, .reach = 0.5 };
	const struct gz_label_request request = { .volume = volume,
						  .name = "labels",
						  .look = &look };
	if (threads > 0)
		assert_int_equal(gz_workers_create(threads, &workers), GZ_OK);
	assert_int_equal(gz_label_surfaces_make(&request, workers, NULL, &surfaces), GZ_OK);
	gz_workers_destroy(&workers);
	return surfaces;
}

static struct gz_mesh_measures measure(const struct gz_label_surface *surface)
{
	struct gz_mesh_measures measures;
	assert_int_equal(gz_mesh_measure(&surface->mesh, &measures), GZ_OK);
	return measures;
}

static double from_centre(double x, double y, double z)
{
	return sqrt((x - 24) * (x - 24) + (y - 24) * (y - 24) + (z - 24) * (z - 24));
}

static double ball(int x, int y, int z)
{
	return from_centre(x, y, z) < 18.3 ? 7 : 0;
}

/* A tube round the axis z: one handle. */
static double ring(int x, int y, int z)
{
	const double out = hypot(x - 24.0, y - 24.0) - 14;
	return hypot(out, z - 24.0) < 5.2 ? 3 : 0;
}

/* A ball of eight labels, which all meet in its middle, within a shell of a ninth. */
static double octants(int x, int y, int z)
{
	const double r = from_centre(x, y, z);
	return r < 14 ? 1 + (x > 23) + 2 * (y > 23) + 4 * (z > 23) : r < 19 ? 100 : 0;
}

/* Blocks of many labels that fill the volume up to its sides. */
static double blocks(int x, int y, int z)
{
	return 1 + x / 5 + 7 * (y / 5) + 49 * (z / 5);
}

/* Noise: whatever labels can do to each other. */
static double noise(int x, int y, int z)
{
	uint32_t hash = (uint32_t)x * 73856093U ^ (uint32_t)y * 19349663U ^ (uint32_t)z * 83492791U;
	hash = (hash ^ hash >> 13) * 1274126177U;
	return (hash >> 16) % 5;
}

static void ball_keeps_its_volume_and_is_one_closed_surface(void **state)
{
	(void)state;
	struct gz_volume volume = make_labels(48, GZ_VOXEL_U8, ball);
	for (int smoothing = 0; smoothing <= GZ_LABEL_SMOOTHING_MAX; smoothing += 20) {
		struct gz_label_surfaces surfaces = make_surfaces_of(&volume, smoothing, 2);
		assert_int_equal(surfaces.count, 1);
		assert_int_equal(surfaces.items[0].number, 7);
		const struct gz_mesh_measures measures = measure(&surfaces.items[0]);
		assert_true(gz_mesh_closed(&measures));
		assert_int_equal(measures.euler, 2);
		const double voxels = (double)surfaces.items[0].voxels;
		if (!(fabs(measures.volume / voxels - 1) < 0.005))
			fail_msg("smoothing %d: %.1f mm3, %.0f voxels", smoothing, measures.volume,
				 voxels);
		gz_label_surfaces_free(&surfaces);
	}
	gz_volume_free(&volume);
}

static void smoothing_flattens_the_stairs_of_a_ball(void **state)
{
	(void)state;
	struct gz_volume volume = make_labels(48, GZ_VOXEL_U8, ball);
	double mean[2] = { 0, 0 }, area[2];
	for (int smooth = 0; smooth < 2; smooth++) {
		struct gz_label_surfaces surfaces = make_surfaces_of(&volume, 12 * smooth, 1);
		const struct gz_mesh *mesh = &surfaces.items[0].mesh;
		for (size_t v = 0; v < mesh->vertex_count; v++) {
			/* Voxel 24's centre lies half a voxel right of the middle. */
			const float *at = mesh->positions[v], *normal = mesh->normals[v];
			double dot = 0, length = 0;
			for (int axis = 0; axis < 3; axis++) {
				const double d = (double)at[axis] - 0.5;
				dot += d * (double)normal[axis];
				length += d * d;
			}
			mean[smooth] +=
				acos(fmin(dot / sqrt(length), 1)) / (double)mesh->vertex_count;
			assert_true(fabs(sqrt(length) - 18.3) < 0.87); /* half a diagonal */
		}
		area[smooth] = measure(&surfaces.items[0]).area;
		gz_label_surfaces_free(&surfaces);
	}
	const double sphere = 4 * 3.14159265 * 18.3 * 18.3;
	if (!(mean[1] < 0.7 * mean[0] && fabs(area[1] / sphere - 1) < 0.02))
		fail_msg("normals off by %g before and %g after, area %g of %g", mean[0], mean[1],
			 area[1], sphere);
	gz_volume_free(&volume);
}

/* Terraces two voxels high and eight long, as a slope has that was drawn on a coarser grid. */
static double terraces(int x, int y, int z)
{
	(void)y;
	return z < 12 + 2 * (x / 8) ? 1 : 0;
}

/* The greatest angle between the normals of the slope and its own, degrees, away from the sides. */
static double steepest_on_terraces(const struct gz_volume *volume, int smoothing, double reach)
{
	const struct gz_label_look look = { .smoothing = smoothing, .reach = reach };
	const struct gz_label_request request = { .volume = volume,
						  .name = "labels",
						  .look = &look };
	struct gz_label_surfaces surfaces;
	double greatest = 0;
	assert_int_equal(gz_label_surfaces_make(&request, NULL, NULL, &surfaces), GZ_OK);
	const struct gz_mesh *mesh = &surfaces.items[0].mesh;
	for (size_t v = 0; v < mesh->vertex_count; v++) {
		const float *at = mesh->positions[v], *normal = mesh->normals[v];
		/* rises by 2 in 8 voxels */
		const double along = ((double)normal[2] * 4 - (double)normal[0]) / sqrt(17);
		if (fabs((double)at[0]) < 8 && fabs((double)at[1]) < 8 && (double)at[2] > -20)
			greatest = fmax(greatest, acos(fmin(along, 1)) * 57.29578);
	}
	gz_label_surfaces_free(&surfaces);
	return greatest;
}

static void smoothing_with_enough_reach_flattens_terraces(void **state)
{
	(void)state;
	struct gz_volume volume = make_labels(48, GZ_VOXEL_U8, terraces);
	const double stairs = steepest_on_terraces(&volume, 0, 0.5);
	const double held = steepest_on_terraces(&volume, 30, 0.5);
	const double flat = steepest_on_terraces(&volume, 30, 1.5);
	if (!(stairs > 25 && held < stairs && flat < 4 && flat < 0.5 * held))
		fail_msg("stairs %.1f, held %.1f, flat %.1f degrees", stairs, held, flat);
	/* Without reach vertices go to the corners of voxels. */
	assert_true(steepest_on_terraces(&volume, 30, 0) > 25);
	gz_volume_free(&volume);
}

/* How far a place lies from a slanted plane that cuts the ball. */
static double from_cut(double x, double y, double z)
{
	return (x - 24 + 2.3 * (y - 24) + 4 * (z - 24) - 10) / sqrt(1 + 2.3 * 2.3 + 4 * 4);
}

static double cut_ball(int x, int y, int z)
{
	return from_centre(x, y, z) < 18.3 ? 1 + (from_cut(x, y, z) > 0) : 0;
}

static bool mesh_has_place(const struct gz_mesh *mesh, const float place[3])
{
	for (size_t i = 0; i < mesh->vertex_count; i++)
		if (memcmp(mesh->positions[i], place, sizeof mesh->positions[i]) == 0)
			return true;
	return false;
}

/* How far the border of two labels on the surface of the ball strays from the plane, voxels: root
 * mean square over the vertices that both have, near the surface. */
static double stray_of_border(const struct gz_label_surfaces *surfaces)
{
	const struct gz_mesh *one = &surfaces->items[0].mesh, *two = &surfaces->items[1].mesh;
	double squares = 0;
	size_t count = 0;
	for (size_t i = 0; i < one->vertex_count; i++) {
		double at[3];
		for (int axis = 0; axis < 3; axis++) /* places are of the box, from its middle */
			at[axis] = (double)one->positions[i][axis] + 23.5;
		if (from_centre(at[0], at[1], at[2]) < 17.6 ||
		    !mesh_has_place(two, one->positions[i]))
			continue;
		squares += pow(from_cut(at[0], at[1], at[2]), 2);
		count++;
	}
	assert_true(count > 50);
	return sqrt(squares / (double)count);
}

/* Where two labels meet on the outside of a body, their border had teeth as long as voxels. */
static void border_of_two_labels_is_smooth_and_keeps_volumes(void **state)
{
	(void)state;
	struct gz_volume volume = make_labels(48, GZ_VOXEL_U8, cut_ball);
	double voxels[2] = { 0 };
	for (int i = 0; i < 48 * 48 * 48; i++)
		for (int label = 1; label <= 2; label++)
			voxels[label - 1] += ((const uint8_t *)volume.voxels)[i] == label;
	const struct gz_label_look look = { .smoothing = 30, .reach = 1.5 };
	const struct gz_label_request request = { .volume = &volume,
						  .name = "labels",
						  .look = &look };
	struct gz_label_surfaces surfaces;
	assert_int_equal(gz_label_surfaces_make(&request, NULL, NULL, &surfaces), GZ_OK);
	assert_int_equal(surfaces.count, 2);
	const double stray = stray_of_border(&surfaces);
	if (stray > 0.25) /* before: 0.33 */
		fail_msg("the border strays by %.3f voxels", stray);
	for (int i = 0; i < 2; i++)
		assert_float_equal(fabs(measure(&surfaces.items[i]).volume) / voxels[i], 1, 0.015);
	gz_label_surfaces_free(&surfaces);
	gz_volume_free(&volume);
}

static void ring_has_one_handle(void **state)
{
	(void)state;
	struct gz_volume volume = make_labels(48, GZ_VOXEL_U16, ring);
	struct gz_label_surfaces surfaces = make_surfaces_of(&volume, 12, 2);
	const struct gz_mesh_measures measures = measure(&surfaces.items[0]);
	assert_true(gz_mesh_closed(&measures));
	assert_int_equal(measures.euler, 0);
	gz_label_surfaces_free(&surfaces);
	gz_volume_free(&volume);
}

/* A triangle by its corners, turned so that the least comes first. */
struct corners {
	float at[3][3];
};

static int compare_corners(const void *a, const void *b)
{
	return memcmp(a, b, sizeof(struct corners));
}

static struct corners corners_of(const struct gz_mesh *mesh, size_t triangle, bool reversed)
{
	struct corners in, out;
	for (int c = 0; c < 3; c++) {
		const uint32_t vertex = mesh->triangles[triangle][reversed ? 2 - c : c];
		for (int axis = 0; axis < 3; axis++)
			in.at[c][axis] = mesh->positions[vertex][axis] + 0.0F; /* no -0 */
	}
	int first = 0;
	for (int c = 1; c < 3; c++)
		if (memcmp(in.at[c], in.at[first], sizeof in.at[c]) < 0)
			first = c;
	for (int c = 0; c < 3; c++)
		memcpy(out.at[c], in.at[(first + c) % 3], sizeof out.at[c]);
	return out;
}

static struct corners *list_corners(const struct gz_label_surfaces *surfaces, bool reversed,
				    size_t *out_count)
{
	size_t count = 0;
	for (size_t i = 0; i < surfaces->count; i++)
		count += surfaces->items[i].mesh.triangle_count;
	struct corners *list = malloc(count * sizeof *list);
	assert_non_null(list);
	*out_count = count;
	count = 0;
	for (size_t i = 0; i < surfaces->count; i++)
		for (size_t t = 0; t < surfaces->items[i].mesh.triangle_count; t++)
			list[count++] = corners_of(&surfaces->items[i].mesh, t, reversed);
	qsort(list, count, sizeof *list, compare_corners);
	return list;
}

/* Every triangle of every label that does not face the outside is there once more, reversed: of the
 * neighbour. @return triangles that have no such counterpart */
static size_t count_single(const struct gz_label_surfaces *surfaces)
{
	size_t count, single = 0;
	struct corners *straight = list_corners(surfaces, false, &count);
	struct corners *reversed = list_corners(surfaces, true, &count);
	for (size_t i = 0; i < count; i++)
		single +=
			!bsearch(&straight[i], reversed, count, sizeof *reversed, compare_corners);
	free(straight);
	free(reversed);
	return single;
}

static void neighbours_share_their_faces_with_opposite_orientation(void **state)
{
	(void)state;
	struct gz_volume volume = make_labels(48, GZ_VOXEL_U8, octants);
	struct gz_label_surfaces surfaces = make_surfaces_of(&volume, 12, 2);
	assert_int_equal(surfaces.count, 9);
	size_t shell_inside = 0;
	double inner = 0;
	for (size_t i = 0; i < 8; i++) {
		const struct gz_mesh_measures measures = measure(&surfaces.items[i]);
		assert_true(gz_mesh_closed(&measures));
		assert_int_equal(measures.euler, 2);
		inner += measures.volume;
		shell_inside += surfaces.items[i].mesh.triangle_count;
	}
	/* The shell has an outer and an inner surface; what faces the outside is single. */
	const struct gz_mesh_measures shell = measure(&surfaces.items[8]);
	assert_true(gz_mesh_closed(&shell));
	assert_int_equal(shell.euler, 4);
	assert_true(shell_inside > 0);
	const size_t single = count_single(&surfaces);
	struct gz_volume whole = make_labels(48, GZ_VOXEL_U8, octants);
	for (size_t i = 0; i < gz_volume_voxel_count(&whole); i++)
		((uint8_t *)whole.voxels)[i] = ((uint8_t *)whole.voxels)[i] > 0;
	struct gz_label_surfaces outer = make_surfaces_of(&whole, 12, 2);
	assert_int_equal(single, outer.items[0].mesh.triangle_count);
	/* Without gaps and overlaps the parts' volumes add up to the whole's. */
	assert_float_equal(inner + shell.volume, measure(&outer.items[0]).volume,
			   1e-4 * measure(&outer.items[0]).volume);
	gz_label_surfaces_free(&outer);
	gz_volume_free(&whole);
	gz_label_surfaces_free(&surfaces);
	gz_volume_free(&volume);
}

static void labels_that_fill_the_volume_fill_its_box(void **state)
{
	(void)state;
	struct gz_volume volume = make_labels(35, GZ_VOXEL_U16, blocks);
	volume.spacing[2] = 2.5;
	struct gz_label_surfaces surfaces = make_surfaces_of(&volume, 20, 2);
	double sum = 0;
	assert_int_equal(surfaces.count, 343);
	for (size_t i = 0; i < surfaces.count; i++) {
		const struct gz_mesh_measures measures = measure(&surfaces.items[i]);
		assert_true(gz_mesh_closed(&measures));
		assert_int_equal(measures.euler, 2);
		assert_int_equal(surfaces.items[i].voxels, 125);
		sum += measures.volume;
	}
	assert_float_equal(sum, 35 * 35 * 35 * 2.5, 0.5);
	gz_label_surfaces_free(&surfaces);
	gz_volume_free(&volume);
}

static void noise_has_no_open_edge(void **state)
{
	(void)state;
	struct gz_volume volume = make_labels(20, GZ_VOXEL_F32, noise);
	struct gz_label_surfaces surfaces = make_surfaces_of(&volume, 5, 2);
	double sum = 0, voxels = 0;
	assert_int_equal(surfaces.count, 4);
	for (size_t i = 0; i < surfaces.count; i++) {
		const struct gz_mesh_measures measures = measure(&surfaces.items[i]);
		assert_int_equal(measures.border_edges, 0);
		assert_int_equal(measures.turned_edges, 0);
		assert_true(measures.crowded_edges > 0); /* it touches itself */
		sum += measures.volume;
		voxels += (double)surfaces.items[i].voxels;
	}
	assert_true(sum > 0 && voxels < 20 * 20 * 20);
	gz_label_surfaces_free(&surfaces);
	gz_volume_free(&volume);
}

static void assert_same_meshes(const struct gz_label_surfaces *a, const struct gz_label_surfaces *b)
{
	assert_int_equal(a->count, b->count);
	for (size_t i = 0; i < a->count; i++) {
		const struct gz_mesh *x = &a->items[i].mesh, *y = &b->items[i].mesh;
		assert_int_equal(x->vertex_count, y->vertex_count);
		assert_int_equal(x->triangle_count, y->triangle_count);
		assert_memory_equal(x->positions, y->positions,
				    x->vertex_count * sizeof *x->positions);
		assert_memory_equal(x->normals, y->normals, x->vertex_count * sizeof *x->normals);
		assert_memory_equal(x->triangles, y->triangles,
				    x->triangle_count * sizeof *x->triangles);
	}
}

static void meshes_are_the_same_for_any_number_of_threads_and_type(void **state)
{
	(void)state;
	struct gz_volume bytes = make_labels(24, GZ_VOXEL_U8, noise);
	struct gz_volume floats = make_labels(24, GZ_VOXEL_F32, noise);
	struct gz_label_surfaces alone = make_surfaces_of(&bytes, 4, 0);
	for (int threads = 1; threads <= 5; threads += 2) {
		struct gz_label_surfaces several =
			make_surfaces_of(threads == 3 ? &floats : &bytes, 4, threads);
		assert_same_meshes(&alone, &several);
		gz_label_surfaces_free(&several);
	}
	gz_label_surfaces_free(&alone);
	gz_volume_free(&bytes);
	gz_volume_free(&floats);
}

static double halves(int x, int y, int z)
{
	return x == 3 && y == 3 && z == 3 ? 1.5 : 1;
}

static double thousands(int x, int y, int z)
{
	return x + 12 * y + 144 * z;
}

static double nothing(int x, int y, int z)
{
	(void)x;
	(void)y;
	(void)z;
	return 0;
}

static double one_voxel(int x, int y, int z)
{
	return x == 0 && y == 11 && z == 5;
}

/* What the last try_labels() has said. */
static struct captured_log said;

static enum gz_result try_labels_up_to(uint64_t elements_max, enum gz_voxel_type type,
				       label_formula *formula, struct gz_label_surfaces *out)
{
	struct gz_volume volume = make_labels(12, type, formula);
	const struct gz_label_look look = { .smoothing = 10, .reach = 0.5 };
	const struct gz_label_request request = {
		.volume = &volume, .name = "labels", .look = &look, .elements_max = elements_max
	};
	captured_log_init(&said, "*:info");
	const enum gz_result result = gz_label_surfaces_make(&request, NULL, &said.log, out);
	gz_volume_free(&volume);
	return result;
}

static enum gz_result try_labels(enum gz_voxel_type type, label_formula *formula,
				 struct gz_label_surfaces *out)
{
	return try_labels_up_to(0, type, formula, out);
}

/* 960 labels, and 961. */
static double most_labels(int x, int y, int z)
{
	return fmin(thousands(x, y, z), 960);
}

static double one_label_more(int x, int y, int z)
{
	return fmin(thousands(x, y, z), 961);
}

static void as_many_labels_as_allowed_are_shown_and_one_more_is_refused(void **state)
{
	(void)state;
	struct gz_label_surfaces surfaces = { 0 };
	assert_int_equal(try_labels(GZ_VOXEL_U16, most_labels, &surfaces), GZ_OK);
	assert_int_equal(surfaces.count, 960);
	assert_int_equal(surfaces.items[0].voxels, 1);
	assert_int_equal(surfaces.items[959].voxels, 1728 - 960);
	gz_label_surfaces_free(&surfaces);
	assert_int_equal(try_labels(GZ_VOXEL_U16, one_label_more, &surfaces), GZ_ERR_FULL);
	assert_int_equal(said.messages, 1);
	assert_non_null(strstr(said.last, "960"));
}

/* A voxel has 8 vertices, 6 faces and 12 triangles. */
static void surfaces_of_more_elements_than_the_limit_are_refused_with_a_sentence(void **state)
{
	(void)state;
	struct gz_label_surfaces surfaces = { 0 };
	assert_int_equal(try_labels_up_to(12, GZ_VOXEL_U8, one_voxel, &surfaces), GZ_OK);
	gz_label_surfaces_free(&surfaces);
	assert_int_equal(try_labels_up_to(11, GZ_VOXEL_U8, one_voxel, &surfaces), GZ_ERR_FULL);
	assert_int_equal(said.messages, 1);
	assert_non_null(strstr(said.last, "label 1 has 12 triangles, more than 11"));
	assert_int_equal(try_labels_up_to(7, GZ_VOXEL_U8, one_voxel, &surfaces), GZ_ERR_FULL);
	assert_int_equal(said.messages, 1);
	assert_non_null(strstr(said.last, "8 vertices and 6 faces, more than 7"));
	assert_null(surfaces.items);
}

static void volumes_that_hold_no_labels_or_too_many_are_refused(void **state)
{
	(void)state;
	struct gz_label_surfaces surfaces = { 0 };
	assert_int_equal(try_labels(GZ_VOXEL_F32, halves, &surfaces), GZ_ERR_FORMAT);
	assert_int_equal(try_labels(GZ_VOXEL_U16, thousands, &surfaces), GZ_ERR_FULL);
	assert_int_equal(try_labels(GZ_VOXEL_F32, thousands, &surfaces), GZ_ERR_FULL);
	assert_null(surfaces.items);
	assert_int_equal(try_labels(GZ_VOXEL_U8, nothing, &surfaces), GZ_OK);
	assert_int_equal(surfaces.count, 0);
	gz_label_surfaces_free(&surfaces);
}

static void single_voxel_at_the_side_stays(void **state)
{
	(void)state;
	struct gz_label_surfaces surfaces;
	assert_int_equal(try_labels(GZ_VOXEL_U8, one_voxel, &surfaces), GZ_OK);
	assert_int_equal(surfaces.count, 1);
	assert_int_equal(surfaces.items[0].mesh.vertex_count, 8);
	const struct gz_mesh_measures measures = measure(&surfaces.items[0]);
	assert_true(gz_mesh_closed(&measures));
	assert_int_equal(measures.euler, 2);
	assert_true(measures.volume > 0);
	gz_label_surfaces_free(&surfaces);
}

static void colours_of_near_labels_differ(void **state)
{
	(void)state;
	for (int32_t a = -5; a < 200; a++) {
		float x[3], y[3];
		gz_label_colour(a, x);
		for (int i = 0; i < 3; i++)
			assert_true(x[i] >= 0.15F && x[i] <= 1);
		for (int32_t b = a + 1; b < a + 8; b++) {
			double apart = 0;
			gz_label_colour(b, y);
			for (int i = 0; i < 3; i++)
				apart = fmax(apart, fabs((double)x[i] - (double)y[i]));
			if (!(apart > 0.1))
				fail_msg("labels %d and %d look alike", a, b);
		}
	}
}

TEST_SUITE(label_surfaces)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(ball_keeps_its_volume_and_is_one_closed_surface),
		cmocka_unit_test(smoothing_flattens_the_stairs_of_a_ball),
		cmocka_unit_test(smoothing_with_enough_reach_flattens_terraces),
		cmocka_unit_test(border_of_two_labels_is_smooth_and_keeps_volumes),
		cmocka_unit_test(ring_has_one_handle),
		cmocka_unit_test(neighbours_share_their_faces_with_opposite_orientation),
		cmocka_unit_test(labels_that_fill_the_volume_fill_its_box),
		cmocka_unit_test(noise_has_no_open_edge),
		cmocka_unit_test(meshes_are_the_same_for_any_number_of_threads_and_type),
		cmocka_unit_test(volumes_that_hold_no_labels_or_too_many_are_refused),
		cmocka_unit_test(as_many_labels_as_allowed_are_shown_and_one_more_is_refused),
		cmocka_unit_test(
			surfaces_of_more_elements_than_the_limit_are_refused_with_a_sentence),
		cmocka_unit_test(single_voxel_at_the_side_stays),
		cmocka_unit_test(colours_of_near_labels_differ),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
