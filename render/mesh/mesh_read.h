/**
 * @file
 * Reading meshes from files of other programs.
 */
#ifndef GZ_RENDER_MESH_MESH_READ_H
#define GZ_RENDER_MESH_MESH_READ_H

#include <stdbool.h>
#include <stddef.h>

#include "base/log.h"
#include "base/result.h"
#include "render/mesh/mesh.h"

/** Greatest magnitude of a coordinate in a file. Chosen: no body is a light year of millimetres
 *  large, and differences of such numbers are finite in single precision. */
#define GZ_MESH_COORDINATE_MAX 1e18

/**
 * Read a mesh; the ending of the name chooses the format. Polygons are cut into fans of triangles,
 * and faces of fewer than three corners are skipped. Vertices without a normal of some length get
 * the mean of their triangles' by area.
 *
 *  - .ply: text, or binary of either byte order (Turk, "The PLY polygon file format", 1994). It
 *    needs an element `vertex` with x, y and z of any number type, and an element `face` with a
 * list `vertex_indices` or `vertex_index`. Further properties and elements are skipped
 *  - .obj: v, vn and f; numbers of vertices from 1, or from the last one back. The normal of a
 *    vertex is the mean of those that its faces name. Other lines are skipped
 *  - .stl: binary or text. Corners at one place become one vertex; normals are made from triangles
 *
 * Positions are taken as they are written, in mm, in the frame of struct gz_mesh.
 *
 * @param[out] out_mesh  written on GZ_OK; the caller frees it with gz_mesh_free(). May have no
 *                       triangles
 * @retval GZ_ERR_NOT_FOUND    no such file; logged, as the others
 * @retval GZ_ERR_IO           the file cannot be read
 * @retval GZ_ERR_UNSUPPORTED  the name has another ending
 * @retval GZ_ERR_FORMAT       another content, cut off, or a number that is out of range
 * @retval GZ_ERR_FULL         more than GZ_MESH_COUNT_MAX vertices or triangles
 * @retval GZ_ERR_NO_MEM       out of memory
 */
enum gz_result gz_mesh_read(const char *path, const struct gz_log *log, struct gz_mesh *out_mesh);

/** gz_mesh_read() of @p size bytes in memory. @param name  their source in messages */
typedef enum gz_result gz_mesh_parser(const char *name, const void *bytes, size_t size,
				      const struct gz_log *log, struct gz_mesh *out_mesh);

/** One parser a format: see gz_mesh_parser. */
gz_mesh_parser gz_mesh_parse_ply, gz_mesh_parse_obj, gz_mesh_parse_stl;

/** Whether a file is a PLY with faces, by its name and its header; one without them has points.
 * Logs nothing. */
bool gz_mesh_has_faces(const char *path);

/** Move a mesh so that a point becomes the origin, mm. */
void gz_mesh_move(struct gz_mesh *mesh, const double origin[3]);

/** Widen a box by the vertices of a mesh, mm. Start with INFINITY and -INFINITY. */
void gz_mesh_bound(const struct gz_mesh *mesh, double least[3], double greatest[3]);

#endif
