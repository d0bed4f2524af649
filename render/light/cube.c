#include "render/light/cube.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/sizes.h"
#include "base/vector.h"
#include "render/picture/image.h"

#define GZ_LOG_MODULE "environment"

static const char *const face_names[GZ_CUBE_FACES] = { "right", "left", "front",
						       "back",  "up",   "down" };

/* A face by where its texels are: the components right, front and up of its middle, and of its
 * directions s and t. */
static const struct face_frame {
	int middle[3], s[3], t[3];
} face_frames[GZ_CUBE_FACES] = {
	[GZ_CUBE_RIGHT] = { { 1, 0, 0 }, { 0, -1, 0 }, { 0, 0, -1 } },
	[GZ_CUBE_LEFT] = { { -1, 0, 0 }, { 0, 1, 0 }, { 0, 0, -1 } },
	[GZ_CUBE_FRONT] = { { 0, 1, 0 }, { 1, 0, 0 }, { 0, 0, -1 } },
	[GZ_CUBE_BACK] = { { 0, -1, 0 }, { -1, 0, 0 }, { 0, 0, -1 } },
	[GZ_CUBE_UP] = { { 0, 0, 1 }, { 1, 0, 0 }, { 0, 1, 0 } },
	[GZ_CUBE_DOWN] = { { 0, 0, -1 }, { 1, 0, 0 }, { 0, -1, 0 } },
};

static enum gz_result name_face(const char *folder, int face, const struct gz_log *log,
				char out_path[GZ_PATH_SIZE])
{
	const int length = snprintf(out_path, GZ_PATH_SIZE, "%s/%s.png", folder, face_names[face]);
	if (length > 0 && length < GZ_PATH_SIZE)
		return GZ_OK;
	gz_err(log, "%s: the path of %s.png is too long; move the folder", folder,
	       face_names[face]);
	return GZ_ERR_FORMAT;
}

/* Check a face's size against that of the first one; 0: this is the first. */
static enum gz_result check_face(const char *path, int width, int height, int first_edge,
				 const struct gz_log *log)
{
	if (width != height)
		gz_err(log, "%s: %d x %d pixels; the face of a cube is square", path, width,
		       height);
	else if (width > GZ_CUBE_EDGE_MAX)
		gz_err(log, "%s: %d x %d pixels; a face has at most %d a side", path, width, height,
		       GZ_CUBE_EDGE_MAX);
	else if (first_edge && width != first_edge)
		gz_err(log, "%s: %d x %d pixels, but %s.png has %d x %d; make all faces alike",
		       path, width, height, face_names[0], first_edge, first_edge);
	else
		return GZ_OK;
	return GZ_ERR_FORMAT;
}

/* Find the edge of all faces, which must be one. */
static enum gz_result measure_faces(const char *folder, const struct gz_log *log, int *out_edge)
{
	enum gz_result result = GZ_OK;
	int edge = 0;
	for (int face = 0; face < GZ_CUBE_FACES && result == GZ_OK; face++) {
		char path[GZ_PATH_SIZE];
		int size[2] = { 0, 0 };
		result = name_face(folder, face, log, path);
		if (result == GZ_OK)
			result = gz_image_measure_png(path, log, size);
		if (result == GZ_OK)
			result = check_face(path, size[0], size[1], edge, log);
		edge = size[0];
	}
	if (result == GZ_OK)
		*out_edge = edge;
	return result;
}

enum gz_result gz_cube_check(const char *folder, const struct gz_log *log)
{
	int edge;
	return measure_faces(folder, log, &edge);
}

static uint32_t *texel_of(const struct gz_cube *cube, int face, int x, int y)
{
	const ptrdiff_t row = cube->edge + 2;
	return cube->texels + gz_cube_first_texel(cube->edge, face) + (y + 1) * row + x + 1;
}

static enum gz_result read_face(const char *folder, int face, const struct gz_log *log,
				struct gz_cube *cube)
{
	struct gz_image image = { 0 };
	char path[GZ_PATH_SIZE];
	enum gz_result result = name_face(folder, face, log, path);
	if (result == GZ_OK)
		result = gz_image_read_png(path, log, &image);
	if (result == GZ_OK) /* it may have changed since it was measured */
		result = check_face(path, image.width, image.height, cube->edge, log);
	for (int y = 0; y < cube->edge && result == GZ_OK; y++)
		memcpy(texel_of(cube, face, 0, y),
		       gz_image_words(&image) + (size_t)y * (size_t)cube->edge,
		       (size_t)cube->edge * sizeof *cube->texels);
	gz_image_free(&image);
	return result;
}

