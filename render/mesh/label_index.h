/**
 * @file
 * The numbers of a label volume, counted: which labels it has, and each voxel's place among them.
 */
#ifndef GZ_RENDER_MESH_LABEL_INDEX_H
#define GZ_RENDER_MESH_LABEL_INDEX_H

#include <stddef.h>
#include <stdint.h>

#include "base/log.h"
#include "base/result.h"
#include "base/workers.h"
#include "render/data/volume.h"

/** Most labels of a volume. Chosen: pictures show 1024 objects, of which some are left to others;
 *  atlases of the brain have some hundred regions. */
#define GZ_LABELS_MAX 960

/** Labels of a volume. Zero-initialised is empty. */
struct gz_label_index {
	int dims[3];      /**< of the volume */
	size_t count;     /**< labels but 0, which is no label; at most GZ_LABELS_MAX */
	int32_t *numbers; /**< of each, rising; count */
	uint64_t *voxels; /**< that each has; count */
	/** Of each voxel 1 + its place in numbers, or 0, with a layer of 0 on all sides: dims + 2
	 *  along each axis, x fastest. */
	uint16_t *labels;
};

/**
 * Count the labels of a volume.
 *
 * @param name     the volume's in messages
 * @param workers  share the work; NULL for the calling thread alone
 * @param[out] out_index  written on GZ_OK; the caller frees it with gz_label_index_free()
 * @retval GZ_ERR_FORMAT       a value is no whole number within 32 bits, or the volume has colours;
 *                             logged
 * @retval GZ_ERR_UNSUPPORTED  the volume is stored in bricks; logged
 * @retval GZ_ERR_FULL         more than GZ_LABELS_MAX labels; logged
 * @retval GZ_ERR_NO_MEM       logged
 */
enum gz_result gz_label_index_make(const struct gz_volume *volume, const char *name,
				   struct gz_workers *workers, const struct gz_log *log,
				   struct gz_label_index *out_index);

/** Free what it holds and zero it. */
void gz_label_index_free(struct gz_label_index *index);

/** gz_workers_run(); without workers the calling thread does all parts as worker 0. */
void gz_label_run(struct gz_workers *workers, gz_workers_part *part, void *user, size_t parts);

#endif
