/**
 * @file
 * What a technique is: a way to make a picture of objects. Every technique is a row of a const
 * table (render/scene/techniques.h); programs ask the row, and none names a technique.
 */
#ifndef GZ_RENDER_TECHNIQUE_TECHNIQUE_H
#define GZ_RENDER_TECHNIQUE_TECHNIQUE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/log.h"
#include "base/option.h"
#include "base/result.h"
#include "render/data/volume.h"
#include "render/picture/camera.h"
#include "render/picture/image.h"
#include "render/plan/plan.h"
#include "render/transfer/transfer.h"

struct gz_gl_context;

/** Kinds of data that an object can have, as bits. */
enum gz_object_data {
	GZ_OBJECT_VOLUME = 1 << 0,
	GZ_OBJECT_LABELS = 1 << 1,
	GZ_OBJECT_MESH = 1 << 2,
	GZ_OBJECT_PARTICLES = 1 << 3,
};

struct gz_technique;

/** One thing in a picture. What it points to is borrowed. */
struct gz_object {
	const struct gz_technique *technique; /**< that draws it */
	uint32_t id;                          /**< in planes of object ids: 1 or more */
	const struct gz_volume *volume;       /**< NULL: none */
	const struct gz_transfer *transfer;   /**< of the volume */
	/** Numbers that the owner counts up when it changes what the pointers above lead to. */
	uint64_t data_revision, transfer_revision;
};

/** How pictures are made on this machine. */
struct gz_backend_params {
	int threads;      /**< cpu: 0 = one for each processor, else 1 to 256 */
	const char *simd; /**< cpu: NULL or "auto", else "portable", "avx2", "avx512" */
	/** Of data that is shown by bricks: each picture waits for all bricks that it shows, or for
	 *  as many as there is room for; else it shows those that are there, coarse ones first. */
	bool wait_for_bricks;
	/** gl: where to draw; borrowed, outlives the drawer. NULL = without a window, from EGL. A
	 *  program with windows must give a window's (render/opengl/gl_context.h). */
	struct gz_gl_context *gl_context;
	bool gl_hardware_only; /**< gl: refuse OpenGL whose work a processor does */
	/** gl: most bytes of the device's memory that voxels take; what does not fit whole is shown
	 *  by bricks. 0 = what the driver has. */
	size_t gl_memory_bytes;
};

/** What one frame cost. */
struct gz_frame_stats {
	uint64_t rays;     /**< cast, those that miss everything included */
	uint64_t samples;  /**< interpolations of data */
	double prepare_ms; /**< preparation that is kept for later frames; 0 = nothing was due */
	double cast_ms;
	double reconstruct_ms;
	double gpu_ms; /**< gl: cast and reconstruction by the device's clock; NaN where there is
			    none, or a processor does the device's work */
	uint64_t bricks_coming; /**< bricks that were asked for and are not there yet. While it is
				     above 0, making the same picture again makes it sharper */
};

/** One picture to be drawn. What it points to is borrowed. */
struct gz_shot {
	const struct gz_camera *camera;
	const void *settings; /**< of the technique: the struct that its options describe */
	const struct gz_plan *plan;
};

struct gz_drawer;

/** What a technique at work must provide. Every table is const and has static storage. One thread
 *  at a time may use a drawer. */
struct gz_drawer_ops {
	/**
	 * Show these objects from the next picture on. Prepares what can be kept between frames,
	 * and prepares only what has changed by the objects' revisions. Returns what the
	 * technique's create() documents; logged.
	 */
	enum gz_result (*show)(struct gz_drawer *drawer, const struct gz_object *objects,
			       size_t count);
	/** Optional. Bound a plan by what the picture shows, before it is made: shot->plan is not
	 *  looked at. */
	void (*bound_plan)(const struct gz_drawer *drawer, const struct gz_shot *shot,
			   struct gz_plan_request *request);
	/** Draw a picture of the plan's size; every pixel is written. @p image NULL leaves it on
	 * the device, see picture_texture. @p out_stats may be NULL. GZ_ERR_NO_DEVICE: the device
	 * is lost; logged, as all failures. */
	enum gz_result (*draw)(struct gz_drawer *drawer, const struct gz_shot *shot,
			       struct gz_image *image, struct gz_frame_stats *out_stats);
	/** Whether pictures can stay on the device: else draw needs an image. */
	bool (*keeps_on_device)(const struct gz_drawer *drawer);
	/** OpenGL's name of the texture, RGBA8 with row 0 on top, that holds the last picture
	 *  without an image; valid until the next one. 0: none. */
	unsigned (*picture_texture)(const struct gz_drawer *drawer);
	/** Name of the backend: "cpu", "gl". */
	const char *(*backend)(const struct gz_drawer *drawer);
	/** One line for reports, as in "avx512, 2 threads"; the drawer's. */
	const char *(*describe)(const struct gz_drawer *drawer);
	/** Free it. Also correct after a failed show. */
	void (*destroy)(struct gz_drawer *drawer);
};

/** Common head of every drawer. */
struct gz_drawer {
	const struct gz_drawer_ops *ops;
};

/** One technique. Every row is const and has static storage. */
struct gz_technique {
	const char *name;            /**< in scenes and on command lines */
	const char *help;            /**< one line */
	unsigned shows;              /**< enum gz_object_data: the kinds of data it can show */
	size_t objects_max;          /**< most objects of one picture */
	const char *const *backends; /**< their names, NULL-terminated, best first on a graphics
					  device */
	/** Check a backend's name and parameters before there is anything to show. Logged. */
	enum gz_result (*check)(const char *backend, const struct gz_backend_params *params,
				const struct gz_log *log);
	/**
	 * Make a drawer.
	 *
	 * @param backend  a name of backends; NULL or "auto" lets the technique choose
	 * @param log      outlives the drawer
	 * @param[out] out_drawer  owned by the caller: gz_drawer_destroy()
	 * @retval GZ_ERR_NOT_FOUND    no such backend; logged
	 * @retval GZ_ERR_UNSUPPORTED  this machine cannot run it; logged
	 * @retval GZ_ERR_NO_MEM       no room
	 */
	enum gz_result (*create)(const char *backend, const struct gz_backend_params *params,
				 const struct gz_log *log, struct gz_drawer **out_drawer);
	size_t settings_size; /**< bytes of the struct that gz_shot.settings points to */
	/** The tables over that struct; bindings borrow @p settings.
	 *  Writes at most @p room. @return how many there are */
	size_t (*bind)(void *settings, struct gz_option_binding *out_bindings, size_t room);
};

/** Destroy and set to NULL. Accepts a pointer to NULL. */
void gz_drawer_destroy(struct gz_drawer **drawer);

#endif
