/* Frames by the backend under test, and the pictures that are wanted. */
#include "bench/stability/stability_bench.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "render/plan/method.h"
#include "render/scene/techniques.h"

#define GZ_LOG_MODULE "stability"

/* Wanted pictures are kept for the next method up to so many bytes. Chosen: a row asks for up to a
 * hundred of one small size, or a dozen of the largest. */
#define KEPT_BYTES_MAX ((size_t)512 << 20)

static void hear(void *user, enum gz_log_level level, const char *module, const char *message)
{
	struct gz_stability_bench *bench = user;
	(void)module;
	if (level >= GZ_LOG_WARN)
		snprintf(bench->said, sizeof bench->said, "%s", message);
}

enum gz_result gz_stability_create(const struct gz_stability_settings *settings,
				   struct gz_stability_bench **out_bench)
{
	if (settings->width < 1 || settings->width > GZ_IMAGE_SIDE_MAX || settings->height < 1 ||
	    settings->height > GZ_IMAGE_SIDE_MAX || settings->churn_frames < 1000 ||
	    !gz_display_valid(&settings->display))
		return GZ_ERR_INVAL;
	if (settings->scene.volume->bricks) {
		gz_err(settings->log,
		       "only one renderer at a time can show a volume of bricks, and this needs "
		       "two: convert it to one that fits into memory");
		return GZ_ERR_UNSUPPORTED;
	}
	struct gz_stability_bench *bench = calloc(1, sizeof *bench);
	if (!bench)
		return GZ_ERR_NO_MEM;
	bench->settings = *settings;
	gz_log_init(&bench->said_log, hear, bench, "*:warn");
	*out_bench = bench;
	return GZ_OK;
}

enum gz_result gz_stability_use_backend(struct gz_stability_bench *bench, const char *backend)
{
	snprintf(bench->backend, sizeof bench->backend, "%s", backend);
	const struct gz_picture_maker_params params = {
		.backend = bench->backend,
		.backend_params = { .threads = bench->settings.threads },
	};
	gz_picture_maker_destroy(&bench->tested.maker);
	enum gz_result result =
		gz_techniques[0]->check(backend, &params.backend_params, bench->settings.log);
	if (result == GZ_OK)
		result = gz_picture_maker_create(&params, &bench->said_log, &bench->tested.maker);
	if (result == GZ_OK)
		result = gz_stability_show(bench, &bench->settings.scene);
	if (result != GZ_OK) {
		if (bench->said[0]) /* the reason why the backend does not start */
			gz_err(bench->settings.log, "%s", bench->said);
		gz_picture_maker_destroy(&bench->tested.maker);
	}
	return result;
}

/* Used if the user gives none. */
static const struct gz_spacing_table small_table = {
	.in_deg = true,
	.count = 3,
	.rows = { { 0, 0.01, 1 }, { 3, 0.05, 1 }, { 25, 0.4, 3 } },
};

void gz_stability_use_method(struct gz_stability_bench *bench, const struct gz_foveation *foveation,
			     const struct gz_ray_params *rays, bool every_step_rule)
{
	if (rays)
		bench->settings.scene.rays = *rays;
	bench->foveation = *foveation;
	bench->every_step_rule = every_step_rule;
	bench->has_method = true;
	if (gz_method_of(foveation)->needs_table && foveation->table.count == 0)
		bench->foveation.table = small_table;
}

const char *gz_stability_describe(const struct gz_stability_bench *bench)
{
	return bench->tested.maker ? gz_picture_maker_describe(bench->tested.maker) : "";
}

void gz_stability_destroy(struct gz_stability_bench **bench)
{
	if (!*bench)
		return;
	gz_picture_maker_destroy(&(*bench)->tested.maker);
	gz_picture_maker_destroy(&(*bench)->portable.maker);
	gz_plan_free(&(*bench)->plan);
	for (int i = 0; i < GZ_STABILITY_VOLUME_COUNT; i++)
		gz_volume_free(&(*bench)->volumes[i]);
	for (size_t i = 0; i < (*bench)->kept_count; i++)
		gz_image_free(&(*bench)->kept[i].image);
	free((*bench)->kept);
	free(*bench);
	*bench = NULL;
}

struct gz_stability_view gz_stability_scene_view(const struct gz_stability_bench *bench)
{
	return (struct gz_stability_view) { bench->settings.width, bench->settings.height,
					    bench->settings.display };
}

struct gz_stability_view gz_stability_small_view(int width, int height)
{
	return (struct gz_stability_view) { width, height, gz_display_default(width, height) };
}

