/**
 * @file
 * The backend that this run tests against the oracle.
 */
#ifndef GZ_TESTS_RENDER_ORACLE_CHECK_H
#define GZ_TESTS_RENDER_ORACLE_CHECK_H

#include "small_scene.h"

/** Render the scene by `standard` in each way that this machine can run the backend and hold every
 * channel of every pixel against the oracle, to 1/255; up to @p pixels_off pixels may differ, for
 *  scenes with places where rounding decides between two values. Fails the test otherwise. */
void oracle_check_but(struct small_scene *scene, int width, int height, int pixels_off);

/** The same without exception; frees the scene. */
void oracle_check(struct small_scene *scene, int width, int height);

#endif
