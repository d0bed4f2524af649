#include "view/headless/headless.h"

#include <errno.h>
#include <math.h>
#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "base/clock.h"
#include "render/data/format.h"
#include "render/data/time_steps.h"
#include "render/plan/method.h"
#include "render/scene/scene_open.h"
#include "view/capture/output.h"
#include "view/capture/video.h"
#include "view/draw/letters.h"
#include "view/frame/comparison.h"
#include "view/frame/frame.h"
#include "view/frame/stats.h"
#include "view/gaze/gaze_source.h"
#include "view/session/replay.h"
#include "view/session/session_writer.h"

#define GZ_LOG_MODULE "gazeview"

/* Chosen: loading of less than a third of a second needs no bar; ten updates a second suffice. */
#define BAR_AFTER_NS  (300 * GZ_NS_PER_MS)
#define BAR_EVERY_NS  (100 * GZ_NS_PER_MS)
#define LINE_AFTER_NS (1000 * GZ_NS_PER_MS)

enum { NAME_COLUMNS = 32, BAR_COLUMNS = 24, BAR_LINE_SIZE = 128 };

/* Set by the handler; the only state a signal can reach. */
static volatile sig_atomic_t loading_signal;

static void on_loading_signal(int number)
{
	loading_signal = number;
}

void gz_loading_bar_text(const char *what, double share, double spent_s, char *out, size_t size)
{
	static const char full[] = "########################";
	const size_t length = strlen(what);
	const bool cut = length > NAME_COLUMNS;
	const char *name = cut ? what + length - (NAME_COLUMNS - 3) : what;
	int filled = (int)(share * BAR_COLUMNS);
	filled = filled < 0 ? 0 : filled > BAR_COLUMNS ? BAR_COLUMNS : filled;
	char left[24] = "";
	if (share > 0.01 && share <= 1)
		snprintf(left, sizeof left, "%.0f s left", spent_s / share * (1 - share));
	snprintf(out, size, "%s%s [%.*s%*s] %3.0f %% %s", cut ? "..." : "", name, filled, full,
		 BAR_COLUMNS - filled, "", 100 * share, left);
}

static void draw_bar(struct gz_loading_bar *bar, int64_t now_ns, double share, const char *what)
{
	char text[BAR_LINE_SIZE];
	gz_loading_bar_text(what, share, gz_ns_to_s(now_ns - bar->begin_ns), text, sizeof text);
	if (bar->terminal)
		fprintf(stderr, "\r\033[K%s", text);
	else if (!bar->drawn)
		gz_info(bar->log, "loading %s", text);
	bar->drawn = true;
}

static bool report_loading(void *user, double share, const char *what)
{
	struct gz_loading_bar *bar = user;
	const int64_t now_ns = gz_clock_now_ns();
	if (loading_signal)
		return false;
	if (now_ns < bar->next_ns)
		return true;
	bar->next_ns = bar->terminal ? now_ns + BAR_EVERY_NS : INT64_MAX;
	draw_bar(bar, now_ns, share, what);
	return true;
}

void gz_loading_bar_begin(struct gz_loading_bar *bar, const struct gz_log *log)
{
	*bar = (struct gz_loading_bar) {
		.loading = { .report = report_loading, .user = bar },
		.log = log,
		.begin_ns = gz_clock_now_ns(),
		.terminal = isatty(STDERR_FILENO) == 1,
	};
	bar->next_ns = bar->begin_ns + (bar->terminal ? BAR_AFTER_NS : LINE_AFTER_NS);
	struct sigaction action = { .sa_handler = on_loading_signal,
				    .sa_flags = (int)SA_RESETHAND };
	sigemptyset(&action.sa_mask);
	loading_signal = 0;
	sigaction(SIGINT, &action, &bar->interrupt);
	sigaction(SIGTERM, &action, &bar->terminate);
}

void gz_loading_bar_end(struct gz_loading_bar *bar)
{
	if (bar->terminal && bar->drawn)
		fputs("\r\033[K", stderr);
	sigaction(SIGINT, &bar->interrupt, NULL);
	sigaction(SIGTERM, &bar->terminate, NULL);
	if (loading_signal)
		raise(loading_signal);
}