struct gz_foveation gz_stability_small_foveation(const struct gz_stability_bench *bench,
						 const struct gz_stability_view *view)
{
	struct gz_foveation f = bench->foveation;
	const double edge = fmin(view->width, view->height);
	const double px_per_deg = gz_display_px_per_deg(&view->display);
	f.mdc_square_px = fmax(edge / 4, 1);
	f.mdc3_square_px = fmax(edge / 2, 1);
	for (int axis = 0; axis < 2; axis++) {
		f.ddc_inner_px[axis] = fmax((axis ? 0.16 : 0.2) * edge, 1);
		f.ddc_middle_px[axis] = fmax((axis ? 0.33 : 0.4) * edge, 1);
	}
	f.blend_px = 0;
	/* 16 px at 25 degrees, which the default display shows half its width from the middle */
	f.acuity_slope = fmin(2 * 16 / px_per_deg / 25, 1);
	return f;
}

int gz_stability_rules(const struct gz_stability_bench *bench,
		       int out_rules[GZ_STABILITY_RULES_MAX])
{
	out_rules[0] = bench->foveation.step_rule;
	if (!bench->every_step_rule)
		return 1;
	out_rules[0] = GZ_STEP_METHOD;
	out_rules[1] = GZ_STEP_DISTANCE;
	const enum gz_plan_steps own = gz_method_of(&bench->foveation)->own_steps;
	out_rules[2] =
		own == GZ_STEPS_RUNG || own == GZ_STEPS_PLACE ? GZ_STEP_NONE : GZ_STEP_ACUITY;
	return 3;
}

enum gz_result gz_stability_volume(struct gz_stability_bench *bench, enum gz_stability_volume which,
				   const struct gz_volume **out_volume)
{
	enum gz_result result = GZ_OK;
	if (!bench->volumes[which].voxels)
		result = gz_stability_volume_make(which, bench->settings.log,
						  &bench->volumes[which]);
	if (result == GZ_OK)
		*out_volume = &bench->volumes[which];
	return result;
}

/* Show a scene; a scene that is shown already costs nothing. */
static enum gz_result show_on(struct gz_stability_maker *on, const struct gz_stability_scene *scene)
{
	const bool same_transfer =
		on->any_shown && gz_transfer_same(&on->transfer, scene->transfer);
	if (on->any_shown && on->volume == scene->volume && same_transfer)
		return GZ_OK;
	if (!same_transfer)
		on->transfer_revision++;
	on->any_shown = false;
	on->transfer = *scene->transfer;
	const struct gz_object object = {
		.technique = gz_techniques[0],
		.id = 1,
		.volume = scene->volume,
		.transfer = &on->transfer,
		.transfer_revision = on->transfer_revision,
	};
	const enum gz_result result = gz_picture_maker_show(on->maker, &object, 1);
	on->volume = scene->volume;
	on->any_shown = result == GZ_OK;
	return result;
}

enum gz_result gz_stability_show(struct gz_stability_bench *bench,
				 const struct gz_stability_scene *scene)
{
	return bench->failed = show_on(&bench->tested, scene);
}

static enum gz_result make_frame(struct gz_picture_maker *maker,
				 const struct gz_stability_scene *scene,
				 const struct gz_stability_shot *shot, struct gz_plan *plan,
				 struct gz_image *image, struct gz_picture_cost *out_cost)
{
	const struct gz_picture_request request = {
		.camera = &scene->camera,
		.settings = &scene->rays,
		.foveation = shot->foveation,
		.display = &shot->view->display,
		.focus = shot->focus,
		.temporal = shot->temporal,
		.width = shot->view->width,
		.height = shot->view->height,
		.plan = plan,
		.image = image,
	};
	struct gz_image *made;
	return gz_picture_make(maker, &request, &made, out_cost);
}

enum gz_result gz_stability_frame(struct gz_stability_bench *bench,
				  const struct gz_stability_scene *scene,
				  const struct gz_stability_shot *shot, struct gz_image *image)
{
	struct gz_picture_cost cost = { 0 };
	enum gz_result result = gz_stability_show(bench, scene);
	if (result == GZ_OK)
		result = make_frame(bench->tested.maker, scene, shot, &bench->plan, image, &cost);
	bench->stats = cost.stats;
	return bench->failed = result;
}

enum gz_result gz_stability_frame_at(struct gz_stability_bench *bench,
				     const struct gz_stability_scene *scene,
				     const struct gz_foveation *foveation,
				     const struct gz_stability_view *view, struct gz_point gaze,
				     struct gz_image *image)
{
	const struct gz_stability_shot shot = { foveation, view, gz_focus_at(gaze), NULL };
	return gz_stability_frame(bench, scene, &shot, image);
}

