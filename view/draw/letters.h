/**
 * @file
 * Letters at the picture's edges that name the side of a patient: R L A P S I, by the camera's axes
 * in the world of an oriented volume (x right, y front, z up). An oblique direction has several
 * letters, the strongest first, as in DICOM's Patient Orientation (PS3.3, C.7.6.1.1.1), which
 * writes F and H for I and S.
 */
#ifndef GZ_VIEW_DRAW_LETTERS_H
#define GZ_VIEW_DRAW_LETTERS_H

#include "base/result.h"
#include "render/picture/camera.h"
#include "render/picture/image.h"

#ifdef __cplusplus
extern "C" {
#endif

/** Size of a direction's letters with their NUL, bytes. */
#define GZ_LETTERS_SIZE 4

/**
 * The letters of a direction.
 *
 * @param direction  world units, any length but 0. An axis counts where the direction leans towards
 *                   it by 20 degrees or more (chosen: less is a tilt, not a side)
 * @param[out] out_letters  one to three letters; empty if @p direction is 0 or not a number
 */
void gz_letters_of(const double direction[3], char out_letters[GZ_LETTERS_SIZE]);

/** What the picture's four edges show. */
struct gz_letters {
	char left[GZ_LETTERS_SIZE], right[GZ_LETTERS_SIZE];
	char top[GZ_LETTERS_SIZE], bottom[GZ_LETTERS_SIZE];
};

/** The letters of a camera. @return what gz_camera_rays() returns. */
enum gz_result gz_letters_of_camera(const struct gz_camera *camera, struct gz_letters *out_letters);

/** Draw the letters light with a dark rim, sized by the picture's height. Nothing is drawn into a
 *  picture that is too small for them. */
void gz_letters_draw(const struct gz_letters *letters, struct gz_image *image);

#ifdef __cplusplus
}
#endif

#endif