/* The face that a direction meets, and the texel there. */
static uint32_t texel_towards(const struct gz_cube *cube, const double direction[3])
{
	int axis = 0, place[2];
	for (int i = 1; i < 3; i++)
		if (fabs(direction[i]) > fabs(direction[axis]))
			axis = i;
	const int face = 2 * axis + (direction[axis] < 0);
	const struct face_frame *frame = &face_frames[face];
	for (int side = 0; side < 2; side++) {
		const int *along = side ? frame->t : frame->s;
		double sum = 0;
		for (int i = 0; i < 3; i++)
			sum += along[i] * direction[i] / fabs(direction[axis]);
		place[side] = (int)floor(0.5 * (sum + 1) * cube->edge);
		place[side] = place[side] < 0             ? 0
			      : place[side] >= cube->edge ? cube->edge - 1
							  : place[side];
	}
	return *texel_of(cube, face, place[0], place[1]);
}

/* Put into the rim what lies there on the neighbour: the face's plane is folded at its edge. */
static void fill_rim_texel(struct gz_cube *cube, int face, int x, int y)
{
	const struct face_frame *frame = &face_frames[face];
	double s = (2 * x + 1.0) / cube->edge - 1, t = (2 * y + 1.0) / cube->edge - 1, depth = 1;
	double direction[3];
	if (fabs(s) > 1) {
		depth = 2 - fabs(s);
		s = s < 0 ? -1 : 1;
	} else {
		depth = 2 - fabs(t);
		t = t < 0 ? -1 : 1;
	}
	for (int i = 0; i < 3; i++)
		direction[i] = depth * frame->middle[i] + s * frame->s[i] + t * frame->t[i];
	*texel_of(cube, face, x, y) = texel_towards(cube, direction);
}

/* The mean of the three texels that meet at a corner of the cube, so that all faces agree there. */
static void fill_rim_corner(struct gz_cube *cube, int face, int x, int y)
{
	const int inner_x = x < 0 ? 0 : x - 1, inner_y = y < 0 ? 0 : y - 1;
	const uint32_t three[3] = { *texel_of(cube, face, inner_x, inner_y),
				    *texel_of(cube, face, x, inner_y),
				    *texel_of(cube, face, inner_x, y) };
	uint32_t mean = 0;
	for (int shift = 0; shift < 32; shift += 8) {
		uint32_t sum = 1; /* for rounding */
		for (int i = 0; i < 3; i++)
			sum += three[i] >> shift & 0xFF;
		mean |= sum / 3 << shift;
	}
	*texel_of(cube, face, x, y) = mean;
}

static void fill_rims(struct gz_cube *cube)
{
	const int edge = cube->edge;
	for (int face = 0; face < GZ_CUBE_FACES; face++) {
		for (int i = 0; i < edge; i++) {
			fill_rim_texel(cube, face, i, -1);
			fill_rim_texel(cube, face, i, edge);
			fill_rim_texel(cube, face, -1, i);
			fill_rim_texel(cube, face, edge, i);
		}
		for (int corner = 0; corner < 4; corner++)
			fill_rim_corner(cube, face, corner & 1 ? edge : -1, corner & 2 ? edge : -1);
	}
}

enum gz_result gz_cube_load(const char *folder, const struct gz_log *log, struct gz_cube *out_cube)
{
	struct gz_cube cube = { 0 };
	enum gz_result result = measure_faces(folder, log, &cube.edge);
	if (result != GZ_OK)
		return result;
	cube.texels = malloc(gz_cube_first_texel(cube.edge, GZ_CUBE_FACES) * sizeof *cube.texels);
	if (!cube.texels) {
		gz_err(log, "%s: no memory for six faces of %d x %d pixels", folder, cube.edge,
		       cube.edge);
		return GZ_ERR_NO_MEM;
	}
	for (int face = 0; face < GZ_CUBE_FACES && result == GZ_OK; face++)
		result = read_face(folder, face, log, &cube);
	if (result != GZ_OK) {
		gz_cube_free(&cube);
		return result;
	}
	fill_rims(&cube);
	*out_cube = cube;
	return GZ_OK;
}

void gz_cube_axes(const double up[3], double out_axes[3][3])
{
	double to[3] = { up[0], up[1], up[2] };
	(void)gz_normalise3(to);
	/* Rodrigues' rotation about z x to = (-to[1], to[0], 0), whose length is the sine. */
	const double about[3] = { -to[1], to[0], 0 }, cosine = to[2];
	const double down = 1 + cosine;
	for (int i = 0; i < 3; i++) {
		double axis[3] = { 0, 0, 0 }, across[3];
		axis[i] = 1;
		gz_cross3(about, axis, across);
		for (int k = 0; k < 3; k++)
			out_axes[i][k] = down < 1e-12 ? (i == 0 ? axis[k] : -axis[k])
						      : cosine * axis[k] + across[k] +
								about[k] * about[i] / down;
	}
}

void gz_cube_free(struct gz_cube *cube)
{
	free(cube->texels);
	*cube = (struct gz_cube) { 0 };
}