static const struct gz_point centre = { 0.5F, 0.5F };

enum gz_result gz_stability_standard(struct gz_stability_bench *bench,
				     const struct gz_stability_scene *scene,
				     const struct gz_stability_view *view, struct gz_image *image)
{
	const struct gz_foveation standard = gz_foveation_full();
	return gz_stability_frame_at(bench, scene, &standard, view, centre, image);
}

/* The portable kernel shares no instruction with the others that it could be wrong by. */
static enum gz_result render_portable(struct gz_stability_bench *bench,
				      const struct gz_stability_scene *scene,
				      const struct gz_stability_view *view, struct gz_image *image)
{
	const struct gz_picture_maker_params params = {
		.backend = "cpu",
		.backend_params = { .threads = bench->settings.threads, .simd = "portable" },
	};
	const struct gz_foveation standard = gz_foveation_full();
	const struct gz_stability_shot shot = { &standard, view, gz_focus_at(centre), NULL };
	enum gz_result result = GZ_OK;
	if (!bench->portable.maker)
		result = gz_picture_maker_create(&params, bench->settings.log,
						 &bench->portable.maker);
	if (result == GZ_OK)
		result = show_on(&bench->portable, scene);
	return result == GZ_OK ? make_frame(bench->portable.maker, scene, &shot, NULL, image, NULL)
			       : result;
}

static bool same_scene(const struct gz_stability_kept *kept, const struct gz_stability_scene *scene,
		       const struct gz_stability_view *view)
{
	return kept->width == view->width && kept->height == view->height &&
	       kept->scene.volume == scene->volume &&
	       gz_camera_same(&kept->scene.camera, &scene->camera) &&
	       gz_ray_params_same(&kept->scene.rays, &scene->rays) &&
	       gz_transfer_same(&kept->transfer, scene->transfer);
}

static void forget_pictures(struct gz_stability_bench *bench)
{
	for (size_t i = 0; i < bench->kept_count; i++)
		gz_image_free(&bench->kept[i].image);
	bench->kept_count = bench->kept_bytes = 0;
}

static enum gz_result make_room_for_picture(struct gz_stability_bench *bench)
{
	if (bench->kept_count < bench->kept_capacity)
		return GZ_OK;
	const size_t capacity = bench->kept_capacity ? 2 * bench->kept_capacity : 16;
	struct gz_stability_kept *kept = realloc(bench->kept, capacity * sizeof *kept);
	if (!kept)
		return GZ_ERR_NO_MEM;
	bench->kept = kept;
	bench->kept_capacity = capacity;
	return GZ_OK;
}

enum gz_result gz_stability_wanted_picture(struct gz_stability_bench *bench,
					   const struct gz_stability_scene *scene,
					   const struct gz_stability_view *view,
					   const struct gz_image **out_image)
{
	for (size_t i = 0; i < bench->kept_count; i++)
		if (same_scene(&bench->kept[i], scene, view)) {
			*out_image = &bench->kept[i].image;
			return GZ_OK;
		}
	const size_t bytes = (size_t)view->width * (size_t)view->height * 4;
	if (bench->kept_bytes + bytes > KEPT_BYTES_MAX)
		forget_pictures(bench);
	enum gz_result result = make_room_for_picture(bench);
	if (result != GZ_OK)
		return result;
	struct gz_stability_kept *kept = &bench->kept[bench->kept_count];
	*kept = (struct gz_stability_kept) { .scene = *scene,
					     .transfer = *scene->transfer,
					     .width = view->width,
					     .height = view->height };
	if (bench->settings.wanted)
		result = bench->settings.wanted(bench->settings.wanted_user, scene, view->width,
						view->height, &kept->image);
	else
		result = render_portable(bench, scene, view, &kept->image);
	if (result != GZ_OK) {
		gz_image_free(&kept->image);
		return result;
	}
	bench->kept_count++;
	bench->kept_bytes += bytes;
	*out_image = &kept->image;
	return GZ_OK;
}

enum gz_result gz_stability_converged_picture(struct gz_stability_bench *bench,
					      const struct gz_stability_scene *scene,
					      const struct gz_stability_view *view,
					      const struct gz_image **out_image)
{
	struct gz_stability_scene fine = *scene;
	fine.rays.ray_sampling_rate =
		fmin(fmax(8, scene->rays.ray_sampling_rate), GZ_RAY_SAMPLING_RATE_MAX);
	fine.rays.levels = false;
	fine.rays.early_termination = false;
	return gz_stability_wanted_picture(bench, &fine, view, out_image);
}