/* The longest waits for a daemon's first gaze (chosen: a local connection is made within some ms; a
 * tracker that is only starting takes too long to wait for) and for its display (chosen: the status
 * comes once a second), and the interval between two checks. */
#define FIRST_GAZE_WAIT_NS   (500 * GZ_NS_PER_MS)
#define FIRST_STATUS_WAIT_NS (1200 * GZ_NS_PER_MS)
#define FIRST_GAZE_POLL_NS   (1 * GZ_NS_PER_MS)

enum { LINE_SIZE = 512 };

/* Set by the handler; the only state a signal can reach. */
static volatile sig_atomic_t signal_seen;

struct headless {
	const struct gz_view_options *options;
	const struct gz_log *log;
	struct gz_frame_maker *maker;
	struct gz_gaze_source *source;
	struct gz_stats_file *stats;
	struct gz_video *video;
	struct gz_comparison *comparison;  /* NULL: none needed yet */
	struct gz_session_writer *session; /* NULL: not recording */
	struct gz_replay *replay;
	struct gz_scene_settings settings; /* of the next frame; the camera turns */
	int64_t start_ns;
	int first_time_point; /* from 0 */
	bool silence_told;    /* the warning about a silent daemon was logged */
};

static void on_end_signal(int number)
{
	signal_seen = number;
}

/* Each signal is caught once: a second one ends the program in the middle of a frame. */
static void catch_signals(void)
{
	struct sigaction action = { .sa_handler = on_end_signal, .sa_flags = (int)SA_RESETHAND };
	sigemptyset(&action.sa_mask);
	signal_seen = 0;
	sigaction(SIGINT, &action, NULL);
	sigaction(SIGTERM, &action, NULL);
}

static enum gz_result create_gaze_source(const struct gz_gaze_choice *choice,
					 const struct gz_log *log,
					 struct gz_gaze_source **out_source)
{
	switch (choice->kind) {
	case GZ_GAZE_LATEST:
		return gz_gaze_source_latest(choice->text, log, out_source);
	case GZ_GAZE_LOG:
		return gz_gaze_source_log(choice->text, log, out_source);
	case GZ_GAZE_CENTRE: /* set before each frame */
	case GZ_GAZE_FIXED:
	case GZ_GAZE_MOUSE:
	case GZ_GAZE_POINTER:
		break;
	}
	return gz_gaze_source_fixed(choice->point, out_source);
}

/* The projection of the camera's look_at; the centre of the picture if it is behind the eye. */
static struct gz_point centre_of(const struct headless *self)
{
	struct gz_point centre = { 0.5f, 0.5f };
	const struct gz_camera *camera = &self->settings.camera;
	gz_camera_project(camera, self->options->size_px[0], self->options->size_px[1],
			  camera->look_at, &centre);
	return centre;
}

static struct gz_display display_now(struct headless *self)
{
	const struct gz_scene *scene = gz_frame_maker_scene(self->maker);
	struct gz_display known;
	const struct gz_display *best = NULL;
	if (scene->has_display)
		best = &scene->settings.display;
	else if (gz_gaze_source_display(self->source, &known))
		best = &known;
	return gz_view_display(self->options, best, self->options->size_px[0],
			       self->options->size_px[1]);
}

/* Time of a frame after the first, ns. Dividing last keeps whole results exact: a sample at exactly
 * the time of a frame belongs to it. */
static int64_t frame_time_ns(const struct headless *self, int frame)
{
	return (int64_t)floor((double)frame * (double)GZ_NS_PER_S / self->options->fps);
}

static struct gz_gaze_reading gaze_now(struct headless *self, int frame)
{
	struct gz_gaze_reading reading;
	gz_gaze_source_read(self->source, frame_time_ns(self, frame), &reading);
	if (self->options->gaze.kind == GZ_GAZE_CENTRE)
		reading.point = centre_of(self);
	if (!reading.known && !self->silence_told) {
		const char *endpoint = self->options->gaze.text;
		gz_warn(self->log,
			"no gaze from %s yet; the plan stays at the centre (start gazed, or run "
			"gazectl status)",
			endpoint[0] ? endpoint : "the local daemon");
		self->silence_told = true;
	}
	return reading;
}

