/**
 * @file
 * The surfaces of a scene as meshes to be written: for --write-mesh and for the window.
 */
#ifndef GZ_VIEW_CAPTURE_MESH_OUTPUT_H
#define GZ_VIEW_CAPTURE_MESH_OUTPUT_H

#include <stddef.h>

#include "base/log.h"
#include "base/result.h"
#include "render/data/volume.h"
#include "render/mesh/mesh.h"
#include "render/mesh/mesh_file.h"
#include "render/scene/scene.h"

/**
 * Make the surface of a volume on threads of its own. Any thread may call it.
 *
 * @param isovalue  data value: slope and intercept applied
 * @param threads   1 to 256; 0: one for each processor
 * @param[out] out_mesh  the caller frees it with gz_mesh_free()
 * @return what gz_isosurface_make() returns; logged
 */
enum gz_result gz_mesh_output_make(const struct gz_volume *volume, double isovalue, int threads,
				   const struct gz_log *log, struct gz_mesh *out_mesh);

/**
 * List the labels of all objects of a scene, as gz_mesh_write_parts() takes them.
 *
 * @param scene  the meshes are borrowed from it
 * @param[out] out_parts  the caller frees it with free()
 * @param[out] out_count  of them; 0: the scene has no labels
 * @retval GZ_ERR_NO_MEM  logged
 */
enum gz_result gz_mesh_output_parts(const struct gz_scene *scene, const struct gz_log *log,
				    struct gz_mesh_part **out_parts, size_t *out_count);

#endif
