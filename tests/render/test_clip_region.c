/* The clip region as geometry: where rays, boxes and voxels are cut. */
#include "suite.h"

#include <math.h>
#include <string.h>

#include "base/vector.h"
#include "render/data/clip_region.h"

/* A box of 1 x 0.8 x 0.5. */
static const struct gz_volume volume = { .dims = { 10, 16, 20 }, .spacing = { 10, 5, 2.5 } };
static const double half[3] = { 0.5, 0.4, 0.25 };

static struct gz_clip_region cut_at(double x, double y, double z, double offset)
{
	struct gz_clip_region clip = gz_clip_whole;
	clip.plane = true;
	clip.normal[0] = x;
	clip.normal[1] = y;
	clip.normal[2] = z;
	clip.offset = offset;
	return clip;
}

/* The region in the world. */
static struct gz_clip_bounds in_world(const struct gz_clip_region *clip)
{
	double edges[3], corner[3];
	struct gz_clip_bounds bounds;
	for (int axis = 0; axis < 3; axis++) {
		edges[axis] = 2 * half[axis];
		corner[axis] = -half[axis];
	}
	gz_clip_region_place(clip, &volume, edges, corner, &bounds);
	return bounds;
}

static void without_a_plane_all_is_kept(void **state)
{
	(void)state;
	struct gz_clip_region clip = cut_at(0, 0.1, 0.3, 0.2);
	assert_true(gz_clip_region_cuts(&clip));
	clip.plane = false;
	assert_false(gz_clip_region_cuts(&clip));
	const struct gz_clip_bounds bounds = in_world(&clip);
	assert_true(gz_clip_beyond(&bounds, (const double[3]) { 1e6, -1e6, 1e6 }) < 0);
	clip.greatest[2] = 0.99;
	assert_true(gz_clip_region_cuts(&clip));
}

static void offset_is_a_share_of_the_width_along_the_normal(void **state)
{
	(void)state;
	static const double normals[][3] = {
		{ 1, 0, 0 }, { 0, -0.3, 0 }, { 0.2, -0.9, 0.4 }, { -1, -1, -1 }
	};
	for (size_t i = 0; i < sizeof normals / sizeof normals[0]; i++) {
		const double *normal = normals[i];
		/* The corners along the normal and against it, and a place between them. */
		double far[3], near[3], between[3], back[3];
		for (int axis = 0; axis < 3; axis++) {
			far[axis] = normal[axis] < 0 ? -half[axis] : half[axis];
			near[axis] = -far[axis];
			between[axis] = near[axis] + 0.3 * (far[axis] - near[axis]);
			back[axis] = -normal[axis];
		}
		const struct gz_clip_region none = cut_at(normal[0], normal[1], normal[2], 0);
		const struct gz_clip_region all = cut_at(normal[0], normal[1], normal[2], 1);
		const struct gz_clip_region some = cut_at(normal[0], normal[1], normal[2], 0.3);
		const struct gz_clip_region other = cut_at(back[0], back[1], back[2], 0.7);
		const struct gz_clip_bounds bounds[] = { in_world(&none), in_world(&all),
							 in_world(&some), in_world(&other) };
		assert_float_equal(gz_clip_beyond(&bounds[0], near), 0, 1e-12);
		assert_float_equal(gz_clip_beyond(&bounds[1], far), 0, 1e-12);
		assert_float_equal(gz_clip_beyond(&bounds[2], between), 0, 1e-12);
		assert_true(gz_clip_beyond(&bounds[2], far) > 0);
		assert_true(gz_clip_beyond(&bounds[2], near) < 0);
		assert_float_equal(gz_clip_beyond(&bounds[3], between), 0, 1e-12);
		assert_true(gz_clip_beyond(&bounds[3], near) > 0);
		struct gz_clip_region through = cut_at(normal[0], normal[1], normal[2], 1);
		gz_clip_plane_through(&through, &volume, between);
		assert_float_equal(through.offset, 0.3, 1e-12);
		gz_clip_plane_through(&through, &volume, (const double[3]) { 0, 0, 0 });
		assert_float_equal(through.offset, 0.5, 1e-12);
		for (int axis = 0; axis < 3; axis++)
			between[axis] = 3 * far[axis];
		gz_clip_plane_through(&through, &volume, between);
		assert_true(through.offset == 1);
	}
}

