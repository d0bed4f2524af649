/**
 * @file
 * Small volumes, cameras and frames for the renderer's tests.
 */
#ifndef GZ_TESTS_RENDER_SMALL_SCENE_H
#define GZ_TESTS_RENDER_SMALL_SCENE_H

#include "render/raycast/gl/gl_raycaster.h"
#include "render/raycast/shared/raycaster.h"

/** The default settings with a table of spacings, so that every method has what it needs. */
struct gz_foveation small_scene_foveation(void);

/** What a test renders. */
struct small_scene {
	struct gz_volume volume;
	struct gz_transfer transfer;
	struct gz_camera camera;
	struct gz_ray_params rays;
	struct gz_foveation foveation;
	struct gz_display display;
	struct gz_point gaze;
};

/** Waves in a box: smooth, without symmetry, with empty space on one side. */
struct small_scene small_scene_waves(int nx, int ny, int nz, enum gz_voxel_type type);

/** The waves of 8 bits, with colours that have nothing to do with them: their weights are the
 * values if these are alpha, else equal. */
struct small_scene small_scene_coloured(int nx, int ny, int nz, enum gz_volume_colour colour);

/** Every voxel the same, @p opacity per voxel length. */
struct small_scene small_scene_constant(int edge, double opacity);

/** A ball in matter that shows nothing, by every pixel and pre-integrated. A wall of the transfer
 * function lies in the cell of the pre-integrated table that the matter's value shares. */
struct small_scene small_scene_ball_in_hidden_matter(void);

/** The backend that this run tests: "cpu", unless the environment's GZ_TEST_BACKEND says otherwise.
 */
const char *small_scene_backend(void);

/** The settings by which this machine can run that backend, NULL-terminated: the cpu's instruction
 *  sets; one, NULL-like "auto", for gl. */
const char *const *small_scene_simd_sets(void);

/** Whether that backend runs here at all; says why on stderr if it does not. */
bool small_scene_backend_runs(void);

/** A renderer with the scene's volume and transfer function; fails the test where that fails. */
struct gz_raycaster *small_scene_renderer(const struct small_scene *scene, int threads,
					  const char *simd);

/** Render a frame by a plan that is kept from frame to frame; fails the test where that fails. */
void small_scene_render_plan(struct gz_raycaster *renderer, const struct small_scene *scene,
			     const struct gz_display *display, int width, int height,
			     struct gz_plan *plan, struct gz_image *image,
			     struct gz_frame_stats *out_stats);

/** Render a frame; fails the test where that fails. */
void small_scene_render(struct gz_raycaster *renderer, const struct small_scene *scene, int width,
			int height, struct gz_image *image, struct gz_frame_stats *out_stats);

/** Check that each of small_scene_simd_sets() draws the same picture of @p scene within one grey
 *  level, by every method. Sets the scene's method. */
void small_scene_sets_agree(struct small_scene *scene);

/** Greatest difference of any channel of any pixel, 0 to 255, and where. */
int image_difference(const struct gz_image *a, const struct gz_image *b, int *out_x, int *out_y);

/** How many pixels differ by more than a grey level in some channel. */
int image_pixels_apart(const struct gz_image *a, const struct gz_image *b);

void small_scene_free(struct small_scene *scene);

/** How a test's ray caster is made. */
struct raycaster_params {
	struct gz_backend_params backend;
	struct gz_gl_raycaster_hooks hooks; /**< of gl */
};

/** gz_raycaster_create() or, for gl, gz_gl_raycaster_create(). */
enum gz_result raycaster_with(const char *backend, const struct raycaster_params *params,
			      const struct gz_log *log, struct gz_raycaster **out_raycaster);

#endif