/* ---- volumes ---- */

const char *const gz_stability_volume_names[GZ_STABILITY_VOLUME_COUNT] = {
	"slab",    "wires and shell", "ramp",    "1x1x40",     "one voxel",
	"40x40x1", "spacing 1:1:10",  "16 bits", "big-endian", "signed",
};

/* Waves without symmetry, [0, 1], that are 0 in a part of the box. */
static double waves(double u, double v, double w)
{
	const double wave = sin(9 * u + 4 * v * v) * cos(7 * w - 3 * u * v);
	return u + 0.4 * w > 0.6 ? 0.5 + 0.5 * wave : 0;
}

static double ramp(double u, double v, double w)
{
	return (u + 0.5 * v + 0.25 * w) / 1.75;
}

static double constant(double u, double v, double w)
{
	(void)u, (void)v, (void)w;
	return 0.5;
}

/* In a box of 64 voxels: wires along an axis and askew, and a shell a voxel thick. */
static double wires(double u, double v, double w)
{
	const int x = (int)(64 * u), y = (int)(64 * v), z = (int)(64 * w);
	if (x >= 4 && x < 60 && ((y == 20 && z == 32) || (y == 10 + x / 2 && z == 64 - x)))
		return 1;
	const double radius = sqrt((x - 24) * (x - 24) + (y - 44) * (y - 44) + (z - 40) * (z - 40));
	return fabs(radius - 14) < 0.5 ? 1 : 0;
}

/* How a volume is made. */
struct recipe {
	int dims[3];
	double spacing_z;
	enum gz_voxel_type type;
	double (*value)(double u, double v, double w);
};

static const struct recipe recipes[GZ_STABILITY_VOLUME_COUNT] = {
	[GZ_STABILITY_SLAB] = { { 64, 64, 12 }, 1, GZ_VOXEL_U8, constant },
	[GZ_STABILITY_WIRES] = { { 64, 64, 64 }, 1, GZ_VOXEL_U8, wires },
	[GZ_STABILITY_RAMP] = { { 16, 16, 16 }, 1, GZ_VOXEL_F32, ramp },
	[GZ_STABILITY_LINE] = { { 1, 1, 40 }, 1, GZ_VOXEL_U8, waves },
	[GZ_STABILITY_VOXEL] = { { 1, 1, 1 }, 1, GZ_VOXEL_U8, constant },
	[GZ_STABILITY_FLAT] = { { 40, 40, 1 }, 1, GZ_VOXEL_U8, waves },
	[GZ_STABILITY_ANISOTROPIC] = { { 24, 24, 6 }, 10, GZ_VOXEL_U8, waves },
	[GZ_STABILITY_BITS_16] = { { 20, 24, 18 }, 1, GZ_VOXEL_U16, waves },
};

static void put_case_voxel(struct gz_volume *volume, size_t index, double value)
{
	if (volume->type == GZ_VOXEL_U8)
		((uint8_t *)volume->voxels)[index] = (uint8_t)lround(value * 255);
	else if (volume->type == GZ_VOXEL_U16)
		((uint16_t *)volume->voxels)[index] = (uint16_t)lround(value * 60000);
	else
		((float *)volume->voxels)[index] = (float)value;
}

static enum gz_result cook(const struct recipe *recipe, struct gz_volume *out_volume)
{
	struct gz_volume volume = { .spacing = { 1, 1, recipe->spacing_z }, .type = recipe->type };
	memcpy(volume.dims, recipe->dims, sizeof volume.dims);
	const enum gz_result result = gz_volume_allocate(&volume);
	if (result != GZ_OK)
		return result;
	size_t index = 0;
	for (int z = 0; z < volume.dims[2]; z++)
		for (int y = 0; y < volume.dims[1]; y++)
			for (int x = 0; x < volume.dims[0]; x++)
				put_case_voxel(&volume, index++,
					       recipe->value((x + 0.5) / volume.dims[0],
							     (y + 0.5) / volume.dims[1],
							     (z + 0.5) / volume.dims[2]));
	gz_volume_find_range(&volume);
	*out_volume = volume;
	return GZ_OK;
}

/* Loaders convert types that no kernel reads, so the volume comes from a file. */
enum { FILE_EDGE = 20, FILE_BYTES = FILE_EDGE * FILE_EDGE * FILE_EDGE * 2 };

