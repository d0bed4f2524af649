/* The part that writes the surfaces shown as a mesh: Ctrl+E. */
#include <math.h>
#include <pthread.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "render/surface/isosurface_technique.h"
#include "view/capture/mesh_output.h"
#include "view/files/scene_save.h"
#include "view/panels/file_dialogs.h"
#include "view/panels/marks.h"
#include "view/window/loading.h"
#include "view/window/window_state.h"

#define GZ_LOG_MODULE "window"

/* Interval of asking whether the mesh has been written, s (chosen: reported soon). */
#define WRITTEN_PATIENCE_S 0.1

static const struct gz_save_words mesh_words = {
	.title = "Write a mesh",
	.what = "The surfaces are written as triangles, " GZ_MESH_ENDINGS ", to:",
	.verb = "Write",
};

/* A mesh that is made and written on a thread. */
struct mesh_job {
	pthread_t thread;
	const struct gz_log *log;
	char path[GZ_PATH_SIZE];
	/* Of the scene, which outlives the job: */
	const struct gz_volume *volume;
	struct gz_mesh_part *parts; /* labels; owned */
	size_t part_count;          /* 0: the surface of the volume is written */
	double isovalue;
	int threads;
	size_t triangles; /* written */
	int64_t start_ns;
	enum gz_result result;
	atomic_bool over;
};

struct gz_window_mesh_export {
	struct gz_save_panel panel;
	struct mesh_job *job; /* NULL: none */
	int64_t drawn_s;      /* time in the mark, as last drawn */
};

/* ---- writing ---- */

static void write_label_job(struct mesh_job *job)
{
	job->result = gz_mesh_write_parts(job->parts, job->part_count, job->path, job->log);
	for (size_t i = 0; i < job->part_count; i++)
		job->triangles += job->parts[i].mesh->triangle_count;
}

static void write_surface_job(struct mesh_job *job)
{
	struct gz_mesh mesh;
	job->result =
		gz_mesh_output_make(job->volume, job->isovalue, job->threads, job->log, &mesh);
	if (job->result != GZ_OK)
		return;
	job->result = gz_mesh_write(&mesh, job->path, job->log);
	job->triangles = mesh.triangle_count;
	gz_mesh_free(&mesh);
}

static void *run_mesh_job(void *argument)
{
	struct mesh_job *job = argument;
	if (job->part_count > 0)
		write_label_job(job);
	else
		write_surface_job(job);
	atomic_store(&job->over, true);
	return NULL;
}

/* Wait for the mesh that is being written, and log its path. */
static void finish_mesh(struct gz_window *window)
{
	struct mesh_job *job = window->mesh_export->job;
	if (!job)
		return;
	pthread_join(job->thread, NULL);
	if (job->result == GZ_OK)
		gz_info(job->log, "%s written, %zu triangles", job->path, job->triangles);
	free(job->parts);
	free(job);
	window->mesh_export->job = NULL;
	window->present_needed = true;
}

static bool shows_volume_surface(const struct gz_window *window)
{
	struct gz_object objects[GZ_SCENE_LISTED_MAX];
	const size_t count = gz_scene_list_objects(gz_frame_maker_scene(window->maker), objects,
						   sizeof objects / sizeof objects[0]);
	for (size_t i = 0; i < count; i++)
		if (objects[i].technique == &gz_isosurface_technique && objects[i].volume &&
		    !objects[i].mesh)
			return true;
	return false;
}

/* Labels of a scene are written without the surface of its volume, as --write-mesh does it. */
static enum gz_result start_mesh_job(struct gz_window *window, const char *path)
{
	const struct gz_scene *scene = gz_frame_maker_scene(window->maker);
	struct mesh_job *job = calloc(1, sizeof *job);
	if (!job)
		return GZ_ERR_NO_MEM;
	job->log = window->log;
	snprintf(job->path, sizeof job->path, "%s", path);
	job->volume = &scene->volume;
	job->isovalue = window->settings.rays.surface.isovalue;
	job->threads = window->options->threads;
	job->start_ns = gz_clock_now_ns();
	enum gz_result r = gz_mesh_output_parts(scene, window->log, &job->parts, &job->part_count);
	if (r == GZ_OK && pthread_create(&job->thread, NULL, run_mesh_job, job) != 0)
		r = GZ_ERR_NO_MEM;
	if (r != GZ_OK) {
		free(job->parts);
		free(job);
		return r;
	}
	window->mesh_export->job = job;
	return GZ_OK;
}

/* ---- the dialog ---- */

