/* OBJ: a text of lines v (a vertex), vn (a normal) and f (a face, as numbers of both). Wavefront,
 * "Advanced Visualizer Manual", appendix B1. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/text.h"
#include "base/vector.h"
#include "render/mesh/mesh_parse.h"
#include "render/mesh/mesh_read.h"

#define GZ_LOG_MODULE "mesh"

/* How many of a file's lines there are. */
struct obj_counts {
	size_t vertices, normals, triangles;
};

/* An OBJ file while it is read. */
struct obj_reader {
	const char *name;
	const struct gz_log *log;
	const char *bytes;
	size_t size;
	struct gz_mesh_words words;
	struct obj_counts all, past; /* of the file; before the present line */
	struct gz_mesh mesh;
	float (*normals)[3];
};

/* What a pass does with a line whose first word it has taken. */
typedef enum gz_result obj_line(struct obj_reader *reader, const char *word);

static enum gz_result refuse_obj(const struct obj_reader *reader, const char *what)
{
	gz_err(reader->log, "%s:%zu: %s; write the mesh again as OBJ", reader->name,
	       reader->words.line, what);
	return GZ_ERR_FORMAT;
}

static enum gz_result pass_over_obj(struct obj_reader *reader, obj_line *take)
{
	char word[GZ_MESH_WORD_SIZE];
	enum gz_result result = GZ_OK;
	reader->words = (struct gz_mesh_words) { reader->bytes, reader->bytes + reader->size, 1 };
	reader->past = (struct obj_counts) { 0 };
	do {
		if (gz_mesh_next_word(&reader->words, word))
			result = take(reader, word);
	} while (result == GZ_OK && gz_mesh_next_line(&reader->words));
	return result;
}

static enum gz_result count_obj_line(struct obj_reader *reader, const char *word)
{
	size_t corners = 0;
	char corner[GZ_MESH_WORD_SIZE];
	reader->all.vertices += strcmp(word, "v") == 0;
	reader->all.normals += strcmp(word, "vn") == 0;
	if (strcmp(word, "f") != 0)
		return GZ_OK;
	while (gz_mesh_next_word(&reader->words, corner))
		corners++;
	reader->all.triangles += corners > 2 ? corners - 2 : 0;
	return GZ_OK;
}

/* Read vertices and normals; those of length 0 stay 0 0 0. */
static enum gz_result take_obj_place(struct obj_reader *reader, const char *word)
{
	const bool normal = strcmp(word, "vn") == 0;
	double place[3];
	if (!normal && strcmp(word, "v") != 0)
		return GZ_OK;
	if (!gz_mesh_next_place(&reader->words, place))
		return refuse_obj(reader, "no three numbers up to 1e18");
	if (normal && !gz_normalise3(place))
		memset(place, 0, sizeof place);
	float *to = normal ? reader->normals[reader->past.normals++]
			   : reader->mesh.positions[reader->past.vertices++];
	for (int axis = 0; axis < 3; axis++)
		to[axis] = (float)place[axis];
	return GZ_OK;
}

/* The index that a number means: from 1 on, or from the last one back. `past` is how many there
 * are before the line. */
static bool find_obj_index(const char *text, size_t past, size_t all, size_t *out_index)
{
	long long number;
	if (!gz_number_parse_whole(text, &number) || number == 0)
		return false;
	if (number < 0 && (unsigned long long)-(number + 1) >= past)
		return false;
	*out_index = number < 0 ? past - (size_t) - (number + 1) - 1 : (size_t)number - 1;
	return *out_index < all;
}

/* Read a corner such as 7, 7/2, 7//3 or 7/2/3, and add its normal to the vertex. */
static enum gz_result take_obj_corner(struct obj_reader *reader, char *word, uint32_t *out_vertex)
{
	char *texture = strchr(word, '/'), *normal = texture ? strchr(texture + 1, '/') : NULL;
	size_t vertex, which;
	if (texture)
		*texture = '\0';
	if (!find_obj_index(word, reader->past.vertices, reader->all.vertices, &vertex))
		return refuse_obj(reader, "a corner that is not a vertex");
	*out_vertex = (uint32_t)vertex;
	if (!normal)
		return GZ_OK;
	if (!find_obj_index(normal + 1, reader->past.normals, reader->all.normals, &which))
		return refuse_obj(reader, "a corner whose normal is not there");
	for (int axis = 0; axis < 3; axis++)
		reader->mesh.normals[vertex][axis] += reader->normals[which][axis];
	return GZ_OK;
}

static enum gz_result take_obj_face(struct obj_reader *reader, const char *word)
{
	char corner[GZ_MESH_WORD_SIZE];
	uint32_t triangle[3] = { 0 };
	reader->past.vertices += strcmp(word, "v") == 0;
	reader->past.normals += strcmp(word, "vn") == 0;
	if (strcmp(word, "f") != 0)
		return GZ_OK;
	for (size_t i = 0; gz_mesh_next_word(&reader->words, corner); i++) {
		const enum gz_result result =
			take_obj_corner(reader, corner, &triangle[i < 2 ? i : 2]);
		if (result != GZ_OK)
			return result;
		if (i < 2)
			continue;
		memcpy(reader->mesh.triangles[reader->past.triangles++], triangle, sizeof triangle);
		triangle[1] = triangle[2];
	}
	return GZ_OK;
}

/* Make the sums of normals as long as normals are. */
static void scale_normals(struct gz_mesh *mesh)
{
	for (size_t v = 0; v < mesh->vertex_count; v++) {
		double n[3] = { 0 };
		for (int axis = 0; axis < 3; axis++)
			n[axis] = (double)mesh->normals[v][axis];
		if (!gz_normalise3(n))
			memset(n, 0, sizeof n);
		for (int axis = 0; axis < 3; axis++)
			mesh->normals[v][axis] = (float)n[axis];
	}
}

static enum gz_result read_obj(struct obj_reader *reader)
{
	enum gz_result result = pass_over_obj(reader, count_obj_line);
	const struct obj_counts *all = &reader->all;
	if (result == GZ_OK && all->vertices == 0)
		result = refuse_obj(reader, "no line begins with v");
	if (result == GZ_OK)
		result = gz_mesh_take(reader->name, all->vertices, all->triangles, reader->log,
				      &reader->mesh);
	if (result != GZ_OK)
		return result;
	memset(reader->mesh.normals, 0, all->vertices * sizeof reader->mesh.normals[0]);
	reader->normals = calloc(all->normals + 1, sizeof *reader->normals);
	if (!reader->normals) {
		gz_err(reader->log, "%s: no memory for %zu normals", reader->name, all->normals);
		return GZ_ERR_NO_MEM;
	}
	result = pass_over_obj(reader, take_obj_place);
	if (result == GZ_OK)
		result = pass_over_obj(reader, take_obj_face);
	scale_normals(&reader->mesh);
	return result == GZ_OK ? gz_mesh_fill_normals(reader->name, reader->log, &reader->mesh)
			       : result;
}

enum gz_result gz_mesh_parse_obj(const char *name, const void *bytes, size_t size,
				 const struct gz_log *log, struct gz_mesh *out_mesh)
{
	struct obj_reader reader = {
		.name = name,
		.log = log,
		.bytes = size > 0 ? bytes : "",
		.size = size,
	};
	const enum gz_result result = read_obj(&reader);
	free(reader.normals);
	if (result == GZ_OK)
		*out_mesh = reader.mesh;
	else
		gz_mesh_free(&reader.mesh);
	return result;
}