static void fill_file(bool big_endian, bool has_sign, uint8_t bytes[FILE_BYTES])
{
	for (int i = 0; i < FILE_BYTES / 2; i++) {
		const double u = (i % FILE_EDGE + 0.5) / FILE_EDGE,
			     v = (i / FILE_EDGE % FILE_EDGE + 0.5) / FILE_EDGE,
			     w = (i / (FILE_EDGE * FILE_EDGE) + 0.5) / FILE_EDGE;
		const unsigned bits =
			(unsigned)(lround(waves(u, v, w) * 60000) - (has_sign ? 30000 : 0)) &
			0xFFFF;
		bytes[2 * i + (big_endian ? 1 : 0)] = (uint8_t)(bits & 255);
		bytes[2 * i + (big_endian ? 0 : 1)] = (uint8_t)(bits >> 8);
	}
}

static enum gz_result through_file(bool big_endian, bool has_sign, const struct gz_log *log,
				   struct gz_volume *out_volume)
{
	const struct gz_raw_layout layout = {
		.dims = { FILE_EDGE, FILE_EDGE, FILE_EDGE },
		.type = has_sign ? GZ_RAW_INT16 : GZ_RAW_UINT16,
		.big_endian = big_endian,
		.spacing = { 1, 1, 1 },
	};
	const char *folder = getenv("TMPDIR");
	char path[GZ_STABILITY_TEXT_SIZE];
	uint8_t *bytes = malloc(FILE_BYTES);
	if (!bytes)
		return GZ_ERR_NO_MEM;
	fill_file(big_endian, has_sign, bytes);
	snprintf(path, sizeof path, "%s/stability-XXXXXX.raw", folder ? folder : "/tmp");
	const int file = mkstemps(path, 4);
	const bool written = file >= 0 && write(file, bytes, FILE_BYTES) == FILE_BYTES;
	enum gz_result result = GZ_ERR_IO;
	if (written)
		result = gz_volume_load(path, &layout, NULL, log, out_volume);
	else
		gz_err(log, "%s: cannot be written: %s; TMPDIR names another folder", path,
		       strerror(errno));
	if (file >= 0) {
		close(file);
		unlink(path);
	}
	free(bytes);
	return result;
}

enum gz_result gz_stability_volume_make(enum gz_stability_volume which, const struct gz_log *log,
					struct gz_volume *out_volume)
{
	if (which == GZ_STABILITY_BIG_ENDIAN)
		return through_file(true, false, log, out_volume);
	if (which == GZ_STABILITY_SIGNED)
		return through_file(false, true, log, out_volume);
	return cook(&recipes[which], out_volume);
}

/* ---- the fovea ---- */

/* The distance rule leaves steps unchanged within 10 px (Bauer 2018, 3.2.3). */
#define DISTANCE_RULE_PX 10

/* cos 2.5 degrees */
#define FOVEA_COSINE 0.99904822158185778

/* Looked at millions of times a row: no arc cosine. */
static bool near_gaze(const struct gz_display *display, const double gaze_mm[3], struct gz_point at)
{
	double at_mm[3], dot = 0, gaze_square = 0, at_square = 0;
	gz_display_to_mm(display, at, at_mm);
	for (int axis = 0; axis < 3; axis++) {
		dot += gaze_mm[axis] * at_mm[axis];
		gaze_square += gaze_mm[axis] * gaze_mm[axis];
		at_square += at_mm[axis] * at_mm[axis];
	}
	return dot >= FOVEA_COSINE * sqrt(gaze_square * at_square);
}

static bool foveal(const struct gz_foveation *foveation, const struct gz_stability_view *view,
		   struct gz_point gaze, const double gaze_mm[3], int x, int y)
{
	const struct gz_point at = { (float)((x + 0.5) / view->width),
				     (float)((y + 0.5) / view->height) };
	if (!near_gaze(&view->display, gaze_mm, at))
		return false;
	const double across_px = x + 0.5 - (double)gaze.x * view->width;
	const double down_px = y + 0.5 - (double)gaze.y * view->height;
	if (foveation->step_rule == GZ_STEP_DISTANCE &&
	    !(hypot(across_px, down_px) < DISTANCE_RULE_PX))
		return false;
	return gz_acuity_spacing_px(foveation, &view->display, gaze, at, view->width,
				    view->height) < 2;
}

void gz_stability_mark_fovea(const struct gz_foveation *foveation,
			     const struct gz_stability_view *view, struct gz_point gaze, bool keep,
			     uint8_t *marks)
{
	double gaze_mm[3];
	gz_display_to_mm(&view->display, gaze, gaze_mm);
	for (int y = 0; y < view->height; y++)
		for (int x = 0; x < view->width; x++, marks++)
			*marks = (!keep || *marks) && foveal(foveation, view, gaze, gaze_mm, x, y);
}
