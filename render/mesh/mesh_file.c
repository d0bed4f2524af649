#include "render/mesh/mesh_file.h"

#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/file.h"
#include "base/text.h"

#define GZ_LOG_MODULE "mesh"

/* Bytes that are written at once, and the most that one element takes: a line of OBJ. */
enum { BUFFER_BYTES = 1 << 16, ELEMENT_BYTES = 256 };

/* Where a mesh goes. After the first error nothing more is written. */
struct mesh_writer {
	struct gz_part_file part; /* a regular file; not open for a device */
	int device;               /* -1: a regular file */
	enum gz_result result;
	uint64_t offset; /* bytes that are written */
	size_t used;
	char buffer[BUFFER_BYTES];
};

static void write_buffer(struct mesh_writer *to)
{
	if (to->result == GZ_OK && to->device < 0) {
		to->result = gz_part_file_write(&to->part, to->buffer, to->used, to->offset);
	} else if (to->result == GZ_OK &&
		   gz_write_all(to->device, to->buffer, to->used) < to->used) {
		const int error = errno;
		gz_err(to->part.log, "%s: cannot be written: %s", to->part.path, strerror(error));
		to->result = error == ENOSPC ? GZ_ERR_FULL : GZ_ERR_IO;
	}
	to->offset += to->used;
	to->used = 0;
}

/* Room for @p size bytes, at most ELEMENT_BYTES, that the caller fills. */
static char *take_room(struct mesh_writer *to, size_t size)
{
	if (to->used + size > sizeof to->buffer)
		write_buffer(to);
	char *room = to->buffer + to->used;
	to->used += size;
	return room;
}

__attribute__((format(printf, 2, 3))) static void put_text(struct mesh_writer *to,
							   const char *format, ...)
{
	char text[ELEMENT_BYTES];
	va_list arguments;
	va_start(arguments, format);
	const int length = vsnprintf(text, sizeof text, format, arguments);
	va_end(arguments);
	memcpy(take_room(to, (size_t)length), text, (size_t)length);
}

static char *put_u32(char *at, uint32_t value)
{
	for (int i = 0; i < 4; i++)
		at[i] = (char)(value >> 8 * i & 255);
	return at + 4;
}

static char *put_floats(char *at, const float values[3])
{
	for (int i = 0; i < 3; i++) {
		uint32_t bits;
		memcpy(&bits, &values[i], sizeof bits);
		at = put_u32(at, bits);
	}
	return at;
}

/* What is written: one mesh, or several with labels and colours. */
struct mesh_content {
	const struct gz_mesh_part *parts;
	size_t count;
	bool labelled;
	uint64_t vertices, triangles; /* of all parts */
};

static char *put_colour(char *at, const float colour[3])
{
	for (int i = 0; i < 3; i++)
		*at++ = (char)(uint8_t)(colour[i] * 255 + 0.5F);
	return at;
}

static void write_ply_head(const struct mesh_content *content, struct mesh_writer *to)
{
	put_text(to, "ply\nformat binary_little_endian 1.0\ncomment made by Gazecast; unit: mm\n");
	put_text(to, "element vertex %" PRIu64 "\n", content->vertices);
	put_text(to, "property float x\nproperty float y\nproperty float z\n"
		     "property float nx\nproperty float ny\nproperty float nz\n");
	if (content->labelled)
		put_text(to, "property uchar red\nproperty uchar green\nproperty uchar blue\n");
	put_text(to, "element face %" PRIu64 "\nproperty list uchar int vertex_indices\n",
		 content->triangles);
	put_text(to, "%send_header\n", content->labelled ? "property int label\n" : "");
}

