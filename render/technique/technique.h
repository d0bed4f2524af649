/**
 * @file
 * The contract between a technique and the picture maker. A technique is a way to draw objects.
 * Each technique is a row of the const table gz_techniques (render/scene/techniques.h). Programs
 * ask the row; none of them names a technique.
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
#include "render/mesh/mesh.h"
#include "render/picture/camera.h"
#include "render/picture/image.h"
#include "render/plan/plan.h"
#include "render/technique/ray_hits.h"
#include "render/technique/shade.h"
#include "render/transfer/transfer.h"

struct gz_gl_context;
struct gz_shading_measures;

/** Kinds of data that an object can have, as bits. */
enum gz_object_data {
	GZ_OBJECT_VOLUME = 1 << 0,
	GZ_OBJECT_LABELS = 1 << 1,
	GZ_OBJECT_MESH = 1 << 2,
	GZ_OBJECT_PARTICLES = 1 << 3,
};

struct gz_technique;

/** What is said of an object besides its data. Techniques use what they can show. */
struct gz_object_style {
	double importance;   /**< [0, 1] */
	double transparency; /**< [0, 1]: 0 hides what is behind, 1 cannot be seen */
	/** How illustrations draw it, and which way its strokes run: 0: as the settings say;
	 *  otherwise one more than enum gz_illustration_drawing and enum gz_hatch_direction. */
	int drawing, hatch_direction;
};

/** The style of an object for which nothing is said: half important, opaque. */
extern const struct gz_object_style gz_object_style_plain;

struct gz_shading_template;

/** One thing in a picture. All pointers are borrowed. */
struct gz_object {
	const struct gz_technique *technique; /**< draws the object */
	uint32_t id;                          /**< in planes of object ids: 1 or more */
	/** NULL: none. Its box is the world: the longest edge is 1. */
	const struct gz_volume *volume;
	const struct gz_transfer *transfer; /**< of the volume */
	const struct gz_mesh *mesh;         /**< shown in place of the volume, in whose frame it
						 is; NULL: none */
	const float *colour; /**< red, green and blue of a mesh, [0, 1]; NULL: the settings' */
	const char *name;    /**< for lists and messages; NULL: none */
	const struct gz_object_style *style; /**< NULL: gz_object_style_plain */
	/** How illustrations shade it; NULL: as the settings say. */
	const struct gz_shading_template *shading_template;
	const char *input; /**< file that the mesh stems from; what is computed of it may be kept;
			      NULL: none */
	/** Numbers that the owner increases when it changes what the pointers above lead to. */
	uint64_t data_revision, transfer_revision;
};

/** How this machine draws. */
struct gz_backend_params {
	int threads;      /**< cpu: 1 to 256; 0 = one for each processor */
	const char *simd; /**< cpu: "portable", "avx2" or "avx512"; NULL or "auto" = the best */
	/** Volumes of bricks: each picture waits until the bricks that it shows are loaded, as many
	 *  as fit. Otherwise a picture shows the bricks that are there, coarse ones first.
	 *  Illustrations: each picture waits until its points or strokes are made. Otherwise it is
	 *  grey until they are. */
	bool wait_for_bricks;
	/** gl: where to draw; borrowed, outlives the drawer. NULL = a context of its own from EGL,
	 *  without a window. A program with windows must pass a window's context
	 *  (render/opengl/gl_device.h). */
	struct gz_gl_context *gl_context;
	bool gl_hardware_only; /**< gl: refuse an OpenGL that runs on the processor */
	/** gl: limit of the device memory for voxels, or for triangles, bytes; a volume that does
	 * not fit is shown by bricks. 0 = as much as the driver has. */
	size_t gl_memory_bytes;
};

/** What one frame cost. */
struct gz_frame_stats {
	uint64_t rays;            /**< of the plan, including those that miss everything */
	uint64_t kept_rays;       /**< of them, those that an earlier picture cast */
	bool keeps_rays;          /**< its tiles are kept for the next picture */
	uint64_t samples;         /**< interpolations of data */
	double prepare_ms;        /**< work that later frames reuse; 0 = none was due */
	double prepare_within_ms; /**< the part of prepare_ms that the frame itself took */
	double cast_ms;
	double reconstruct_ms;
	double gpu_ms; /**< gl: cast and reconstruction by the device's clock; NaN if the device has
			    no clock or is a processor */
	/** What an illustration with illustration.automatic is like, valid until the next picture;
	 *  NULL: not measured. */
	const struct gz_shading_measures *measures;
	uint64_t bricks_coming; /**< bricks that were requested and are not loaded yet, and 1 if
				     marks of an illustration are being made. While it is
				     above 0, the same picture made again is sharper */
};

