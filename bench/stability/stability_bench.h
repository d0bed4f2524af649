/**
 * @file
 * Shared by the rows: frames by the backend under test, reference pictures, and filling an
 * outcome. Not for users of bench/stability/.
 */
#ifndef GZ_BENCH_STABILITY_STABILITY_BENCH_H
#define GZ_BENCH_STABILITY_STABILITY_BENCH_H

#include "bench/stability/stability.h"
#include "render/frame/picture_maker.h"
#include "render/raycast/shared/ray_params.h"

/** A method's own rule and the others. */
#define GZ_STABILITY_RULES_MAX 3

/** The volumes that rows bring along. */
enum gz_stability_volume {
	GZ_STABILITY_SLAB,        /**< the same everywhere, 64 x 64 x 12 */
	GZ_STABILITY_WIRES,       /**< wires and a shell, one voxel thick */
	GZ_STABILITY_RAMP,        /**< linear in x, y and z */
	GZ_STABILITY_LINE,        /**< 1 x 1 x 40 */
	GZ_STABILITY_VOXEL,       /**< one voxel */
	GZ_STABILITY_FLAT,        /**< 40 x 40 x 1 */
	GZ_STABILITY_ANISOTROPIC, /**< spacing 1 : 1 : 10 */
	GZ_STABILITY_BITS_16,
	GZ_STABILITY_BIG_ENDIAN, /**< 16 bits, read from a file */
	GZ_STABILITY_SIGNED,     /**< 16 bits with a sign, read from a file */
	GZ_STABILITY_VOLUME_COUNT,
};

/** Names for reports, in the order of the enum. */
extern const char *const gz_stability_volume_names[GZ_STABILITY_VOLUME_COUNT];

/**
 * Make a volume.
 *
 * @param[out] out_volume  filled; the caller frees it with gz_volume_free()
 * @retval GZ_ERR_NO_MEM, GZ_ERR_IO  no room in memory, or for the file it is read from
 */
enum gz_result gz_stability_volume_make(enum gz_stability_volume which, const struct gz_log *log,
					struct gz_volume *out_volume);

/** A picture's size and what it fills. */
struct gz_stability_view {
	int width, height;
	struct gz_display display;
};

/** A wanted picture and what it was made for. */
struct gz_stability_kept {
	struct gz_stability_scene scene;
	struct gz_transfer transfer;
	int width, height;
	struct gz_image image;
};

/** A picture maker and what it shows. */
struct gz_stability_maker {
	struct gz_picture_maker *maker;
	bool any_shown;
	const struct gz_volume *volume;
	struct gz_transfer transfer;
	uint64_t transfer_revision;
};

/** How a frame is foveated. */
struct gz_stability_shot {
	const struct gz_foveation *foveation;
	const struct gz_stability_view *view;
	struct gz_focus focus;
	const struct gz_temporal_params *temporal; /**< NULL: no earlier frame is kept */
};

/** The bench. Rows read settings, backend and foveation; the rest is for the functions below. */
struct gz_stability_bench {
	struct gz_stability_settings settings;
	struct gz_foveation foveation; /**< with the method under test */
	bool every_step_rule, has_method;
	char backend[16];
	struct gz_stability_maker tested, portable;
	struct gz_plan plan; /**< of the last frame */
	struct gz_frame_stats stats;
	struct gz_volume volumes[GZ_STABILITY_VOLUME_COUNT]; /**< made on first use */
	struct gz_stability_kept *kept;
	size_t kept_count, kept_capacity, kept_bytes;
	enum gz_result failed;  /**< GZ_OK, or what the picture maker under test failed with */
	struct gz_log said_log; /**< of the picture maker under test */
	char said[GZ_STABILITY_TEXT_SIZE];
};

/** The scene's view, of the settings. */
struct gz_stability_view gz_stability_scene_view(const struct gz_stability_bench *bench);

/** A small view of the default display. */
struct gz_stability_view gz_stability_small_view(int width, int height);

/** The method under test, with sizes and slopes such that the whole range of its spacings shows in
 *  a small view. */
struct gz_foveation gz_stability_small_foveation(const struct gz_stability_bench *bench,
						 const struct gz_stability_view *view);

/** The step rules that a row about steps goes through: the method's own first. @return how many */
int gz_stability_rules(const struct gz_stability_bench *bench,
		       int out_rules[GZ_STABILITY_RULES_MAX]);

/** A built-in volume, made when first asked for and kept. */
enum gz_result gz_stability_volume(struct gz_stability_bench *bench, enum gz_stability_volume which,
				   const struct gz_volume **out_volume);

