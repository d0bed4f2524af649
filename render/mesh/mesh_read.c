#include "render/mesh/mesh_read.h"

#include <math.h>

#include "base/file.h"
#include "base/text.h"
#include "render/mesh/mesh_file.h"
#include "render/mesh/mesh_parse.h"

#define GZ_LOG_MODULE "mesh"

/* The formats, by the endings of names. */
static const struct {
	const char *ending;
	gz_mesh_parser *parse;
} mesh_formats[] = {
	{ ".ply", gz_mesh_parse_ply },
	{ ".obj", gz_mesh_parse_obj },
	{ ".stl", gz_mesh_parse_stl },
};

static gz_mesh_parser *mesh_parser_of(const char *path)
{
	for (size_t i = 0; i < sizeof mesh_formats / sizeof mesh_formats[0]; i++)
		if (gz_path_ends(path, mesh_formats[i].ending))
			return mesh_formats[i].parse;
	return NULL;
}

enum gz_result gz_mesh_read(const char *path, const struct gz_log *log, struct gz_mesh *out_mesh)
{
	gz_mesh_parser *parse = mesh_parser_of(path);
	struct gz_text text = { 0 };
	if (!parse) {
		gz_err(log, "%s: meshes are read from " GZ_MESH_ENDINGS " files; convert it", path);
		return GZ_ERR_UNSUPPORTED;
	}
	enum gz_result result = gz_text_add_file(&text, path);
	if (result != GZ_OK)
		gz_err(log, "%s: cannot be read: %s", path, gz_result_text(result));
	else
		result = parse(path, text.bytes ? text.bytes : "", text.length, log, out_mesh);
	gz_text_free(&text);
	return result;
}

bool gz_mesh_has_faces(const char *path)
{
	gz_mesh_parser *parse = mesh_parser_of(path);
	return parse == gz_mesh_parse_ply ? gz_mesh_ply_has_faces(path) : parse != NULL;
}

void gz_mesh_move(struct gz_mesh *mesh, const double origin[3])
{
	for (size_t v = 0; v < mesh->vertex_count; v++)
		for (int axis = 0; axis < 3; axis++)
			mesh->positions[v][axis] =
				(float)((double)mesh->positions[v][axis] - origin[axis]);
}

void gz_mesh_bound(const struct gz_mesh *mesh, double least[3], double greatest[3])
{
	for (size_t v = 0; v < mesh->vertex_count; v++)
		for (int axis = 0; axis < 3; axis++) {
			const double at = (double)mesh->positions[v][axis];
			least[axis] = fmin(least[axis], at);
			greatest[axis] = fmax(greatest[axis], at);
		}
}
