/**
 * @file
 * The scenes that come with gazeview: those of the folder scenes, and those of its folder fetched,
 * whose data people fetch themselves.
 */
#ifndef GZ_VIEW_FILES_SHIPPED_SCENES_H
#define GZ_VIEW_FILES_SHIPPED_SCENES_H

#include <stddef.h>

#include "base/result.h"
#include "protocol/gaze.h"

/** Most scenes that are listed; further ones are left out. */
#define GZ_SHIPPED_SCENES_MAX 32

/** A scene. */
struct gz_shipped_scene {
	char name[64];              /**< "head" */
	char path[GZ_PATH_SIZE];    /**< absolute */
	char picture[GZ_PATH_SIZE]; /**< of a small picture of it, a PNG file; it may be absent */
};

/** A list. Zero-initialised: empty. */
struct gz_shipped_scenes {
	struct gz_shipped_scene items[GZ_SHIPPED_SCENES_MAX];
	size_t count;
	size_t without_data; /**< scenes that are left out, as their data are not there */
};

/**
 * List the scenes whose data are there: those of the folder itself first, each by name.
 *
 * @param[out] out_scenes  always filled; empty if no scenes are installed
 * @retval GZ_ERR_NOT_FOUND  no scenes are installed
 * @retval GZ_ERR_NO_MEM     out of memory
 */
enum gz_result gz_shipped_scenes_read(struct gz_shipped_scenes *out_scenes);

/** A scene of the list by its name; NULL: it is not in it. */
const struct gz_shipped_scene *gz_shipped_scenes_find(const struct gz_shipped_scenes *scenes,
						      const char *name);

#endif