static bool display_settled(struct headless *self)
{
	const struct gz_view_options *options = self->options;
	struct gz_display display;
	return gz_frame_maker_scene(self->maker)->has_display ||
	       (options->display_mm[0] > 0 && options->display_distance_mm > 0) ||
	       gz_gaze_source_display(self->source, &display);
}

/* Give a running daemon time to answer, so that the first frames have a gaze and the same display
 * as those that follow. */
static void await_daemon(struct headless *self)
{
	int64_t start_ns = gz_clock_now_ns(), now_ns = start_ns;
	struct gz_gaze_reading reading;
	while (!signal_seen) {
		gz_gaze_source_read(self->source, 0, &reading);
		if (reading.known && (display_settled(self) || !self->source->ops->display))
			return;
		if (now_ns - start_ns > (reading.known ? FIRST_STATUS_WAIT_NS : FIRST_GAZE_WAIT_NS))
			return;
		now_ns += FIRST_GAZE_POLL_NS;
		gz_clock_sleep_until_ns(now_ns);
	}
}

/* Draws nothing if the volume does not store its orientation. */
static void draw_side_letters(const struct headless *self, struct gz_image *image)
{
	struct gz_letters letters;
	if (gz_frame_maker_scene(self->maker)->volume.oriented &&
	    gz_letters_of_camera(&self->settings.camera, &letters) == GZ_OK)
		gz_letters_draw(&letters, image);
}

static enum gz_result write_png(const struct headless *self, const struct gz_image *image,
				int frame)
{
	char path[GZ_PATH_SIZE];
	enum gz_result r = gz_pattern_format(self->options->out, frame, path, sizeof path);
	if (r != GZ_OK) {
		gz_err(self->log, "--out: the name of picture %d is too long; shorten the pattern",
		       frame);
		return r;
	}
	return gz_image_write_png(image, path, self->log);
}

/* The time a frame is shown: a live one once it is made. */
static int64_t shown_ns(const struct headless *self, int frame)
{
	if (self->replay)
		return gz_replay_frame(self->replay)->time_ns;
	return self->source->ops->live ? gz_clock_now_ns() - self->start_ns
				       : frame_time_ns(self, frame);
}

/* ffmpeg starts with the first picture: an earlier error leaves no file. */
static enum gz_result add_to_video(struct headless *self, const struct gz_image *image, int frame)
{
	const struct gz_video_params params = {
		.path = self->options->video,
		.width = image->width,
		.height = image->height,
		.fps = self->options->fps,
		.wait = true,
	};
	enum gz_result r = GZ_OK;
	if (!self->video)
		r = gz_video_open(&params, self->log, &self->video);
	return r == GZ_OK ? gz_video_show(self->video, image, shown_ns(self, frame)) : r;
}

/* Put the standard picture beside a frame, or show the difference. */
static enum gz_result compare_with_standard(struct headless *self,
					    const struct gz_frame_request *request,
					    struct gz_image *image)
{
	enum gz_result r = GZ_OK;
	if (!self->comparison)
		r = gz_comparison_start(self->maker, self->options, self->log, &self->comparison);
	return r == GZ_OK ? gz_comparison_join(self->comparison, request, image) : r;
}

static enum gz_result write_headless_picture(struct headless *self,
					     const struct gz_frame_request *request,
					     struct gz_image *image,
					     const struct gz_frame_record *record, int frame)
{
	const struct gz_view_options *options = self->options;
	if (!options->out[0] && !options->video[0])
		return GZ_OK;
	if (self->settings.view.compare != GZ_COMPARE_NONE) {
		const enum gz_result compared = compare_with_standard(self, request, image);
		if (compared != GZ_OK)
			return compared;
	}
	if (self->settings.view.gaze_cursor && record->gaze_known)
		gz_frame_draw_cross(image, record->gaze);
	if (self->settings.view.letters)
		draw_side_letters(self, image);
	enum gz_result r = options->out[0] ? write_png(self, image, frame) : GZ_OK;
	return r == GZ_OK && options->video[0] ? add_to_video(self, image, frame) : r;
}