/* In voxels of which the axes have other lengths it is the same plane. */
static void plane_is_the_same_in_any_coordinates(void **state)
{
	(void)state;
	static const double shift[3] = { -0.5, 3, 100 };
	const struct gz_clip_region clip = cut_at(0.3, -0.2, 0.9, 0.42);
	const struct gz_clip_bounds world = in_world(&clip);
	const double scale[3] = { volume.dims[0], volume.dims[1], volume.dims[2] };
	struct gz_clip_bounds voxels;
	gz_clip_region_place(&clip, &volume, scale, shift, &voxels);
	double ratio = 0, greatest = 0;
	for (int i = 0; i < 60; i++) {
		double place[3], voxel[3];
		for (int axis = 0; axis < 3; axis++) {
			const double share = fmod(0.37 * (i + 1) * (axis + 1), 1);
			place[axis] = (2 * share - 1) * half[axis];
			voxel[axis] = share * scale[axis] + shift[axis];
		}
		const double here = gz_clip_beyond(&voxels, voxel) / gz_clip_beyond(&world, place);
		ratio = i == 0 ? here : ratio;
		assert_true(here > 0 && fabs(here / ratio - 1) < 1e-9);
	}
	for (int axis = 0; axis < 3; axis++)
		greatest = fmax(greatest, fabs(voxels.plane[axis]));
	assert_float_equal(greatest, 1, 1e-12);
}

static void ray_is_cut_where_it_crosses_the_plane(void **state)
{
	(void)state;
	const struct gz_clip_region clip = cut_at(1, 1, 0, 0.5); /* x + y < 0 is left */
	const struct gz_clip_bounds bounds = in_world(&clip);
	double ends[2];
	/* Into what is left, and out of it. */
	assert_true(gz_clip_bounds_cross(&bounds, (const double[3]) { 2, 0.1, 0 },
					 (const double[3]) { -0.5, 0, 0 }, ends));
	assert_float_equal(ends[0], 2.1 / 0.5, 1e-12);
	assert_float_equal(ends[1], 2.5 / 0.5, 1e-12);
	assert_true(gz_clip_bounds_cross(&bounds, (const double[3]) { 0.05, -2, 0.1 },
					 (const double[3]) { 0, 1, 0 }, ends));
	assert_float_equal(ends[0], 1.6, 1e-12);
	assert_float_equal(ends[1], 1.95, 1e-12);
	/* Along the plane, on either side. */
	assert_true(gz_clip_bounds_cross(&bounds, (const double[3]) { -0.1, 0, -1 },
					 (const double[3]) { 0, 0, 1 }, ends));
	assert_float_equal(ends[0], 0.75, 1e-12);
	assert_float_equal(ends[1], 1.25, 1e-12);
	assert_false(gz_clip_bounds_cross(&bounds, (const double[3]) { 0.1, 0, -1 },
					  (const double[3]) { 0, 0, 1 }, ends));
	/* Away from it, and through the box beside what is left. */
	assert_false(gz_clip_bounds_cross(&bounds, (const double[3]) { 0.2, 0.1, 0 },
					  (const double[3]) { 1, 0, 0 }, ends));
	assert_false(gz_clip_bounds_cross(&bounds, (const double[3]) { 0.45, 2, 0 },
					  (const double[3]) { 0, -1, 0 }, ends));
}

static void voxels_are_kept_by_their_middles(void **state)
{
	(void)state;
	struct gz_clip_region clip = cut_at(-0.5, 0.8, 0.3, 0.57);
	struct gz_clip_voxels voxels;
	int held = 0;
	clip.least[0] = 0.2;
	clip.greatest[2] = 0.9;
	gz_clip_region_voxels(&clip, &volume, &voxels);
	const struct gz_clip_bounds bounds = in_world(&clip);
	for (int z = 0; z < volume.dims[2]; z++)
		for (int y = 0; y < volume.dims[1]; y++) {
			int from = voxels.from[0], to = voxels.to[0];
			gz_clip_voxels_keep(&voxels, y, z, &from, &to);
			for (int x = 0; x < volume.dims[0]; x++) {
				const int at[3] = { x, y, z };
				double middle[3];
				for (int axis = 0; axis < 3; axis++)
					middle[axis] =
						(2 * (at[axis] + 0.5) / volume.dims[axis] - 1) *
						half[axis];
				const bool in =
					x >= 2 && z < 18 && gz_clip_beyond(&bounds, middle) <= 0;
				assert_int_equal(gz_clip_voxels_hold(&voxels, at), in);
				if (z < 18)
					assert_int_equal(x >= from && x < to, in);
				held += in;
			}
		}
	assert_in_range(held, 300, 2500);
}