/** One picture to draw. All pointers are borrowed. */
struct gz_shot {
	const struct gz_camera *camera;
	const void *settings; /**< the struct that the technique's options describe */
	const struct gz_plan *plan;
	/** The same plan, to be refined while it is drawn (gz_plan_refine()); NULL: it is final. */
	struct gz_plan *refined;
	/** Of techniques that tell depths: put into each pixel's fourth byte the depth of what is
	 *  seen there, from 0 for the nearest to 255 for the farthest of this range. Where nothing
	 *  is seen it is 128. NULL: 255. */
	const struct gz_ray_depths *depths;
	/** Rays that an earlier picture cast may be taken, if nothing that decides them has
	 * changed. The picture is the same, bit for bit. */
	bool keeps_rays;
	/** What others have drawn into the picture; NULL: nothing. GZ_SHARES_AS_OPAQUE: put in what
	 *  lies nearer. GZ_SHARES_AS_CLEAR: end the rays there, in front of these pixels. */
	struct gz_ray_hits *hits;
	/** What others in the picture keep back of the light; at most GZ_SHADES_MAX. */
	const struct gz_shade *shades;
	size_t shade_count;
};

/** A place of a picture at which objects are looked for. All pointers are borrowed. */
struct gz_pick_request {
	const struct gz_camera *camera;
	const void *settings; /**< as in struct gz_shot */
	int width, height;    /**< of the picture, px */
	double x, y;          /**< px from its upper left corner */
};

/** Most surfaces behind each other at a place. Chosen: as many as illustrations show. */
#define GZ_PICKS_MAX 4

/** The objects at a place, the nearest first. */
struct gz_pick {
	size_t count;
	uint32_t ids[GZ_PICKS_MAX];
	double depths[GZ_PICKS_MAX]; /**< along the ray from where it begins, world units */
	double shares[GZ_PICKS_MAX]; /**< of the light that is seen there, (0, 1] */
};

/** The object that is seen most at a place; 0: none. */
uint32_t gz_pick_most_seen(const struct gz_pick *pick);

/** How long a print waits while nothing arrives, s. Chosen: marks of large meshes take as long. */
#define GZ_PRINT_WAIT_S 60

/** A drawing for print. */
struct gz_print {
	/** Its ending says what it is: .svg, marks in millimetres, or .png. Borrowed. */
	const char *path;
	double width_mm; /**< of the picture on paper, above 0 */
	double dpi;      /**< .png: pixels of 25.4 mm, above 0 */
	double wait_s;   /**< how long nothing of what the picture lacks may arrive before it is
			      given up; 0: GZ_PRINT_WAIT_S */
};

struct gz_drawer;

/** What a technique must provide to draw. Every table is const and has static storage. One thread
 *  at a time may use a drawer. */
struct gz_drawer_ops {
	/**
	 * Show these objects from the next picture on. Prepares what later frames can reuse, and
	 * only the parts whose revisions have changed. May block for seconds. Returns what the
	 * technique's create() documents; logged.
	 */
	enum gz_result (*show)(struct gz_drawer *drawer, const struct gz_object *objects,
			       size_t count);
	/** Optional. Limit a plan by what the picture shows. Called before the plan is made, so
	 *  shot->plan must not be read.
	 *
	 *  @return time that it took for what later plans reuse, ms */
	double (*bound_plan)(struct gz_drawer *drawer, const struct gz_shot *shot,
			     struct gz_plan_request *request);
	/** Draw a picture of the plan's size and write every pixel. @p image NULL leaves the
	 * picture on the device (see picture_texture). @p out_stats may be NULL.
	 * GZ_ERR_NO_DEVICE: the device is lost. Every failure is logged. GZ_SHARES_AS_CLEAR:
	 * shot->hits may be there. */
	enum gz_result (*draw)(struct gz_drawer *drawer, const struct gz_shot *shot,
			       struct gz_image *image, struct gz_frame_stats *out_stats);
	/** Of techniques with GZ_SHARES_AS_OPAQUE, else NULL. Cast the plan's rays, and put what
	 *  lies nearer into shot->hits, which is there. Fails as draw does. */
	enum gz_result (*cast_hits)(struct gz_drawer *drawer, const struct gz_shot *shot,
				    struct gz_frame_stats *out_stats);
	/** Optional: NULL if it keeps no light from others. Say what the objects keep back of the
	 *  light of a picture in which others are, too. Called before draw and cast_hits with the
	 *  same shot, of which hits and shades must not be read. Fails as draw does. */
	enum gz_result (*shade)(struct gz_drawer *drawer, const struct gz_shot *shot,
				struct gz_shade *out_shade);
	/** Optional: NULL if its objects cannot be told by a place. Find what is at a place of the
	 *  picture. Writes @p out_pick on success. Fails as draw does. */
	enum gz_result (*pick)(struct gz_drawer *drawer, const struct gz_pick_request *request,
			       struct gz_pick *out_pick);
	/** Optional. Take from another drawer of the technique, which shows the same objects by
	 *  another backend, what it has prepared and this one would prepare alike. */
	void (*take_prepared)(struct gz_drawer *drawer, struct gz_drawer *from);
	/** Optional. Write the marks that drew the last picture. GZ_ERR_INVAL: no marks drew it, or
	 * a size or ending is not valid. Otherwise fails as writing files does; logged. */
	enum gz_result (*print)(struct gz_drawer *drawer, const struct gz_print *print);
	/** Whether the picture of a shot can stay on the device. If not, draw needs an image. */
	bool (*keeps_on_device)(const struct gz_drawer *drawer, const struct gz_shot *shot);
	/** OpenGL's name of the texture (RGBA8, row 0 on top) that holds the last picture drawn
	 *  without an image; valid until the next one. 0: none. */
	unsigned (*picture_texture)(const struct gz_drawer *drawer);
	/** Name of the backend: "cpu", "gl". Static text. */
	const char *(*backend)(const struct gz_drawer *drawer);
	/** One line for reports, such as "avx512, 2 threads"; owned by the drawer. */
	const char *(*describe)(const struct gz_drawer *drawer);
	/** Free the drawer. Also correct after a failed show. */
	void (*destroy)(struct gz_drawer *drawer);
};

