/**
 * @file
 * The picture maker turns objects, a camera, a display and a focus into a picture, with any
 * technique and backend. The window, headless rendering, the bench and the tests use it.
 */
#ifndef GZ_RENDER_FRAME_PICTURE_MAKER_H
#define GZ_RENDER_FRAME_PICTURE_MAKER_H

#include <stdbool.h>
#include <stddef.h>

#include "base/log.h"
#include "base/result.h"
#include "protocol/display.h"
#include "render/accumulate/temporal.h"
#include "render/attention/attention.h"
#include "render/picture/camera.h"
#include "render/picture/image.h"
#include "render/plan/plan.h"
#include "render/technique/technique.h"

/** Makes pictures of some objects. One thread at a time may use it. */
struct gz_picture_maker;

/** How a maker draws. Texts are borrowed and outlive the maker. */
struct gz_picture_maker_params {
	const char *backend; /**< "auto", or a name of the techniques' backends */
	struct gz_backend_params backend_params;
	/** Let cpu replace a backend that fails for good: its device is lost or out of memory, or
	 *  "auto" chose it and it does not support what is shown. Logged as a warning. */
	bool cpu_takes_over;
};

/**
 * Create a maker. Its backend opens at the first gz_picture_maker_show().
 *
 * @param log  outlives the maker; may be NULL
 * @param[out] out_maker  owned by the caller, who frees it with gz_picture_maker_destroy()
 * @retval GZ_ERR_NO_MEM  out of memory
 */
enum gz_result gz_picture_maker_create(const struct gz_picture_maker_params *params,
				       const struct gz_log *log,
				       struct gz_picture_maker **out_maker);

/**
 * Show these objects from the next picture on. The list is copied. What objects point to is
 * borrowed until another list is shown or the maker is destroyed. Only data whose revision has
 * changed are prepared again.
 *
 * Objects of several techniques hide each other as their depths say. Each ray of the plan meets all
 * of them before the picture is reconstructed.
 *
 * @param count  1 to 1024
 * @retval GZ_ERR_UNSUPPORTED  no objects, too many, techniques that do not share a picture (enum
 * gz_sharing), or something that a technique or its backend cannot show; logged
 * @return otherwise the failures of gz_technique.create and gz_drawer_ops.show; logged
 */
enum gz_result gz_picture_maker_show(struct gz_picture_maker *maker,
				     const struct gz_object *objects, size_t count);

/**
 * Go on with what another maker has made ready: what it shows, and how it draws that. What
 * @p maker showed is let go of.
 *
 * @param[in,out] from  destroyed and set to NULL
 */
void gz_picture_maker_adopt(struct gz_picture_maker *maker, struct gz_picture_maker **from);

/** Whether gz_picture_maker_take_prepared() spares a picture work: one technique draws, and cpu,
 *  which runs here, prepares for it what its own backend would. */
bool gz_picture_maker_can_take_prepared(const struct gz_picture_maker *maker);

/**
 * Go on with this maker's backend, and take what another one, of cpu, has prepared of the same
 * objects. After gz_picture_maker_can_take_prepared().
 *
 * @param[in,out] from  destroyed and set to NULL
 */
void gz_picture_maker_take_prepared(struct gz_picture_maker *maker, struct gz_picture_maker **from);

/** One picture to make. All pointers are borrowed until the call returns. */
struct gz_picture_request {
	const struct gz_camera *camera;
	const void *settings; /**< of the techniques, which share one struct */
	const struct gz_foveation *foveation;
	const struct gz_display *display; /**< of the picture, which fills it */
	struct gz_focus focus;            /**< where the plan is sharp: gz_focus_at() */
	int width, height;                /**< of the picture, px */
	double image_sampling_rate;       /**< rays per pixel edge; 0 means 1 */
	/** What is taken from earlier pictures; NULL: nothing. */
	const struct gz_temporal_params *temporal;
	/** For a picture in strips: make only rows [top, top + rows) of the picture of width x
	 *  height. rows = 0 makes all of it. */
	struct {
		int top, rows;
	} strip;
	bool on_device;     /**< leave the picture on the device if it is drawn there */
	bool fresh_plan;    /**< make the plan again even if the request is the same */
	bool loss_returned; /**< return GZ_ERR_NO_DEVICE instead of letting cpu take over */
	/** The caller's plan, kept from picture to picture; NULL: the maker's own. */
	struct gz_plan *plan;
	/** The caller's image for the picture, resized; NULL: the maker's own. */
	struct gz_image *image;
};