static enum gz_result print_frame_line(const struct headless *self,
				       const struct gz_frame_record *record)
{
	char line[LINE_SIZE];
	gz_frame_record_print(record, line, sizeof line);
	if (puts(line) >= 0 && fflush(stdout) == 0)
		return GZ_OK;
	gz_err(self->log, "cannot write to standard output: %s; free some space", strerror(errno));
	return GZ_ERR_IO;
}

/* A session begins with the first frame, when the display is known. */
static enum gz_result begin_session(struct headless *self, const struct gz_display *display)
{
	const struct gz_recording_start start = {
		.path = self->options->record,
		.scene = self->options->scene,
		.maker = self->maker,
		.settings = &self->settings,
		.display = display,
		.source = self->source->ops->name,
		.rate_hz = self->options->fps,
		.now_ns = self->start_ns,
	};
	return gz_recording_begin(&start, self->log, &self->session);
}

/* Write the drawing of the last frame for print. */
static enum gz_result print_drawing(struct headless *self, const struct gz_frame_request *request,
				    int frame)
{
	const struct gz_view_options *options = self->options;
	const struct gz_print print = { options->print, options->print_mm, options->print_dpi, 0 };
	if (!options->print[0] || frame != options->frames - 1)
		return GZ_OK;
	return gz_frame_print(self->maker, request, &print);
}

/* Render a frame and write everything the options ask for. */
static enum gz_result make_headless_frame(struct headless *self,
					  const struct gz_frame_request *request, int frame)
{
	struct gz_frame_record record;
	struct gz_image *image;
	enum gz_result r = gz_frame_make(self->maker, request, &image, &record);
	if (r == GZ_OK && self->session)
		r = gz_recording_add(self->session, self->maker, request, &record,
				     shown_ns(self, frame));
	if (r == GZ_OK)
		r = print_frame_line(self, &record);
	if (r == GZ_OK && self->stats)
		r = gz_stats_add(self->stats, &record);
	if (r == GZ_OK && self->replay)
		gz_replay_compare(self->replay, &record);
	if (r == GZ_OK)
		r = write_headless_picture(self, request, image, &record, frame);
	return r == GZ_OK ? print_drawing(self, request, frame) : r;
}

/* Show the time point of a frame, and load the next one ahead. */
static enum gz_result show_time_point(struct headless *self, int frame)
{
	const int count = gz_frame_time_points(self->maker);
	if (self->options->play <= 0 || count < 2)
		return GZ_OK;
	const int wanted = gz_playback_step_of_frame(
		self->first_time_point, count, self->options->play, frame / self->options->fps);
	enum gz_result r = GZ_OK;
	if (wanted != gz_frame_time_point(self->maker)) {
		r = gz_frame_take_time_point(self->maker, wanted, true);
		gz_comparison_stop(&self->comparison);
		if (r == GZ_OK)
			r = gz_frame_show_taken(self->maker);
		self->settings.time_point = gz_frame_time_point(self->maker) + 1;
	}
	if (r == GZ_OK)
		gz_frame_expect_time_point(self->maker, (wanted + 1) % count, NULL);
	return r;
}

static enum gz_result render_frame(struct headless *self, int frame)
{
	if (self->source->ops->live)
		gz_clock_sleep_until_ns(self->start_ns + frame_time_ns(self, frame));
	const struct gz_gaze_reading gaze = gaze_now(self, frame);
	const struct gz_display display = display_now(self);
	const struct gz_frame_request request = {
		.settings = &self->settings,
		.display = &display,
		.width = self->options->size_px[0],
		.height = self->options->size_px[1],
	};
	gz_frame_attend(self->maker, &self->settings.attention, &gaze, &display,
			self->source->ops->live ? gz_clock_now_ns() : frame_time_ns(self, frame));
	enum gz_result r = show_time_point(self, frame);
	if (r == GZ_OK && self->options->record[0] && !self->session)
		r = begin_session(self, &display);
	if (r == GZ_OK && self->session)
		r = gz_session_writer_gaze(self->session, &gaze,
					   self->start_ns + shown_ns(self, frame));
	if (r == GZ_OK)
		r = make_headless_frame(self, &request, frame);
	gz_camera_turn(&self->settings.camera, self->options->turn_deg);
	return r;
}

