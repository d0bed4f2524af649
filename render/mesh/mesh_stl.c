/* STL: triangles, each with its own corners, as binary (a head of 80 bytes, their number, then 50
 * bytes each) or as text. 3D Systems, "Stereolithography interface specification", 1989. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "render/mesh/mesh_parse.h"
#include "render/mesh/mesh_read.h"

#define GZ_LOG_MODULE "mesh"

enum { HEAD_BYTES = 84, COUNT_AT = 80, TRIANGLE_BYTES = 50, NORMAL_BYTES = 12 };

/* An STL file while it is read. */
struct stl_reader {
	const char *name;
	const struct gz_log *log;
	const unsigned char *bytes;
	size_t size;
	float (*corners)[3]; /* of all triangles, in turn */
	size_t corner_count; /* so far */
	/* Numbers of vertices + 1, by their places; 0: free. */
	uint32_t *slots;
	size_t slot_mask;
};

static enum gz_result refuse_stl(const struct stl_reader *reader, const char *what, size_t item)
{
	gz_err(reader->log, "%s: %s %zu; write the mesh again as STL", reader->name, what, item);
	return GZ_ERR_FORMAT;
}

static uint32_t little_word(const unsigned char *bytes)
{
	return (uint32_t)bytes[0] | (uint32_t)bytes[1] << 8 | (uint32_t)bytes[2] << 16 |
	       (uint32_t)bytes[3] << 24;
}

/* Text begins with "solid", but so do the heads of some binary files, which have zero bytes. */
static bool is_binary_stl(const struct stl_reader *reader)
{
	return reader->size < 5 || memcmp(reader->bytes, "solid", 5) != 0 ||
	       memchr(reader->bytes, 0, reader->size);
}

static enum gz_result take_corners(struct stl_reader *reader, size_t count)
{
	reader->corners = calloc(count + 1, sizeof *reader->corners);
	if (reader->corners)
		return GZ_OK;
	gz_err(reader->log, "%s: no memory for %zu corners", reader->name, count);
	return GZ_ERR_NO_MEM;
}

static enum gz_result read_binary_stl(struct stl_reader *reader)
{
	if (reader->size < HEAD_BYTES)
		return refuse_stl(reader, "neither begins with solid nor has the bytes of a head:",
				  HEAD_BYTES);
	const size_t count = little_word(reader->bytes + COUNT_AT);
	if ((reader->size - HEAD_BYTES) / TRIANGLE_BYTES < count)
		return refuse_stl(reader, "cut off: its head claims triangles:", count);
	const enum gz_result result = take_corners(reader, 3 * count);
	if (result != GZ_OK)
		return result;
	for (size_t i = 0; i < 9 * count; i++) {
		const unsigned char *triangle = reader->bytes + HEAD_BYTES + i / 9 * TRIANGLE_BYTES;
		const uint32_t bits = little_word(triangle + NORMAL_BYTES + i % 9 * 4);
		float value;
		memcpy(&value, &bits, sizeof value);
		if (!(fabsf(value) <= (float)GZ_MESH_COORDINATE_MAX))
			return refuse_stl(reader, "coordinates beyond 1e18 in triangle", i / 9);
		reader->corners[i / 3][i % 3] = value;
	}
	reader->corner_count = 3 * count;
	return GZ_OK;
}

/* Take a line of text, by its first word. `in_facet` counts the corners of the present one. */
static enum gz_result take_stl_line(struct stl_reader *reader, struct gz_mesh_words *words,
				    const char *word, size_t *in_facet)
{
	double place[3];
	if (strcmp(word, "endfacet") == 0) {
		if (*in_facet != 3)
			return refuse_stl(reader, "no three corners in the facet before line",
					  words->line);
		*in_facet = 0;
		return GZ_OK;
	}
	if (strcmp(word, "vertex") != 0)
		return GZ_OK;
	if (!gz_mesh_next_place(words, place))
		return refuse_stl(reader, "no three numbers up to 1e18 in line", words->line);
	for (int axis = 0; axis < 3; axis++)
		reader->corners[reader->corner_count][axis] = (float)place[axis];
	reader->corner_count++;
	++*in_facet;
	return GZ_OK;
}

/* Go through the lines of a text. Without corners, only count the vertices. */
static enum gz_result pass_over_stl(struct stl_reader *reader, size_t *out_vertices)
{
	const char *text = (const char *)reader->bytes;
	struct gz_mesh_words words = { text, text + reader->size, 1 };
	char word[GZ_MESH_WORD_SIZE];
	enum gz_result result = GZ_OK;
	size_t in_facet = 0;
	*out_vertices = 0;
	do {
		if (!gz_mesh_next_word(&words, word))
			continue;
		*out_vertices += strcmp(word, "vertex") == 0;
		if (reader->corners)
			result = take_stl_line(reader, &words, word, &in_facet);
	} while (result == GZ_OK && gz_mesh_next_line(&words));
	if (result == GZ_OK && in_facet != 0)
		return refuse_stl(reader, "cut off in line", words.line);
	return result;
}