/**
 * Count the rays along each side of a picture.
 *
 * @param size_px  width and height of the picture
 * @param rate     rays per pixel edge, above 0
 * @param log      may be NULL
 * @param[out] out_rays  along the width and the height; written on success only
 * @retval GZ_ERR_INVAL  not 1 to GZ_IMAGE_SIDE_MAX along a side; logged with the remedy
 */
enum gz_result gz_picture_count_rays(const int size_px[2], double rate, const struct gz_log *log,
				     int out_rays[2]);

/** The focus of a plan that trusts the gaze at @p point, normalised. */
struct gz_focus gz_focus_at(struct gz_point point);

/** What one picture cost. */
struct gz_picture_cost {
	struct gz_frame_stats stats; /**< reconstruct_ms includes resampling and accumulation */
	double plan_ms;
	double total_ms; /**< wall time of the call */
	double finer;    /**< gz_plan_request.finer: above 1, the plan has grown */
	bool kept;       /**< earlier pictures contributed to it: temporal.accumulate */
};

/**
 * Make one picture of what is shown.
 *
 * @param[out] out_image  the picture, valid until the next call; NULL if it stayed on the device:
 *                        gz_picture_maker_texture()
 * @param[out] out_cost   may be NULL
 * @retval GZ_ERR_INVAL        nothing is shown, the picture at its sampling rate is too large or
 * has no ray, or a value is out of range; logged
 * @retval GZ_ERR_NO_MEM       out of memory; logged
 * @retval GZ_ERR_UNSUPPORTED  the technique or the backend cannot do it; logged
 * @retval GZ_ERR_NO_DEVICE    the device is lost, and request->loss_returned is set; logged
 */
enum gz_result gz_picture_make(struct gz_picture_maker *maker,
			       const struct gz_picture_request *request,
			       struct gz_image **out_image, struct gz_picture_cost *out_cost);

/**
 * Find what is at a place of a picture of what is shown. Volumes of rays and slices are not found:
 * they have no surface.
 *
 * @param[out] out_pick  empty: nothing is found there
 * @retval GZ_ERR_INVAL  nothing is shown, or a value is out of range; not logged
 * @return otherwise the failures of gz_picture_make()
 */
enum gz_result gz_picture_maker_pick(struct gz_picture_maker *maker,
				     const struct gz_pick_request *request,
				     struct gz_pick *out_pick);

/**
 * Make a picture and write the marks that draw it as a file for print. Every pixel is cast,
 * wherever somebody looks. The maker's own picture and plan change.
 *
 * @param request  of the picture; its size decides how large marks are on paper, and foveation,
 *                 focus, strip and accumulation do not count
 * @param print    path, and size on paper
 * @retval GZ_ERR_UNSUPPORTED  what is shown is not drawn by marks at all; logged
 * @retval GZ_ERR_INVAL        not drawn by marks with these settings, or a size or ending is not
 *                             valid; logged
 * @retval GZ_ERR_TIMEOUT  bricks or marks that the picture lacks have not arrived; logged
 * @retval GZ_ERR_IO, GZ_ERR_FULL  the file cannot be written; logged
 * @return otherwise what gz_picture_make() returns
 */
enum gz_result gz_picture_print(struct gz_picture_maker *maker,
				const struct gz_picture_request *request,
				const struct gz_print *print);

/** OpenGL's name of the texture with the last picture that stayed on the device, valid until the
 * next picture. 0: none. */
unsigned gz_picture_maker_texture(const struct gz_picture_maker *maker);

/** The maker's own plan, as of the last picture; without tiles before the first. */
const struct gz_plan *gz_picture_maker_plan(const struct gz_picture_maker *maker);

/** Name of the backend that draws, of several techniques the last: "cpu", "gl"; "" before anything
 * is shown. Static text. */
const char *gz_picture_maker_backend(const struct gz_picture_maker *maker);

/** One line for reports, such as "avx512, 2 threads"; "" before anything is shown. Valid until
 * other objects are shown. */
const char *gz_picture_maker_describe(const struct gz_picture_maker *maker);

/** Whether further pictures of the same request would still change, because they accumulate or
 *  their plan grows. */
bool gz_picture_maker_settling(const struct gz_picture_maker *maker);

/** Forget what earlier pictures saw. */
void gz_picture_maker_forget(struct gz_picture_maker *maker);

/** Destroy the maker and set the pointer to NULL. The context that it draws with must still exist.
 *  Accepts a pointer to NULL. */
void gz_picture_maker_destroy(struct gz_picture_maker **maker);

#endif