static enum gz_result replay_frame(struct headless *self, int frame)
{
	enum gz_result r = gz_replay_next(self->replay);
	if (r != GZ_OK)
		return r;
	const struct gz_session_frame *recorded = gz_replay_frame(self->replay);
	memcpy(&self->settings, gz_replay_settings(self->replay), sizeof self->settings);
	const struct gz_frame_request request = {
		.settings = &self->settings,
		.display = &recorded->display,
		.width = recorded->width,
		.height = recorded->height,
	};
	r = gz_replay_ready(self->replay);
	return r == GZ_OK ? make_headless_frame(self, &request, frame) : r;
}

static enum gz_result finish_video(struct headless *self, int64_t end_ns)
{
	if (self->video)
		gz_video_finish(self->video, end_ns);
	return gz_video_close(&self->video);
}

static enum gz_result replay_frames(struct headless *self)
{
	enum gz_result r = GZ_OK;
	for (int frame = 0; r == GZ_OK && !signal_seen; frame++)
		r = replay_frame(self, frame);
	/* The last frame is shown for one frame time. */
	const int64_t end_ns = shown_ns(self, 0) + (int64_t)(1e9 / self->options->fps);
	const enum gz_result closed = finish_video(self, end_ns);
	return r == GZ_OK || r == GZ_ERR_END ? closed : r;
}

static enum gz_result render_frames(struct headless *self)
{
	enum gz_result r = GZ_OK;
	if (self->source->ops->live)
		await_daemon(self);
	self->start_ns = gz_clock_now_ns();
	int frame = 0;
	for (; frame < self->options->frames && r == GZ_OK && !signal_seen; frame++)
		r = render_frame(self, frame);
	const enum gz_result recorded = gz_session_writer_end(&self->session);
	const enum gz_result closed = finish_video(self, shown_ns(self, frame));
	return r != GZ_OK ? r : recorded != GZ_OK ? recorded : closed;
}

/* Without a live gaze a run gives the same pictures each time, unless a budget adapts to the
 * machine. */
static void warn_of_budget(const struct headless *self)
{
	const bool keeps = gz_method_of(&self->settings.foveation)->can_be_coarser;
	if (self->settings.attention.budget_ms > 0 && keeps && !self->source->ops->live &&
	    !self->options->replay[0])
		gz_warn(self->log,
			"attention.budget_ms %g: the pictures depend on the speed of this machine; "
			"set it to 0 for the same pictures each time",
			self->settings.attention.budget_ms);
}

/* Several frames without a file measure the time; a single one is a picture that somebody wants. */
static void tell_of_lost_picture(const struct gz_view_options *options, const struct gz_log *log)
{
	if (!options->out[0] && !options->print[0] && !options->video[0] && !options->stats[0] &&
	    !options->record[0] && !options->replay[0] && options->frames == 1)
		gz_info(log, "the picture is not kept; --out FILE.png writes it");
}

static enum gz_result load_scene_shown(struct headless *self)
{
	const struct gz_frame_scene scene = gz_frame_scene_of_options(self->options);
	struct gz_loading_bar bar;
	gz_loading_bar_begin(&bar, self->log);
	const enum gz_result r =
		gz_frame_maker_create(self->options, &scene, &bar.loading, self->log, &self->maker);
	gz_loading_bar_end(&bar);
	return r;
}