static enum gz_result read_text_stl(struct stl_reader *reader)
{
	size_t vertices;
	enum gz_result result = pass_over_stl(reader, &vertices);
	if (result == GZ_OK)
		result = take_corners(reader, vertices);
	return result == GZ_OK ? pass_over_stl(reader, &vertices) : result;
}

/* A slot to begin the search for a place at: multiplication by the golden ratio's fraction. */
static size_t first_slot(const struct stl_reader *reader, const float place[3])
{
	uint64_t hash = 0;
	for (int axis = 0; axis < 3; axis++) {
		uint32_t bits;
		memcpy(&bits, &place[axis], sizeof bits);
		hash = (hash ^ bits) * UINT64_C(0x9E3779B97F4A7C15);
		hash ^= hash >> 32;
	}
	return (size_t)hash & reader->slot_mask;
}

/* The number of the vertex at a corner's place. The first `vertices` corners are the vertices so
 * far; a new one joins them. */
static uint32_t join_corner(struct stl_reader *reader, size_t corner, size_t *vertices)
{
	float place[3];
	for (int axis = 0; axis < 3; axis++)
		place[axis] = reader->corners[corner][axis] + 0.0F; /* -0 is 0 */
	size_t slot = first_slot(reader, place);
	for (; reader->slots[slot] != 0; slot = (slot + 1) & reader->slot_mask) {
		const uint32_t vertex = reader->slots[slot] - 1;
		if (memcmp(reader->corners[vertex], place, sizeof place) == 0)
			return vertex;
	}
	memcpy(reader->corners[*vertices], place, sizeof place);
	reader->slots[slot] = (uint32_t)++ * vertices;
	return (uint32_t)*vertices - 1;
}

/* Make one vertex of the corners at each place. */
static enum gz_result join_corners(struct stl_reader *reader, struct gz_mesh *out_mesh)
{
	const size_t count = reader->corner_count;
	struct gz_mesh triangles = { 0 };
	size_t slots = 16, vertices = 0;
	while (slots < 2 * count)
		slots *= 2;
	enum gz_result result = gz_mesh_take(reader->name, 0, count / 3, reader->log, &triangles);
	if (result != GZ_OK)
		return result;
	reader->slot_mask = slots - 1;
	reader->slots = calloc(slots, sizeof *reader->slots);
	if (!reader->slots) {
		gz_err(reader->log, "%s: no memory to join %zu corners", reader->name, count);
		gz_mesh_free(&triangles);
		return GZ_ERR_NO_MEM;
	}
	for (size_t i = 0; i < count; i++)
		triangles.triangles[i / 3][i % 3] = join_corner(reader, i, &vertices);
	result = gz_mesh_take(reader->name, vertices, count / 3, reader->log, out_mesh);
	if (result == GZ_OK && count > 0) {
		memcpy(out_mesh->positions, reader->corners,
		       vertices * sizeof out_mesh->positions[0]);
		memset(out_mesh->normals, 0, vertices * sizeof out_mesh->normals[0]);
		memcpy(out_mesh->triangles, triangles.triangles,
		       count / 3 * sizeof out_mesh->triangles[0]);
	}
	gz_mesh_free(&triangles);
	return result;
}

static enum gz_result read_stl(struct stl_reader *reader, struct gz_mesh *out_mesh)
{
	enum gz_result result =
		is_binary_stl(reader) ? read_binary_stl(reader) : read_text_stl(reader);
	if (result == GZ_OK && reader->corner_count > GZ_MESH_COUNT_MAX) {
		gz_err(reader->log, "%s: more than %d corners; make the mesh coarser", reader->name,
		       GZ_MESH_COUNT_MAX);
		result = GZ_ERR_FULL;
	}
	struct gz_mesh mesh = { 0 };
	if (result == GZ_OK)
		result = join_corners(reader, &mesh);
	if (result == GZ_OK)
		result = gz_mesh_fill_normals(reader->name, reader->log, &mesh);
	if (result == GZ_OK)
		*out_mesh = mesh;
	else
		gz_mesh_free(&mesh);
	return result;
}

enum gz_result gz_mesh_parse_stl(const char *name, const void *bytes, size_t size,
				 const struct gz_log *log, struct gz_mesh *out_mesh)
{
	struct stl_reader reader = {
		.name = name,
		.log = log,
		.bytes = bytes,
		.size = size,
	};
	const enum gz_result result = read_stl(&reader, out_mesh);
	free(reader.corners);
	free(reader.slots);
	return result;
}
