/**
 * @file
 * The surfaces of labels: one closed mesh for each label of a volume, which neighbours share
 * without gaps.
 *
 * Surface nets (Gibson, "Constrained elastic surface nets: generating smooth surfaces from binary
 * segmented data", MICCAI 1998): each corner of voxels at which labels meet has one vertex, and
 * each face between two voxels of different labels has two triangles. Both labels have these
 * triangles, with opposite orientation, and all vertices are shared, so whatever moves them leaves
 * no gap. What lies outside of the volume is no label, so every surface is closed.
 *
 * A vertex begins at the mean of the middles of those edges between the eight voxel centres round
 * it whose ends differ. Then all are smoothed by a filter that removes short waves and keeps long
 * ones, and with them volumes (Taubin, Zhang and Golub, "Optimal surface smoothing as filter
 * design", ECCV 1996): a polynomial in the step from each vertex to the mean of its neighbours
 * along edges. The more steps, the longer the waves that it removes. On a border, a curve along
 * which three or more labels meet, only neighbours along the border count: drawn by all surfaces
 * that meet there, it would keep teeth. No vertex ends farther from its corner of voxels than the
 * reach along an axis. On the sides of the volume's box vertices move within them.
 *
 * Where voxels of one label touch along an edge or at a corner only, its surface touches itself
 * there. The same meshes, bits and order, for any number of threads.
 */
#ifndef GZ_RENDER_MESH_LABEL_SURFACES_H
#define GZ_RENDER_MESH_LABEL_SURFACES_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/log.h"
#include "base/option.h"
#include "base/result.h"
#include "base/workers.h"
#include "render/data/volume.h"
#include "render/mesh/label_index.h"
#include "render/mesh/label_names.h"
#include "render/mesh/mesh.h"

/** Most pairs of smoothing steps. Chosen: up to these a ball of 36 voxels keeps its volume within
 * half a hundredth. */
#define GZ_LABEL_SMOOTHING_MAX 60

/** Farthest reach, voxels. Chosen: steps of atlases that were drawn on a coarser grid are two to
 * four voxels high. */
#define GZ_LABEL_REACH_MAX 4

/** How surfaces of labels are made. */
struct gz_label_look {
	int smoothing;            /**< pairs of smoothing steps; 0 = stairs with blunt edges */
	double reach;             /**< how far smoothing moves a vertex along an axis, voxels */
	char names[GZ_PATH_SIZE]; /**< file of names and colours; empty: one beside the volume */
};

/** Whether two are the same. */
bool gz_label_look_same(const struct gz_label_look *a, const struct gz_label_look *b);

/** Table over struct gz_label_look: "labels.…". */
extern const struct gz_option gz_label_options[];
extern const size_t gz_label_option_count;

/** The surface of one label. */
struct gz_label_surface {
	int32_t number;                /**< of the label, as in the volume */
	uint64_t voxels;               /**< that it has */
	float colour[3];               /**< of the names, else gz_label_colour() */
	char name[GZ_LABEL_NAME_SIZE]; /**< empty: none is known */
	/** Triangles that face no label come first; the others are its shared ones. */
	struct gz_mesh mesh;
};

/** All labels of a volume. Zero-initialised is empty. */
struct gz_label_surfaces {
	size_t count;
	struct gz_label_surface *items; /**< by rising numbers */
};

/** What surfaces of labels are made of. All pointers are borrowed. */
struct gz_label_request {
	const struct gz_volume *volume;
	const char *name;                   /**< the volume's in messages */
	const struct gz_label_look *look;   /**< its names are not read */
	const struct gz_label_names *names; /**< NULL: none */
	/** Most vertices and faces of all labels, and most triangles of one; 0 or more than
	 *  GZ_MESH_COUNT_MAX: that many. */
	uint64_t elements_max;
};

/**
 * Make the surfaces of all labels but 0.
 *
 * @param workers  share the work; NULL for the calling thread alone
 * @param[out] out_surfaces  written on GZ_OK; the caller frees it with gz_label_surfaces_free()
 * @retval GZ_ERR_FULL    more than elements_max of them; logged
 * @retval GZ_ERR_NO_MEM  logged
 * @return otherwise the failures of gz_label_index_make(); logged
 *
 * Memory besides the meshes: 2 bytes for each voxel, 60 for each vertex and 4 for each thread and
 * vertex, 28 for each face between labels.
 */
enum gz_result gz_label_surfaces_make(const struct gz_label_request *request,
				      struct gz_workers *workers, const struct gz_log *log,
				      struct gz_label_surfaces *out_surfaces);

/**
 * The colour of a label, the same in every volume: hues a golden section of the circle apart, in
 * turn bright, dark and pale, so that labels of near numbers are told apart.
 *
 * @param[out] out_rgb  0.15 to 1 each
 */
void gz_label_colour(int32_t number, float out_rgb[3]);

/** Free what it holds and zero it. */
void gz_label_surfaces_free(struct gz_label_surfaces *surfaces);

#endif