/** Show the scene on the renderer under test, where it is not shown already. */
enum gz_result gz_stability_show(struct gz_stability_bench *bench,
				 const struct gz_stability_scene *scene);

/** A frame by the backend under test; bench->plan and bench->stats stay for a look. */
enum gz_result gz_stability_frame(struct gz_stability_bench *bench,
				  const struct gz_stability_scene *scene,
				  const struct gz_stability_shot *shot, struct gz_image *image);

/** The same for a gaze alone. */
enum gz_result gz_stability_frame_at(struct gz_stability_bench *bench,
				     const struct gz_stability_scene *scene,
				     const struct gz_foveation *foveation,
				     const struct gz_stability_view *view, struct gz_point gaze,
				     struct gz_image *image);

/** The picture by `standard` of the backend under test. */
enum gz_result gz_stability_standard(struct gz_stability_bench *bench,
				     const struct gz_stability_scene *scene,
				     const struct gz_stability_view *view, struct gz_image *image);

/** The reference picture, cached. @param[out] out_image  owned by the
 *  bench, valid until the next call. */
enum gz_result gz_stability_wanted_picture(struct gz_stability_bench *bench,
					   const struct gz_stability_scene *scene,
					   const struct gz_stability_view *view,
					   const struct gz_image **out_image);

/** The converged picture: the same with steps of 1/8 voxel, or as near as the range allows. */
enum gz_result gz_stability_converged_picture(struct gz_stability_bench *bench,
					      const struct gz_stability_scene *scene,
					      const struct gz_stability_view *view,
					      const struct gz_image **out_image);

/** Mark the pixels of the fovea: within 2.5 degrees of the gaze, where the eye resolves every pixel
 *  (the spacing it asks for is under 2 px) and, with the distance rule, within the 10 px where that
 *  leaves steps as they are. @param keep  and those marks that are set already. */
void gz_stability_mark_fovea(const struct gz_foveation *foveation,
			     const struct gz_stability_view *view, struct gz_point gaze, bool keep,
			     uint8_t *marks);

/** The first number of a row is named before anything is measured. */
void gz_stability_name(struct gz_stability_outcome *outcome, int number, const char *what,
		       double bound);

/** Greatest difference of a pixel's channels. */
int gz_stability_apart(const struct gz_image *a, const struct gz_image *b, size_t pixel);

/** A pixel of two pictures. got NULL: there is none. */
struct gz_stability_place {
	const struct gz_image *got, *wanted;
	size_t pixel;
};

/**
 * Take a measured value: the number keeps the greatest, the outcome the worst pixel of the number
 * that is farthest over its bound.
 *
 * @param format  what was rendered
 */
__attribute__((format(printf, 5, 6))) enum gz_result gz_stability_take(
	struct gz_stability_outcome *outcome, int number, double value,
	struct gz_stability_place place, const char *format, ...);

/* The rows; each is documented by its line in gz_stability_rows. */
enum gz_result gz_stability_brightness(struct gz_stability_bench *, struct gz_stability_outcome *);
enum gz_result gz_stability_thin(struct gz_stability_bench *, struct gz_stability_outcome *);
enum gz_result gz_stability_lost(struct gz_stability_bench *, struct gz_stability_outcome *);
enum gz_result gz_stability_tremble(struct gz_stability_bench *, struct gz_stability_outcome *);
enum gz_result gz_stability_border(struct gz_stability_bench *, struct gz_stability_outcome *);
enum gz_result gz_stability_pursuit(struct gz_stability_bench *, struct gz_stability_outcome *);
enum gz_result gz_stability_gaze(struct gz_stability_bench *, struct gz_stability_outcome *);
enum gz_result gz_stability_saccade(struct gz_stability_bench *, struct gz_stability_outcome *);
enum gz_result gz_stability_volumes(struct gz_stability_bench *, struct gz_stability_outcome *);
enum gz_result gz_stability_camera(struct gz_stability_bench *, struct gz_stability_outcome *);
enum gz_result gz_stability_transfer(struct gz_stability_bench *, struct gz_stability_outcome *);
enum gz_result gz_stability_spike(struct gz_stability_bench *, struct gz_stability_outcome *);
enum gz_result gz_stability_sizes(struct gz_stability_bench *, struct gz_stability_outcome *);
enum gz_result gz_stability_turn(struct gz_stability_bench *, struct gz_stability_outcome *);
enum gz_result gz_stability_kept(struct gz_stability_bench *, struct gz_stability_outcome *);
enum gz_result gz_stability_churn(struct gz_stability_bench *, struct gz_stability_outcome *);

#endif
