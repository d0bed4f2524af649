/**
 * @file
 * What readers of mesh files share. Within this room.
 */
#ifndef GZ_RENDER_MESH_MESH_PARSE_H
#define GZ_RENDER_MESH_MESH_PARSE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/log.h"
#include "base/result.h"
#include "render/mesh/mesh.h"

/** Most bytes of a word that is looked at, with a NUL. Chosen: a double needs 24. */
#define GZ_MESH_WORD_SIZE 64

/** The words of a text, line by line. A backslash at a line's end joins it with the next. */
struct gz_mesh_words {
	const char *at, *end;
	size_t line; /**< from 1 */
};

/** Take the next word of the line, cut to the room; false at the line's end. */
bool gz_mesh_next_word(struct gz_mesh_words *words, char out_word[GZ_MESH_WORD_SIZE]);

/** Take three numbers of the line, each of magnitude up to GZ_MESH_COORDINATE_MAX; false if there
 *  are not. */
bool gz_mesh_next_place(struct gz_mesh_words *words, double out_place[3]);

/** Pass over the rest of the line; false if no line follows. */
bool gz_mesh_next_line(struct gz_mesh_words *words);

/** gz_mesh_allocate(), whose failures are logged. @param name  the file in messages */
enum gz_result gz_mesh_take(const char *name, uint64_t vertices, uint64_t triangles,
			    const struct gz_log *log, struct gz_mesh *out_mesh);

/** Give the vertices whose normal is 0 0 0 the mean of their triangles' by area; 0 0 1 if they have
 *  none. @retval GZ_ERR_NO_MEM  logged */
enum gz_result gz_mesh_fill_normals(const char *name, const struct gz_log *log,
				    struct gz_mesh *mesh);

/** Whether a file is a PLY whose header has faces. Logs nothing. */
bool gz_mesh_ply_has_faces(const char *path);

#endif
