/**
 * @file
 * Where the camera goes: one camera a frame, from a table of numbers or a session of gazeview.
 *
 * A table has a camera a line: eye x y z and look_at x y z, then, if they differ from the first
 * camera's, up x y z and fov_deg; 6, 9 or 10 numbers, separated by commas or blanks. The first line
 * may be words; empty lines and what follows # are left out. Of the file frames.tsv of a session
 * (docs/sessions.md) each frame is one camera.
 */
#ifndef GZ_BENCH_STUDY_CAMERA_PATH_H
#define GZ_BENCH_STUDY_CAMERA_PATH_H

#include <stddef.h>

#include "base/log.h"
#include "base/result.h"
#include "render/picture/camera.h"

/** Most cameras of a path. Chosen: half an hour at 60 frames a second. */
#define GZ_CAMERA_PATH_MAX 108000

/** A path. Zero-initialised is empty. */
struct gz_camera_path {
	struct gz_camera *cameras;
	size_t count, capacity;
};

/**
 * Read a path.
 *
 * @param first          what a line does not name is taken from it; valid
 * @param[out] out_path  1 to GZ_CAMERA_PATH_MAX cameras, all valid; the caller's:
 *                       gz_camera_path_free()
 * @retval GZ_ERR_FORMAT     a line is no camera, or there is none; logged with the line
 * @retval GZ_ERR_NOT_FOUND, GZ_ERR_IO, GZ_ERR_NO_MEM  logged
 */
enum gz_result gz_camera_path_read(const char *path, const struct gz_camera *first,
				   const struct gz_log *log, struct gz_camera_path *out_path);

struct gz_hash;

/** Add all its cameras to a hash (hash.h). */
void gz_camera_path_hash(const struct gz_camera_path *path, struct gz_hash *hash);

/** Free what it holds and zero it. */
void gz_camera_path_free(struct gz_camera_path *path);

#endif
