/**
 * @file
 * Pictures that hold the scene they show: PNG files with the scene, the transfer function and a
 * mark of the data as texts, keywords "gazecast.scene", "gazecast.transfer" and "gazecast.volume".
 */
#ifndef GZ_RENDER_SCENE_SCENE_PICTURE_H
#define GZ_RENDER_SCENE_SCENE_PICTURE_H

#include "base/log.h"
#include "base/result.h"
#include "render/picture/image.h"
#include "render/scene/scene.h"
#include "render/scene/scene_write.h"

/** Bytes of a mark with its NUL. */
#define GZ_VOLUME_MARK_SIZE 192

/** What a picture tells of the scene that it shows. */
struct gz_scene_picture {
	struct gz_scene_settings settings; /**< names of files are absolute */
	bool has_display;
	bool has_transfer;
	struct gz_transfer transfer;    /**< as it was, whatever its file has become */
	char mark[GZ_VOLUME_MARK_SIZE]; /**< of the data; empty: not told */
};

/**
 * Describe a volume's data in one line, so that other data are told from it: dims, type, range and
 * checksum of gz_volume_identify(). Of bricks in a file no voxel counts.
 */
void gz_volume_mark(const struct gz_volume *volume, char out_mark[GZ_VOLUME_MARK_SIZE]);

/**
 * Write a picture with its scene as gz_image_write_png() writes one without. Where the scene cannot
 * be put into words the picture is written without, with a warning.
 *
 * @param saved     the scene
 * @param transfer  in use; NULL: no matter
 * @param volume    in use; NULL: no matter
 * @return what gz_image_write_png() returns
 */
enum gz_result gz_scene_picture_write(const struct gz_image *image,
				      const struct gz_scene_saved *saved,
				      const struct gz_transfer *transfer,
				      const struct gz_volume *volume, const char *path,
				      const struct gz_log *log);

/**
 * Read what a picture tells of its scene.
 *
 * @retval GZ_ERR_NOT_FOUND  no such file, or a PNG without a scene; logged, as the others
 * @retval GZ_ERR_FORMAT     no PNG, damaged, or its scene is refused
 * @retval GZ_ERR_IO, GZ_ERR_NO_MEM
 */
enum gz_result gz_scene_picture_read(const char *path, const struct gz_log *log,
				     struct gz_scene_picture *out_picture);

/** Warn where a volume is not the one that a picture was made of. @return whether it is, as far as
 *  the picture tells */
bool gz_scene_picture_check(const struct gz_scene_picture *picture, const struct gz_volume *volume,
			    const char *path, const struct gz_log *log);

#endif