/** Common head of every drawer. */
struct gz_drawer {
	const struct gz_drawer_ops *ops;
};

/** How a technique shares a picture with others. */
enum gz_sharing {
	GZ_SHARES_NOT,
	GZ_SHARES_AS_OPAQUE, /**< what it shows hides everything behind; drawn first */
	GZ_SHARES_AS_CLEAR,  /**< its rays gather colour up to what others show; one of a picture */
};

/** Most option tables of one technique. Chosen: a scene has a dozen. */
#define GZ_TECHNIQUE_BINDINGS_MAX 16

/** One technique. Every row is const and has static storage. */
struct gz_technique {
	const char *name;            /**< in scenes and on command lines */
	const char *help;            /**< one line */
	unsigned shows;              /**< enum gz_object_data: the kinds of data it can show */
	size_t objects_max;          /**< most objects of one picture */
	const char *const *backends; /**< names, NULL-terminated, best first on a graphics device */
	bool backends_agree;         /**< all of them draw the same picture, but for rounding */
	bool stylised;               /**< draws as an illustrator does: not how matter looks */
	bool tells_depths;           /**< takes gz_shot.depths; others leave the byte at 255 */
	bool whole_pictures; /**< a picture depends on all its pixels: it is not made in strips */
	enum gz_sharing sharing; /**< those that share have settings of one struct */
	/**
	 * Check a backend's name and parameters before there is anything to show. Logged. Returns
	 * the failures of create() but GZ_ERR_NO_MEM.
	 */
	enum gz_result (*check)(const char *backend, const struct gz_backend_params *params,
				const struct gz_log *log);
	/**
	 * Make a drawer.
	 *
	 * @param backend  a name of backends; NULL or "auto" lets the technique choose
	 * @param log      outlives the drawer
	 * @param[out] out_drawer  owned by the caller, who frees it with gz_drawer_destroy()
	 * @retval GZ_ERR_NOT_FOUND    no such backend; logged
	 * @retval GZ_ERR_UNSUPPORTED  this machine cannot run it; logged
	 * @retval GZ_ERR_NO_MEM       out of memory
	 */
	enum gz_result (*create)(const char *backend, const struct gz_backend_params *params,
				 const struct gz_log *log, struct gz_drawer **out_drawer);
	size_t settings_size; /**< bytes of the struct that gz_shot.settings points to */
	/**
	 * List the option tables of that struct. The bindings borrow @p settings. Writes at most
	 * @p room of them.
	 *
	 * @return how many there are, at most GZ_TECHNIQUE_BINDINGS_MAX
	 */
	size_t (*bind)(void *settings, struct gz_option_binding *out_bindings, size_t room);
};

/** Whether a technique has a backend of that name; "auto" is none. */
bool gz_technique_has_backend(const struct gz_technique *technique, const char *name);

/** Destroy the drawer and set the pointer to NULL. Accepts a pointer to NULL. */
void gz_drawer_destroy(struct gz_drawer **drawer);

/** Whether two structs of a technique's settings have equal values for all its options. */
bool gz_technique_settings_same(const struct gz_technique *technique, const void *a, const void *b);

#endif
