#include "bench/report/picture.h"

#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "bench/study/stage.h"
#include "render/frame/picture_maker.h"

#define GZ_LOG_MODULE "report"

/* Widest picture that is rendered for a report, px. Chosen: more than it is ever shown with. */
#define WIDTH_MAX 640

static void picture_path(const struct gz_study_scene *scene, const char *folder,
			 char out_path[GZ_PATH_SIZE])
{
	char name[2 * GZ_STUDY_TEXT_SIZE + 16];
	snprintf(name, sizeof name, "standard-%s-%s", scene->name, scene->transfer);
	for (char *byte = name; *byte; byte++)
		if (!isalnum((unsigned char)*byte) && !strchr("._-", *byte))
			*byte = '-';
	snprintf(out_path, GZ_PATH_SIZE, "%.400s/%s.png", folder, name);
}

/* The scene's transfer function that shows what the study saw; false if it has none. */
static bool find_transfer(const struct gz_stage *stage, const struct gz_study_scene *was,
			  struct gz_transfer *out_transfer)
{
	char name[GZ_STUDY_TEXT_SIZE], hash[GZ_STUDY_HASH_SIZE];
	for (size_t i = 0; i < gz_stage_transfer_count(stage); i++)
		if (gz_stage_transfer(stage, i, name, out_transfer) == GZ_OK &&
		    gz_stage_data_hash(stage, out_transfer, hash) == GZ_OK &&
		    strcmp(hash, was->data_hash) == 0)
			return true;
	return false;
}

static enum gz_result render_standard(const struct gz_scene *scene, const struct gz_camera *camera,
				      const struct gz_log *log, struct gz_image *picture)
{
	const struct gz_picture_maker_params params = {
		.backend = "cpu",
		.backend_params = { .wait_for_bricks = true },
	};
	const struct gz_foveation standard = gz_foveation_full();
	const struct gz_display display = gz_display_default(picture->width, picture->height);
	const struct gz_picture_request request = {
		.camera = camera,
		.settings = &scene->settings.rays,
		.foveation = &standard,
		.display = &display,
		.focus = gz_focus_at((struct gz_point) { 0.5F, 0.5F }),
		.width = picture->width,
		.height = picture->height,
		.image = picture,
	};
	struct gz_object objects[GZ_SCENE_OBJECTS_MAX + 1];
	struct gz_picture_maker *maker = NULL;
	struct gz_image *made;
	const size_t count =
		gz_scene_list_objects(scene, objects, sizeof objects / sizeof objects[0]);
	enum gz_result result = gz_picture_maker_create(&params, log, &maker);
	if (result == GZ_OK)
		result = gz_picture_maker_show(maker, objects, count);
	if (result == GZ_OK)
		result = gz_picture_make(maker, &request, &made, NULL);
	gz_picture_maker_destroy(&maker);
	return result;
}

static enum gz_result render_scene(const struct gz_study *study, size_t place,
				   const struct gz_log *log, struct gz_image *picture)
{
	const struct gz_study_scene *was = &study->scenes[place];
	struct gz_stage stage = { .log = log };
	const int *size = study->sizes[0];
	const int width = size[0] < WIDTH_MAX ? size[0] : WIDTH_MAX;
	const int height = (int)fmax(1, round((double)width * size[1] / size[0]));
	if (access(was->path, R_OK) != 0 || gz_stage_load(&stage, was->path) != GZ_OK)
		return GZ_ERR_NOT_FOUND;
	enum gz_result result = find_transfer(&stage, was, &stage.scene.transfer)
					? gz_image_resize(picture, width, height)
					: GZ_ERR_NOT_FOUND;
	if (result == GZ_OK)
		result = render_standard(&stage.scene, &was->camera, log, picture);
	gz_stage_free(&stage);
	return result;
}

enum gz_result gz_report_picture(const struct gz_study *study, size_t scene, const char *folder,
				 const struct gz_log *log, struct gz_image *picture)
{
	char path[GZ_PATH_SIZE];
	picture_path(&study->scenes[scene], folder, path);
	if (access(path, R_OK) == 0)
		return gz_image_read_png(path, log, picture);
	const enum gz_result result = render_scene(study, scene, log, picture);
	if (result == GZ_OK)
		return gz_image_write_png(picture, path, log);
	if (result != GZ_ERR_NO_MEM)
		gz_warn(log,
			"%s: no picture lies behind its maps: %s is not there, or not what it "
			"was",
			study->scenes[scene].name, study->scenes[scene].path);
	return result == GZ_ERR_NO_MEM ? result : GZ_ERR_NOT_FOUND;
}