/* Corners lie on the plane and on the box, and go around once. */
static void check_outline(const struct gz_clip_region *clip, int expected)
{
	double corners[GZ_BOX_POLYGON_MAX][3], places[GZ_BOX_POLYGON_MAX][3], sum[3] = { 0 };
	const struct gz_clip_bounds bounds = in_world(clip);
	const int count = gz_clip_plane_outline(clip, &volume, corners);
	assert_int_equal(count, expected);
	for (int i = 0; i < count; i++) {
		int faces = 0;
		for (int axis = 0; axis < 3; axis++) {
			places[i][axis] = (2 * corners[i][axis] - 1) * half[axis];
			faces += fabs(corners[i][axis] - clip->least[axis]) < 1e-9 ||
				 fabs(corners[i][axis] - clip->greatest[axis]) < 1e-9;
			assert_true(corners[i][axis] > clip->least[axis] - 1e-9 &&
				    corners[i][axis] < clip->greatest[axis] + 1e-9);
		}
		assert_true(faces >= 2);
		assert_float_equal(gz_clip_beyond(&bounds, places[i]), 0, 1e-9);
	}
	/* All turns are to one side. */
	for (int i = 0; i < count; i++) {
		double a[3], b[3], turn[3];
		for (int axis = 0; axis < 3; axis++) {
			a[axis] = places[(i + 1) % count][axis] - places[i][axis];
			b[axis] = places[(i + 2) % count][axis] - places[(i + 1) % count][axis];
		}
		gz_cross3(a, b, turn);
		assert_true(gz_dot3(turn, sum) >= 0);
		for (int axis = 0; axis < 3; axis++)
			sum[axis] += turn[axis];
	}
	assert_true(count == 0 || gz_length3(sum) > 0);
}

static void outline_is_where_the_plane_meets_the_clip_box(void **state)
{
	(void)state;
	struct gz_clip_region clip = cut_at(0, 0, -1, 0.3);
	check_outline(&clip, 4);
	clip = cut_at(1 / 0.5, 1 / 0.4, 1 / 0.25, 0.5); /* scaled to a cube, it is a hexagon */
	for (int axis = 0; axis < 3; axis++)
		clip.normal[axis] /= 4;
	check_outline(&clip, 6);
	clip.offset = 0.1;
	check_outline(&clip, 3);
	clip = cut_at(0.5, 0.1, 0, 0.5);
	check_outline(&clip, 4);
	clip.greatest[0] = 0.3;
	check_outline(&clip, 0);
	clip.offset = 0.25;
	check_outline(&clip, 4);
}

static void trace_is_where_the_outline_crosses_a_slice(void **state)
{
	(void)state;
	double ends[2][3];
	struct gz_clip_region clip = cut_at(1 / 0.5, 1 / 0.4, 1 / 0.25, 0.5);
	for (int i = 0; i < 3; i++)
		clip.normal[i] /= 4;
	for (int axis = 0; axis < 3; axis++)
		for (double share = 0.125; share < 1; share += 0.25) {
			const struct gz_clip_bounds bounds = in_world(&clip);
			assert_true(gz_clip_plane_trace(&clip, &volume, axis, share, ends));
			for (int i = 0; i < 2; i++) {
				double place[3];
				int faces = 0;
				for (int k = 0; k < 3; k++) {
					place[k] = (2 * ends[i][k] - 1) * half[k];
					faces += k != axis && (fabs(ends[i][k]) < 1e-9 ||
							       fabs(ends[i][k] - 1) < 1e-9);
				}
				assert_true(ends[i][axis] == share && faces > 0);
				assert_float_equal(gz_clip_beyond(&bounds, place), 0, 1e-9);
			}
			assert_true(fabs(ends[0][0] - ends[1][0]) + fabs(ends[0][1] - ends[1][1]) +
					    fabs(ends[0][2] - ends[1][2]) >
				    0.1);
		}
	/* A plane across the axis of the slice has no line in it. */
	clip = cut_at(0, 0, -1, 0.5);
	assert_false(gz_clip_plane_trace(&clip, &volume, 2, 0.5, ends));
	assert_false(gz_clip_plane_trace(&clip, &volume, 2, 0.4, ends));
	assert_true(gz_clip_plane_trace(&clip, &volume, 0, 0.4, ends));
	/* The line ends where the clip box does. */
	clip.greatest[1] = 0.3;
	assert_true(gz_clip_plane_trace(&clip, &volume, 0, 0.4, ends));
	assert_float_equal(fmax(ends[0][1], ends[1][1]), 0.3, 1e-9);
	clip.greatest[0] = 0.3;
	assert_false(gz_clip_plane_trace(&clip, &volume, 0, 0.4, ends));
}

TEST_SUITE(clip_region)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(without_a_plane_all_is_kept),
		cmocka_unit_test(offset_is_a_share_of_the_width_along_the_normal),
		cmocka_unit_test(plane_is_the_same_in_any_coordinates),
		cmocka_unit_test(ray_is_cut_where_it_crosses_the_plane),
		cmocka_unit_test(voxels_are_kept_by_their_middles),
		cmocka_unit_test(trace_is_where_the_outline_crosses_a_slice),
		cmocka_unit_test(outline_is_where_the_plane_meets_the_clip_box),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