/* "NAME-surface.ply" beside the scene: a mesh or particles of that name may be what is shown. */
static void suggest_mesh(const struct gz_window *window, char out_path[GZ_PATH_SIZE])
{
	char path[GZ_PATH_SIZE];
	gz_scene_save_suggest(gz_window_scene_path(window), path);
	char *ending = strrchr(path, '.');
	if (ending)
		*ending = '\0';
	const int length = snprintf(out_path, GZ_PATH_SIZE, "%s-surface.ply", path);
	if (length < 0 || length >= GZ_PATH_SIZE)
		snprintf(out_path, GZ_PATH_SIZE, "surface.ply");
}

static void show_mesh_panel(struct gz_window *window, int number)
{
	char path[GZ_PATH_SIZE];
	(void)number;
	if (!window->maker) {
		gz_warn(window->log, "no mesh to write: no scene is shown");
		return;
	}
	if (!gz_frame_maker_scene(window->maker)->labels && !shows_volume_surface(window)) {
		gz_warn(window->log, "no mesh to write: no surface of a volume and no labels are "
				     "shown; set render.technique to isosurface");
		return;
	}
	suggest_mesh(window, path);
	gz_save_panel_show(&window->mesh_export->panel, &mesh_words, path);
	gz_window_wake_panels(window);
}

static void accept_mesh_path(struct gz_window *window, bool sure)
{
	struct gz_save_panel *panel = &window->mesh_export->panel;
	char question[GZ_PANEL_MESSAGE_SIZE];
	if (window->mesh_export->job) {
		snprintf(panel->message, sizeof panel->message,
			 "another mesh is still being written; wait a moment");
	} else if (!gz_mesh_file_named(panel->path)) {
		snprintf(panel->message, sizeof panel->message,
			 "the name must end in " GZ_MESH_ENDINGS);
	} else if (!sure && access(panel->path, F_OK) == 0) {
		snprintf(question, sizeof question, "%.200s exists. Replace?", panel->path);
		gz_save_panel_ask(panel, question);
	} else if (start_mesh_job(window, panel->path) == GZ_OK) {
		panel->open = false;
	} else {
		snprintf(panel->message, sizeof panel->message, "no memory to write it");
	}
	panel->focus_wanted = panel->open; /* Enter has left the field */
	gz_window_wake_panels(window);
}

static void draw_mesh_export(struct gz_window *window, const struct gz_window_gaze *gaze)
{
	struct gz_window_mesh_export *self = window->mesh_export;
	bool sure = false;
	(void)gaze;
	if (window->maker && gz_save_panel_draw(&self->panel, &sure))
		accept_mesh_path(window, sure);
	if (!self->job)
		return;
	self->drawn_s = (gz_clock_now_ns() - self->job->start_ns) / GZ_NS_PER_S;
	gz_marks_draw_running(3, "writing a mesh", false, self->drawn_s);
}

/* ---- the part ---- */

static void turn_mesh_export(struct gz_window *window)
{
	const struct gz_window_mesh_export *self = window->mesh_export;
	if (!self->job)
		return;
	if (atomic_load(&self->job->over))
		finish_mesh(window);
	else if ((gz_clock_now_ns() - self->job->start_ns) / GZ_NS_PER_S != self->drawn_s)
		window->present_needed = true;
}

static void leave_meshed_scene(struct gz_window *window)
{
	finish_mesh(window);
	window->mesh_export->panel.open = false;
}

static bool leave_meshed_data(struct gz_window *window)
{
	finish_mesh(window);
	return true;
}

static double mesh_patience_s(const struct gz_window *window)
{
	return window->mesh_export->job ? WRITTEN_PATIENCE_S : INFINITY;
}

static const struct gz_window_action mesh_actions[] = {
	{ .letter = 'e',
	  .modifiers = GZ_KEY_CONTROL,
	  .keys = "Ctrl+E",
	  .help = "write the surfaces as a mesh",
	  .name = "Write mesh...",
	  .menu = GZ_MENU_FILE,
	  .section = 2,
	  .words = "export ply obj stl",
	  .group = "files",
	  .run = show_mesh_panel },
};

const struct gz_window_part gz_window_mesh_export_part = {
	.name = "mesh",
	GZ_PART_ACTIONS(mesh_actions),
	GZ_PART_STATE(mesh_export),
	.scene_leaving = leave_meshed_scene,
	.data_leaving = leave_meshed_data,
	.turn = turn_mesh_export,
	.panels = draw_mesh_export,
	.patience_s = mesh_patience_s,
	.close = finish_mesh,
};