static void write_ply(const struct mesh_content *content, struct mesh_writer *to)
{
	uint32_t first = 0;
	write_ply_head(content, to);
	for (size_t i = 0; i < content->count; i++) {
		const struct gz_mesh *mesh = content->parts[i].mesh;
		for (size_t v = 0; v < mesh->vertex_count; v++) {
			char *at = take_room(to, content->labelled ? 27 : 24);
			at = put_floats(put_floats(at, mesh->positions[v]), mesh->normals[v]);
			if (content->labelled)
				put_colour(at, content->parts[i].colour);
		}
	}
	for (size_t i = 0; i < content->count; i++) {
		const struct gz_mesh *mesh = content->parts[i].mesh;
		for (size_t t = 0; t < mesh->triangle_count; t++) {
			char *at = take_room(to, content->labelled ? 17 : 13);
			*at++ = 3;
			for (int c = 0; c < 3; c++)
				at = put_u32(at, first + mesh->triangles[t][c]);
			if (content->labelled)
				put_u32(at, (uint32_t)content->parts[i].label);
		}
		first += (uint32_t)mesh->vertex_count;
	}
}

/* Nine digits read back as the same float. */
static void put_numbers(struct mesh_writer *to, const char *keyword, const float values[3])
{
	char number[3][GZ_NUMBER_SIZE];
	for (int i = 0; i < 3; i++) {
		snprintf(number[i], sizeof number[i], "%.9g", (double)values[i]);
		gz_number_normalise_point(number[i]);
	}
	put_text(to, "%s %s %s %s\n", keyword, number[0], number[1], number[2]);
}

/* Corners are counted from 1, through all parts. */
static void write_obj_part(const struct gz_mesh *mesh, uint32_t first, struct mesh_writer *to)
{
	for (size_t v = 0; v < mesh->vertex_count; v++)
		put_numbers(to, "v", mesh->positions[v]);
	for (size_t v = 0; v < mesh->vertex_count; v++)
		put_numbers(to, "vn", mesh->normals[v]);
	for (size_t t = 0; t < mesh->triangle_count; t++) {
		uint32_t corner[3];
		for (int c = 0; c < 3; c++)
			corner[c] = first + mesh->triangles[t][c] + 1;
		put_text(to, "f %u//%u %u//%u %u//%u\n", corner[0], corner[0], corner[1], corner[1],
			 corner[2], corner[2]);
	}
}

static void write_obj(const struct mesh_content *content, struct mesh_writer *to)
{
	uint32_t first = 0;
	put_text(to, "# made by Gazecast; unit: mm\n");
	for (size_t i = 0; i < content->count; i++) {
		if (content->labelled)
			put_text(to, "o label_%" PRId32 "\n", content->parts[i].label);
		write_obj_part(content->parts[i].mesh, first, to);
		first += (uint32_t)content->parts[i].mesh->vertex_count;
	}
}

static void plane_normal(const struct gz_mesh *mesh, const uint32_t corners[3], float out[3])
{
	double side[2][3], square = 0;
	const float *first = mesh->positions[corners[0]];
	for (int s = 0; s < 2; s++)
		for (int axis = 0; axis < 3; axis++)
			side[s][axis] =
				(double)mesh->positions[corners[s + 1]][axis] - (double)first[axis];
	double normal[3];
	for (int axis = 0; axis < 3; axis++) {
		const int u = (axis + 1) % 3, v = (axis + 2) % 3;
		normal[axis] = side[0][u] * side[1][v] - side[0][v] * side[1][u];
		square += normal[axis] * normal[axis];
	}
	for (int axis = 0; axis < 3; axis++)
		out[axis] = square > 0 ? (float)(normal[axis] / sqrt(square)) : 0;
}

static void write_stl_part(const struct gz_mesh *mesh, struct mesh_writer *to)
{
	for (size_t t = 0; t < mesh->triangle_count; t++) {
		const uint32_t *corners = mesh->triangles[t];
		float normal[3];
		plane_normal(mesh, corners, normal);
		char *at = put_floats(take_room(to, 50), normal);
		for (int c = 0; c < 3; c++)
			at = put_floats(at, mesh->positions[corners[c]]);
		memset(at, 0, 2); /* no attributes */
	}
}

