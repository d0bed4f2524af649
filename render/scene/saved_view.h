/**
 * @file
 * A camera as a line of text, for views that somebody comes back to: keys "views.1" to "views.8" of
 * a scene.
 *
 *     eye 0 -2 0.5 look_at 0 0 0 up 0 0 1 fov_deg 40
 *     eye 0 -2 0.5 look_at 0 0 0 up 0 0 1 height 1.5
 *
 * The words are those of section "camera"; the last says whether it is perspective or orthographic.
 */
#ifndef GZ_RENDER_SCENE_SAVED_VIEW_H
#define GZ_RENDER_SCENE_SAVED_VIEW_H

#include "base/log.h"
#include "base/result.h"
#include "render/picture/camera.h"

/** Views of a scene. */
#define GZ_SAVED_VIEWS 8

/** Room for any view with its end: ten numbers of up to 24 characters, and words. */
#define GZ_SAVED_VIEW_SIZE 320

/** Print a camera so that it is read back to the same bits, by numbers as short as that allows. */
void gz_saved_view_print(const struct gz_camera *camera, char out_text[GZ_SAVED_VIEW_SIZE]);

/**
 * Read a camera.
 *
 * @param[in,out] camera  becomes it; the one of fov_deg and height that the text does not give
 *                        stays. As it was on failure
 * @retval GZ_ERR_FORMAT  another form, or a camera that sees nothing (gz_camera_rays())
 */
enum gz_result gz_saved_view_parse(const char *text, struct gz_camera *camera);

/**
 * Check views that are given: texts that are not empty.
 *
 * @param name  stands for where they come from in messages
 * @param log   may be NULL
 * @retval GZ_ERR_FORMAT  one is none; logged with its key and the form
 */
enum gz_result gz_saved_views_check(const char views[GZ_SAVED_VIEWS][GZ_SAVED_VIEW_SIZE],
				    const char *name, const struct gz_log *log);

#endif
