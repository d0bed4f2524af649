/**
 * @file
 * Writing meshes to files that other programs read.
 */
#ifndef GZ_RENDER_MESH_MESH_FILE_H
#define GZ_RENDER_MESH_MESH_FILE_H

#include <stdbool.h>

#include "base/log.h"
#include "base/result.h"
#include "render/mesh/mesh.h"

/** The endings of the formats, for messages and help: ".ply, .obj or .stl". */
#define GZ_MESH_ENDINGS ".ply, .obj or .stl"

/** Whether the ending of @p path is that of a format; case does not matter. */
bool gz_mesh_file_named(const char *path);

/**
 * Write a mesh; the ending of the name chooses the format. Positions are written as they are: in
 * mm, in the frame of struct gz_mesh. No format can state a unit; the comments of PLY and OBJ name
 * it.
 *
 *  - .ply: binary, little-endian: positions and normals as float, triangles as lists of int
 *  - .obj: text: v, vn and f; numbers read back as the same floats
 *  - .stl: binary: each triangle with its own corners and the normal of its plane, 0 if it has no
 *    area; vertices are not shared and their normals are lost
 *
 * The file takes its name when it is complete; until then it is called @p path with
 * GZ_PART_ENDING, and after an error nothing is left and an older file is kept. A device or pipe is
 * written to directly.
 *
 * @retval GZ_ERR_UNSUPPORTED  another ending; logged
 * @retval GZ_ERR_FULL         no space is left; logged
 * @retval GZ_ERR_IO           the file cannot be written; logged
 */
enum gz_result gz_mesh_write(const struct gz_mesh *mesh, const char *path,
			     const struct gz_log *log);

/** One of several meshes of a file. */
struct gz_mesh_part {
	const struct gz_mesh *mesh; /**< borrowed */
	int32_t label;              /**< a number that tells the parts apart */
	float colour[3];            /**< red, green and blue, [0, 1] */
};

/**
 * Write several meshes to one file, one after the other; each keeps its own vertices. As
 * gz_mesh_write(), and besides:
 *
 *  - .ply: each vertex has the colour of its part (uchar red, green, blue), each face its label
 *    (int label)
 *  - .obj: each part is an object "label_N"
 *  - .stl: labels and colours are lost
 *
 * @retval GZ_ERR_FULL  no space is left, or more than GZ_MESH_COUNT_MAX vertices or triangles;
 *                      logged
 * @return otherwise as gz_mesh_write()
 */
enum gz_result gz_mesh_write_parts(const struct gz_mesh_part *parts, size_t count, const char *path,
				   const struct gz_log *log);

#endif