enum gz_result gz_view_headless(const struct gz_view_options *options, const struct gz_log *log,
				int *out_signal)
{
	struct headless self = { .options = options, .log = log };
	catch_signals();
	/* Check first what needs no volume: the output files and the gaze. */
	enum gz_result r = gz_recording_check(options->record, log);
	if (r == GZ_OK)
		r = gz_output_check(options, log);
	if (r == GZ_OK)
		r = create_gaze_source(&options->gaze, log, &self.source);
	if (r == GZ_OK)
		r = load_scene_shown(&self);
	if (r == GZ_OK)
		r = gz_frame_maker_start(self.maker, options, NULL);
	if (r == GZ_OK && options->stats[0])
		r = gz_stats_open(options->stats, log, &self.stats);
	if (r == GZ_OK) {
		self.settings = gz_frame_maker_scene(self.maker)->settings;
		self.first_time_point = gz_frame_time_point(self.maker);
		warn_of_budget(&self);
		if (self.settings.view.letters)
			gz_frame_tell_unoriented(self.maker);
		r = options->replay[0] ? gz_replay_open(options, self.maker, log, &self.replay)
				       : render_frames(&self);
	}
	if (r == GZ_OK && self.replay)
		r = replay_frames(&self);
	if (r == GZ_OK && !signal_seen)
		tell_of_lost_picture(options, log);
	gz_replay_close(&self.replay);
	gz_stats_close(&self.stats);
	gz_comparison_stop(&self.comparison);
	gz_frame_maker_destroy(&self.maker);
	gz_gaze_source_destroy(&self.source);
	*out_signal = signal_seen;
	return r;
}

static gz_volume_writer *writer_of(const char *path, const struct gz_log *log)
{
	gz_volume_writer *writer = gz_volume_writer_by_name(path);
	if (!writer)
		gz_err(log, "--write-volume %s: unknown ending; use .gzb for bricks or .nrrd",
		       path);
	return writer;
}

static enum gz_result apply_options(void *user, struct gz_scene_settings *settings)
{
	return gz_view_options_apply(user, settings);
}

static enum gz_result load_with_bar(const struct gz_view_options *options,
				    const struct gz_loading *where, bool volume_alone,
				    const struct gz_log *log, struct gz_scene *out_scene)
{
	struct gz_loading_bar bar;
	gz_loading_bar_begin(&bar, log);
	if (where) {
		bar.loading.scratch = where->scratch;
		bar.loading.scratch_from = where->scratch_from;
	}
	struct gz_raw_layout raw;
	const struct gz_scene_request request = {
		.path = options->scene,
		.raw = gz_view_options_raw(options, &raw) ? &raw : NULL,
		.change = apply_options,
		.user = (void *)options, /* which is only read */
		.loading = &bar.loading,
		.volume_alone = volume_alone,
	};
	const enum gz_result r = gz_scene_open(&request, log, out_scene);
	gz_loading_bar_end(&bar);
	return r;
}

enum gz_result gz_view_load_volume(const struct gz_view_options *options,
				   const struct gz_loading *where, const struct gz_log *log,
				   struct gz_scene *out_scene)
{
	return load_with_bar(options, where, true, log, out_scene);
}

enum gz_result gz_view_load_scene(const struct gz_view_options *options, const struct gz_log *log,
				  struct gz_scene *out_scene)
{
	return load_with_bar(options, NULL, false, log, out_scene);
}

static enum gz_result write_to(const struct gz_view_options *options,
			       const struct gz_loading *where, gz_volume_writer *writer,
			       const struct gz_volume *volume, const struct gz_log *log)
{
	struct gz_loading_bar bar;
	if (volume->bricks) {
		gz_err(log, "--write-volume: the scene's volume is already stored in bricks");
		return GZ_ERR_UNSUPPORTED;
	}
	gz_loading_bar_begin(&bar, log);
	bar.loading.scratch = where->scratch;
	bar.loading.scratch_from = where->scratch_from;
	const enum gz_result r = writer(volume, options->write_volume, &bar.loading, log);
	gz_loading_bar_end(&bar);
	return r;
}

enum gz_result gz_view_write_volume(const struct gz_view_options *options, const struct gz_log *log)
{
	char folder[GZ_PATH_SIZE];
	struct gz_scene scene = { 0 };
	gz_volume_writer *writer = writer_of(options->write_volume, log);
	if (!writer)
		return GZ_ERR_UNSUPPORTED;
	enum gz_result r = gz_output_check(options, log);
	if (r != GZ_OK)
		return r;
	gz_output_folder(options->write_volume, folder, sizeof folder);
	const struct gz_loading where = { .scratch = folder,
					  .scratch_from = gz_volume_memory_bytes() };
	r = gz_view_load_volume(options, &where, log, &scene);
	if (r != GZ_OK)
		return r;
	r = write_to(options, &where, writer, &scene.volume, log);
	gz_scene_free(&scene);
	return r;
}
