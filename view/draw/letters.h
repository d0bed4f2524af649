/**
 * @file
 * Letters at the picture's edges that tell which side of a patient is there: R L A P S I, by the
 * camera's axes in the world of an oriented volume (x right, y front, z up). An oblique direction
 * has several, the strongest first, as DICOM's Patient Orientation (PS3.3, C.7.6.1.1.1) writes them
 * with F and H for I and S.
 */
#ifndef GZ_VIEW_DRAW_LETTERS_H
#define GZ_VIEW_DRAW_LETTERS_H

#include "base/result.h"
#include "render/picture/camera.h"
#include "render/picture/image.h"

#ifdef __cplusplus
extern "C" {
#endif

/** Bytes of a direction's letters with their NUL. */
#define GZ_LETTERS_SIZE 4

/**
 * The letters of a direction.
 *
 * @param direction  world units, any length but 0; an axis counts from 20 degrees towards it on
 * (chosen: less is a tilt, not a side)
 * @param[out] out_letters  one to three of them; empty where @p direction is no direction
 */
void gz_letters_of(const double direction[3], char out_letters[GZ_LETTERS_SIZE]);

/** What the picture's four edges show. */
struct gz_letters {
	char left[GZ_LETTERS_SIZE], right[GZ_LETTERS_SIZE];
	char top[GZ_LETTERS_SIZE], bottom[GZ_LETTERS_SIZE];
};

/** The letters of a camera. @return what gz_camera_rays() returns. */
enum gz_result gz_letters_of_camera(const struct gz_camera *camera, struct gz_letters *out_letters);

/** Draw them light in dark, in a size that goes with the picture's. What has no room is left out.
 */
void gz_letters_draw(const struct gz_letters *letters, struct gz_image *image);

#ifdef __cplusplus
}
#endif

#endif
