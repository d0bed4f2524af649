#include "render/mesh/mesh_parse.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/text.h"
#include "base/vector.h"
#include "render/mesh/mesh_read.h"

#define GZ_LOG_MODULE "mesh"

/* Pass over blanks and joined lines. */
static void skip_blanks(struct gz_mesh_words *words)
{
	while (words->at < words->end) {
		const size_t rest = (size_t)(words->end - words->at);
		const char *at = words->at;
		if (*at == ' ' || *at == '\t' || *at == '\r') {
			words->at++;
		} else if (rest >= 2 && at[0] == '\\' && at[1] == '\n') {
			words->at += 2;
			words->line++;
		} else if (rest >= 3 && at[0] == '\\' && at[1] == '\r' && at[2] == '\n') {
			words->at += 3;
			words->line++;
		} else {
			return;
		}
	}
}

static bool ends_word(char c)
{
	return c == ' ' || c == '\t' || c == '\r' || c == '\n';
}

bool gz_mesh_next_word(struct gz_mesh_words *words, char out_word[GZ_MESH_WORD_SIZE])
{
	size_t length = 0;
	skip_blanks(words);
	if (words->at == words->end || *words->at == '\n')
		return false;
	for (; words->at < words->end && !ends_word(*words->at); words->at++)
		if (length + 1 < GZ_MESH_WORD_SIZE)
			out_word[length++] = *words->at;
	out_word[length] = '\0';
	return true;
}

bool gz_mesh_next_place(struct gz_mesh_words *words, double out_place[3])
{
	char word[GZ_MESH_WORD_SIZE];
	for (int axis = 0; axis < 3; axis++)
		if (!gz_mesh_next_word(words, word) || !gz_number_parse(word, &out_place[axis]) ||
		    fabs(out_place[axis]) > GZ_MESH_COORDINATE_MAX)
			return false;
	return true;
}

bool gz_mesh_next_line(struct gz_mesh_words *words)
{
	const char *end = memchr(words->at, '\n', (size_t)(words->end - words->at));
	words->at = end ? end + 1 : words->end;
	words->line++;
	return words->at < words->end;
}

enum gz_result gz_mesh_take(const char *name, uint64_t vertices, uint64_t triangles,
			    const struct gz_log *log, struct gz_mesh *out_mesh)
{
	const enum gz_result result = gz_mesh_allocate(vertices, triangles, out_mesh);
	if (result == GZ_ERR_FULL)
		gz_err(log, "%s: more than %d vertices or triangles; make the mesh coarser", name,
		       GZ_MESH_COUNT_MAX);
	else if (result != GZ_OK)
		gz_err(log, "%s: no memory for %llu vertices and %llu triangles", name,
		       (unsigned long long)vertices, (unsigned long long)triangles);
	return result;
}

/* Twice the area of a triangle, as a vector along its normal. */
static void area_vector(const struct gz_mesh *mesh, const uint32_t corners[3], double out[3])
{
	double sides[2][3];
	for (int side = 0; side < 2; side++)
		for (int axis = 0; axis < 3; axis++)
			sides[side][axis] = (double)mesh->positions[corners[side + 1]][axis] -
					    (double)mesh->positions[corners[0]][axis];
	gz_cross3(sides[0], sides[1], out);
}

enum gz_result gz_mesh_fill_normals(const char *name, const struct gz_log *log,
				    struct gz_mesh *mesh)
{
	size_t missing = 0;
	for (size_t v = 0; v < mesh->vertex_count; v++) {
		const float *n = mesh->normals[v];
		missing += n[0] == 0 && n[1] == 0 && n[2] == 0;
	}
	if (missing == 0)
		return GZ_OK;
	double(*sums)[3] = calloc(mesh->vertex_count, sizeof *sums);
	if (!sums) {
		gz_err(log, "%s: no memory for normals", name);
		return GZ_ERR_NO_MEM;
	}
	for (size_t t = 0; t < mesh->triangle_count; t++) {
		double area[3];
		area_vector(mesh, mesh->triangles[t], area);
		for (int i = 0; i < 9; i++)
			sums[mesh->triangles[t][i / 3]][i % 3] += area[i % 3];
	}
	for (size_t v = 0; v < mesh->vertex_count; v++) {
		float *n = mesh->normals[v];
		if (n[0] != 0 || n[1] != 0 || n[2] != 0)
			continue;
		if (!gz_normalise3(sums[v]))
			sums[v][2] = 1; /* in no triangle with an area */
		for (int axis = 0; axis < 3; axis++)
			n[axis] = (float)sums[v][axis];
	}
	free(sums);
	return GZ_OK;
}
