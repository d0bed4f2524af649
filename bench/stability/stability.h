/**
 * @file
 * Where methods fail: checks that hold for every method and backend, as one table of rows. The
 * program runs them on a user's scene and driver, the tests on small scenes against an independent
 * ray caster. docs/foveation.md says what holds and why each bound is what it is.
 */
#ifndef GZ_BENCH_STABILITY_STABILITY_H
#define GZ_BENCH_STABILITY_STABILITY_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/log.h"
#include "base/result.h"
#include "protocol/display.h"
#include "render/data/volume.h"
#include "render/picture/camera.h"
#include "render/picture/image.h"
#include "render/plan/plan.h"
#include "render/raycast/shared/ray_params.h"
#include "render/transfer/transfer.h"

#define GZ_STABILITY_TEXT_SIZE 256 /**< bytes of any text below with its NUL */
#define GZ_STABILITY_NUMBERS   3   /**< most numbers that one row measures */
#define GZ_STABILITY_CROP_PX   32  /**< edge of the crop around a worst pixel */

/** A scene. Volume and transfer function are borrowed. */
struct gz_stability_scene {
	const struct gz_volume *volume;
	const struct gz_transfer *transfer;
	struct gz_camera camera;
	struct gz_ray_params rays;
};

/**
 * The picture that a scene should give with a ray for each pixel.
 *
 * @param user     of struct gz_stability_settings
 * @param image    resized to @p width x @p height
 * @return GZ_OK, or why there is none
 */
typedef enum gz_result gz_stability_wanted(void *user, const struct gz_stability_scene *scene,
					   int width, int height, struct gz_image *image);

/** Settings of the rows. */
struct gz_stability_settings {
	struct gz_stability_scene scene;
	struct gz_display display;   /**< of the picture, which fills it */
	int width, height;           /**< px */
	int threads;                 /**< of the cpu backend, as struct gz_backend_params says */
	int churn_frames;            /**< of the row "churn", 1000 or more */
	gz_stability_wanted *wanted; /**< NULL: the portable kernel of the cpu backend */
	void *wanted_user;
	const struct gz_log *log; /**< NULL: silent */
};

/** Result of a row. */
enum gz_stability_verdict {
	GZ_STABILITY_HOLDS,
	GZ_STABILITY_FAILS,
	GZ_STABILITY_REFUSED, /**< the backend says why it does not do this: note has it */
	GZ_STABILITY_APART,   /**< the row is not about such a method: note says why */
};

/** "holds", "fails", "refused", "does not apply"; static text. */
const char *gz_stability_verdict_text(enum gz_stability_verdict verdict);

/** One measured number: it holds where value <= bound. */
struct gz_stability_number {
	const char *what; /**< with its unit; static text */
	double value, bound;
	char where[GZ_STABILITY_TEXT_SIZE]; /**< what was rendered at its worst */
};

/** The pixel that is farthest off, in the number that is. */
struct gz_stability_pixel {
	bool known;
	int x, y; /**< of the picture */
	uint8_t got[3], wanted[3];
	/** Its surroundings, at most GZ_STABILITY_CROP_PX a side; only of a failure. */
	struct gz_image got_crop, wanted_crop;
	int crop_x, crop_y; /**< where the crops begin in the picture */
};

/** A row's outcome. Zero-initialised is empty. */
struct gz_stability_outcome {
	enum gz_stability_verdict verdict;
	int number_count;
	struct gz_stability_number numbers[GZ_STABILITY_NUMBERS];
	struct gz_stability_pixel worst;
	char note[GZ_STABILITY_TEXT_SIZE]; /**< beyond the numbers; may be empty */
};

struct gz_stability_bench;

/** A row of the table. */
struct gz_stability_row {
	const char *name;  /**< "tremble" */
	const char *holds; /**< what must hold, a sentence without its full stop */
	bool built_in;     /**< looks at volumes of its own, not at the scene */
	bool every_method; /**< runs all methods in turn: once a backend */
	/** Measure. @return GZ_OK with @p outcome filled, or what rendering or memory failed with
	 */
	enum gz_result (*run)(struct gz_stability_bench *bench,
			      struct gz_stability_outcome *outcome);
};

/** All rows; ends with one without a name. */
extern const struct gz_stability_row gz_stability_rows[];

/**
 * Get ready.
 *
 * @param settings         copied; what it points to is borrowed until destroy
 * @param[out] out_bench   owned by the caller: gz_stability_destroy()
 * @retval GZ_ERR_INVAL        a size or number out of range
 * @retval GZ_ERR_UNSUPPORTED  a volume of bricks, which only one renderer may show at a time;
 *                             logged
 * @retval GZ_ERR_NO_MEM       no room
 */
enum gz_result gz_stability_create(const struct gz_stability_settings *settings,
				   struct gz_stability_bench **out_bench);

/** Test this backend from now on. If gz_picture_maker_show() fails, its error is returned and no
 * row can be run. */
enum gz_result gz_stability_use_backend(struct gz_stability_bench *bench, const char *backend);

/**
 * Test this method from now on.
 *
 * @param foveation        within its table's ranges; copied. The method table without a table gets
 *                         a small one
 * @param rays             of the scene from now on; NULL leaves them
 * @param every_step_rule  rows about steps take the other step rules too, not only its own
 */
void gz_stability_use_method(struct gz_stability_bench *bench, const struct gz_foveation *foveation,
			     const struct gz_ray_params *rays, bool every_step_rule);

/**
 * Run a row by the method and backend in use.
 *
 * @param[in,out] outcome  emptied and filled; a frame that fails makes it fail or refused, with the
 *                         reason in its note
 * @retval GZ_ERR_NO_MEM  no room for reference pictures
 * @retval GZ_ERR_INVAL   no backend or method is in use
 */
enum gz_result gz_stability_run(struct gz_stability_bench *bench,
				const struct gz_stability_row *row,
				struct gz_stability_outcome *outcome);

/** One line about the backend in use, for reports. Owned by the bench; "" without one. */
const char *gz_stability_describe(const struct gz_stability_bench *bench);

/** Free what it holds and zero it. */
void gz_stability_outcome_free(struct gz_stability_outcome *outcome);

/** Destroy and set to NULL. Accepts a pointer to NULL. */
void gz_stability_destroy(struct gz_stability_bench **bench);

/**
 * Write the surroundings of the worst pixel as an enlarged picture: rendered, wanted, and the
 * difference four times as strong, with the pixel framed.
 *
 * @retval GZ_ERR_INVAL   the outcome has no such pixel
 * @retval GZ_ERR_NO_MEM  no room
 * @retval GZ_ERR_IO      cannot be written; logged
 */
enum gz_result gz_stability_write_picture(const struct gz_stability_outcome *outcome,
					  const char *path, const struct gz_log *log);

#endif