static void write_stl(const struct mesh_content *content, struct mesh_writer *to)
{
	/* A header that begins with "solid" would be taken for text. */
	char *head = take_room(to, 84);
	memset(head, ' ', 80);
	memcpy(head, "made by Gazecast; unit: mm", 26);
	put_u32(head + 80, (uint32_t)content->triangles);
	for (size_t i = 0; i < content->count; i++)
		write_stl_part(content->parts[i].mesh, to);
}

static const struct mesh_format {
	const char *ending;
	void (*write)(const struct mesh_content *content, struct mesh_writer *to);
} mesh_formats[] = {
	{ ".ply", write_ply },
	{ ".obj", write_obj },
	{ ".stl", write_stl },
};

static const struct mesh_format *mesh_format_of(const char *path)
{
	for (size_t i = 0; i < sizeof mesh_formats / sizeof mesh_formats[0]; i++)
		if (gz_path_ends(path, mesh_formats[i].ending))
			return &mesh_formats[i];
	return NULL;
}

bool gz_mesh_file_named(const char *path)
{
	return mesh_format_of(path) != NULL;
}

static enum gz_result open_device(const char *path, const struct gz_log *log, int *out_device)
{
	*out_device = open(path, O_WRONLY | O_CLOEXEC);
	if (*out_device >= 0)
		return GZ_OK;
	gz_err(log, "%s: cannot be written: %s", path, strerror(errno));
	return GZ_ERR_IO;
}

/* Renaming a file to the name of a device would replace the device. */
static enum gz_result open_mesh_file(struct mesh_writer *to, const char *path,
				     const struct gz_log *log)
{
	struct stat status;
	to->used = 0;
	to->offset = 0;
	to->device = -1;
	to->part = (struct gz_part_file) { .path = path, .log = log, .fd = -1 };
	if (stat(path, &status) == 0 && !S_ISREG(status.st_mode) && !S_ISDIR(status.st_mode))
		to->result = open_device(path, log, &to->device);
	else
		to->result = gz_part_file_open(&to->part, path, log);
	return to->result;
}

static enum gz_result close_mesh_file(struct mesh_writer *to)
{
	write_buffer(to);
	if (to->device < 0)
		return gz_part_file_close(&to->part, to->result);
	if (close(to->device) != 0 && to->result == GZ_OK) {
		gz_err(to->part.log, "%s: cannot be written: %s", to->part.path, strerror(errno));
		to->result = GZ_ERR_IO;
	}
	return to->result;
}

static enum gz_result write_content(const struct mesh_content *content, const char *path,
				    const struct gz_log *log)
{
	struct mesh_writer to;
	const struct mesh_format *format = mesh_format_of(path);
	if (!format) {
		gz_err(log, "%s: unknown ending of a mesh; use " GZ_MESH_ENDINGS, path);
		return GZ_ERR_UNSUPPORTED;
	}
	if (content->vertices > GZ_MESH_COUNT_MAX || content->triangles > GZ_MESH_COUNT_MAX) {
		gz_err(log,
		       "%s: a file holds at most %" PRId32 " vertices and triangles, not %" PRIu64
		       " and %" PRIu64,
		       path, GZ_MESH_COUNT_MAX, content->vertices, content->triangles);
		return GZ_ERR_FULL;
	}
	if (open_mesh_file(&to, path, log) != GZ_OK)
		return to.result;
	format->write(content, &to);
	return close_mesh_file(&to);
}

enum gz_result gz_mesh_write(const struct gz_mesh *mesh, const char *path, const struct gz_log *log)
{
	const struct gz_mesh_part part = { .mesh = mesh };
	const struct mesh_content content = { .parts = &part,
					      .count = 1,
					      .vertices = mesh->vertex_count,
					      .triangles = mesh->triangle_count };
	return write_content(&content, path, log);
}

enum gz_result gz_mesh_write_parts(const struct gz_mesh_part *parts, size_t count, const char *path,
				   const struct gz_log *log)
{
	struct mesh_content content = { .parts = parts, .count = count, .labelled = true };
	for (size_t i = 0; i < count; i++) {
		content.vertices += parts[i].mesh->vertex_count;
		content.triangles += parts[i].mesh->triangle_count;
	}
	return write_content(&content, path, log);
}
