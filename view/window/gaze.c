#include "view/window/gaze.h"

#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include <GLFW/glfw3.h>

#include "base/clock.h"
#include "client/viewer_link.h"
#include "view/window/displays.h"
#include "view/window/loading.h"

#define GZ_LOG_MODULE "gazeview"

/* Longest time that a turn of the loop reads on in a log, up to its position (chosen: half a frame
 * at 60 Hz). */
#define SEEK_TURN_NS (GZ_NS_PER_S / 125)

/* Interval of looking for a missing daemon, and of reports to a daemon whose gaze is not read, s
 * (chosen: its return is seen at once, at no cost). */
#define ABSENT_PATIENCE_S 0.25
/* Interval without a live source, when only events change the picture, s. */
#define STILL_PATIENCE_S 10.0

/* How long nothing has moved in a still scene, ns. Chosen: the eye may follow on for as long. */
#define SCENE_RESTS_NS GZ_NS_PER_S

static enum gz_window_source source_of(const struct gz_gaze_choice *choice)
{
	switch (choice->kind) {
	case GZ_GAZE_MOUSE:
		return GZ_WINDOW_MOUSE;
	case GZ_GAZE_POINTER:
		return GZ_WINDOW_POINTER;
	case GZ_GAZE_LATEST:
		return choice->text[0] ? GZ_WINDOW_ENDPOINT : GZ_WINDOW_DAEMON;
	case GZ_GAZE_LOG:
		return GZ_WINDOW_LOG;
	case GZ_GAZE_CENTRE:
	case GZ_GAZE_FIXED:
		break;
	}
	return GZ_WINDOW_FIXED;
}

enum gz_window_source gz_window_source_now(const struct gz_window *window)
{
	return source_of(&window->sources->choice);
}

/* A log named in a scene may lie beside the scene. Logs of the command line are opened before there
 * is a scene. */
static void find_log_file(const struct gz_window *window, char path[GZ_PATH_SIZE])
{
	const char *scene = gz_window_scene_path(window), *slash = strrchr(scene, '/');
	char beside[2 * GZ_PATH_SIZE];
	if (!window->maker || path[0] == '/' || !slash || access(path, F_OK) == 0)
		return;
	const int length =
		snprintf(beside, sizeof beside, "%.*s%s", (int)(slash - scene) + 1, scene, path);
	if (length > 0 && length < GZ_PATH_SIZE && access(beside, F_OK) == 0)
		memcpy(path, beside, (size_t)length + 1);
}

static enum gz_result make_source(const struct gz_window *window,
				  const struct gz_gaze_choice *choice,
				  struct gz_gaze_source **out_source)
{
	char path[GZ_PATH_SIZE];
	switch (choice->kind) {
	case GZ_GAZE_MOUSE:
		*out_source = NULL;
		return GZ_OK;
	case GZ_GAZE_POINTER:
	case GZ_GAZE_LATEST:
		return gz_gaze_source_latest(choice->text, window->log, out_source);
	case GZ_GAZE_LOG:
		memcpy(path, choice->text, sizeof path);
		find_log_file(window, path);
		return gz_gaze_source_log(path, window->log, out_source);
	case GZ_GAZE_FIXED:
		return gz_gaze_source_fixed(choice->point, out_source);
	case GZ_GAZE_CENTRE: /* where the camera looks */
		break;
	}
	return gz_gaze_source_fixed((struct gz_point) { 0.5f, 0.5f }, out_source);
}

static void copy_gaze_text(char to[GZ_PATH_SIZE], const char *from)
{
	snprintf(to, GZ_PATH_SIZE, "%s", from);
}

/* Connect to the daemon that the gaze comes from, if it comes from one, to report to it. */
static enum gz_result open_link(struct gz_window *window)
{
	const struct gz_gaze_choice *choice = &window->sources->choice;
	if (choice->kind != GZ_GAZE_LATEST && choice->kind != GZ_GAZE_POINTER)
		return GZ_OK;
	char *linked = window->sources->linked;
	if (window->link && strcmp(linked, choice->text) == 0)
		return GZ_OK;
	gz_viewer_link_close(&window->link);
	memcpy(linked, choice->text, sizeof window->sources->linked);
	enum gz_result r = gz_viewer_link_open(choice->text, window->log, &window->link);
	/* Nothing is reported to a daemon whose inlet is not known. */
	return r == GZ_ERR_UNSUPPORTED ? GZ_OK : r;
}

static enum gz_result switch_source(struct gz_window *window, const char *text)
{
	struct gz_window_sources *sources = window->sources;
	struct gz_gaze_choice choice;
	struct gz_gaze_source *source = NULL;
	enum gz_result r = gz_gaze_choice_parse(text, window->log, &choice);
	if (r == GZ_OK)
		r = make_source(window, &choice, &source);
	if (r != GZ_OK)
		return r;
	gz_gaze_source_destroy(&window->source);
	window->source = source;
	sources->choice = choice;
	copy_gaze_text(sources->text, text);
	copy_gaze_text(sources->named[source_of(&choice)], text);
	sources->log = (struct gz_window_log_clock) { 0 };
	return open_link(window);
}

void gz_window_ask_for_gaze(struct gz_window *window, const char *text)
{
	if (switch_source(window, text) == GZ_OK)
		copy_gaze_text(window->settings.view.gaze, text);
	gz_window_wake_panels(window);
	window->present_needed = true;
}

/* A panel, a scene or a replay may have changed the setting. */
static void follow_settings(struct gz_window *window)
{
	char *wanted = window->settings.view.gaze;
	if (!wanted[0] || strcmp(wanted, window->sources->text) == 0)
		return;
	if (switch_source(window, wanted) != GZ_OK)
		copy_gaze_text(wanted, window->sources->text);
	gz_window_wake_panels(window);
	window->present_needed = true;
}

static void note_tracker(struct gz_window *window)
{
	const struct gz_status *status =
		window->source ? gz_gaze_source_status(window->source) : NULL;
	const enum gz_window_source now = gz_window_source_now(window);
	if (status && (now == GZ_WINDOW_DAEMON || now == GZ_WINDOW_POINTER))
		memcpy(window->sources->tracker_seen, status->tracker.name,
		       sizeof window->sources->tracker_seen);
}

static void turn_gaze(struct gz_window *window)
{
	follow_settings(window);
	note_tracker(window);
}

static int64_t log_time_ns(const struct gz_window_log_clock *clock)
{
	return clock->paused ? clock->base_ns
			     : clock->base_ns + gz_clock_now_ns() - clock->anchor_ns;
}

/* The clock goes on from @p place_ns. */
static void set_log_clock(struct gz_window_log_clock *clock, int64_t place_ns)
{
	clock->base_ns = place_ns;
	clock->anchor_ns = gz_clock_now_ns();
}

/* Read the source asked for, which exists. */
static void read_source(struct gz_window *window, struct gz_gaze_reading *out_reading)
{
	struct gz_window_log_clock *clock = &window->sources->log;
	struct gz_gaze_log_place place;
	if (clock->anchor_ns == 0)
		set_log_clock(clock, 0);
	int64_t time_ns = log_time_ns(clock);
	clock->seeking = !gz_gaze_source_log_forward(window->source, time_ns, SEEK_TURN_NS);
	if (clock->seeking && gz_gaze_source_log_place(window->source, &place)) {
		set_log_clock(clock, time_ns);
		time_ns = place.at_ns;
	}
	gz_gaze_source_read(window->source, time_ns, out_reading);
}

void gz_window_pause_log(struct gz_window *window, bool paused)
{
	struct gz_window_log_clock *clock = &window->sources->log;
	set_log_clock(clock, log_time_ns(clock));
	clock->paused = paused;
}

/* Logs are read forwards only: to go back, the log is opened again. */
void gz_window_seek_log(struct gz_window *window, int64_t place_ns)
{
	struct gz_window_sources *sources = window->sources;
	struct gz_gaze_log_place place;
	struct gz_gaze_source *reopened;
	if (!window->source || !gz_gaze_source_log_place(window->source, &place))
		return;
	if (place_ns < place.at_ns && make_source(window, &sources->choice, &reopened) == GZ_OK) {
		gz_gaze_source_destroy(&window->source);
		window->source = reopened;
	}
	set_log_clock(&sources->log, place_ns);
	sources->log.seeking = true;
}

/* ---- each turn ---- */

/* Geometry of the picture: the window's share of a known display, else a default for its size. */
static struct gz_display display_of_picture(const struct gz_window *window,
					    const struct gz_window_share *share, int width,
					    int height)
{
	const struct gz_scene *scene = gz_frame_maker_scene(window->maker);
	const struct gz_view_options *options = window->options;
	struct gz_display brought;
	const struct gz_display *known = NULL;
	if (scene->has_display)
		known = &scene->settings.display;
	else if (window->source && gz_gaze_source_display(window->source, &brought))
		known = &brought;
	struct gz_display display = gz_view_display(options, known, width, height);
	if (known || options->display_mm[0] > 0) {
		display.mm[0] *= share->width;
		display.mm[1] *= share->height;
	}
	display.px[0] = width;
	display.px[1] = height;
	return display;
}

/* Read the source asked for. A tracker's gaze is on its display, of which the window is a part. */
static void read_asked_source(struct gz_window *window, const struct gz_window_share *share,
			      struct gz_window_gaze *gaze)
{
	read_source(window, &gaze->asked);
	gaze->status = gz_gaze_source_status(window->source);
	gaze->missing = !gaze->asked.known || !gaze->asked.connected;
	if (gaze->missing)
		return;
	gaze->reading = gaze->asked;
	gaze->source = window->sources->choice.kind == GZ_GAZE_POINTER ? "pointer"
								       : window->source->ops->name;
	if (window->source->ops->live) {
		gaze->reading.point = gz_window_share_point(share, gaze->asked.point);
		gaze->reading.landing.point =
			gz_window_share_point(share, gaze->asked.landing.point);
	}
}

/* What is beside the picture may move. */
static void note_gaze_elsewhere(struct gz_window *window, struct gz_point point)
{
	if (!(point.x >= 0 && point.x <= 1 && point.y >= 0 && point.y <= 1))
		window->motion_ns = gz_clock_now_ns();
}

void gz_window_gaze_now(struct gz_window *window, int width, int height,
			struct gz_window_gaze *out_gaze)
{
	struct gz_window_share share = gz_window_share(window);
	struct gz_window_gaze gaze = { .source = "mouse" };
	if (window->source)
		read_asked_source(window, &share, &gaze);
	if (!window->source || gaze.missing)
		gz_gaze_source_read(window->mouse, 0, &gaze.reading);
	if (!window->source)
		gaze.asked = gaze.reading;
	else if (!gaze.missing && !window->source->ops->live)
		share = (struct gz_window_share) { 0, 0, 1, 1 };
	window->source_missing = gaze.missing;
	note_gaze_elsewhere(window, gaze.reading.point);
	gaze.display = display_of_picture(window, &share, width, height);
	*out_gaze = gaze;
}

/* Time until the source asked for may have something new. */
static double source_patience_s(const struct gz_window *window)
{
	const struct gz_window_log_clock *clock = &window->sources->log;
	const double frame_s = 1 / window->options->fps;
	struct gz_gaze_log_place place;
	if (!window->source)
		return STILL_PATIENCE_S;
	if (gz_gaze_source_log_place(window->source, &place)) {
		if (clock->seeking)
			return 0;
		return clock->paused || place.ended ? STILL_PATIENCE_S : frame_s;
	}
	if (!window->source->ops->live)
		return STILL_PATIENCE_S;
	return window->source_missing ? ABSENT_PATIENCE_S : frame_s;
}

double gz_window_gaze_patience_s(const struct gz_window *window)
{
	if (window->panel_frames > 0)
		return 0;
	if (!window->maker)
		return STILL_PATIENCE_S;
	const bool attends = !window->gaze_frozen && !gz_frame_settled(window->maker);
	if (window->options->turn_deg != 0 || attends || gz_frame_refinable(window->maker) ||
	    gz_frame_settling(window->maker))
		return 1 / window->options->fps;
	const double patience_s = source_patience_s(window);
	/* The window is reported to a daemon even if its gaze is not read. */
	return window->link && patience_s > ABSENT_PATIENCE_S ? ABSENT_PATIENCE_S : patience_s;
}

/* ---- reports ---- */

/* A monitor that was chosen only because the window is on it may be another one. */
static void report_monitor(struct gz_window *window, const struct gz_monitor *monitor)
{
	const struct gz_tracker_display chosen = gz_window_tracker_display(window);
	if (monitor && chosen.reason != GZ_TRACKER_DISPLAY_WINDOW) {
		const struct gz_monitor_place place = gz_monitor_place_of(monitor);
		gz_viewer_link_monitor(window->link, &place);
	} else {
		gz_viewer_link_monitor(window->link, NULL);
	}
}

/* Whether the person looks at a picture in which nothing has moved for a while. Other programs may
 * cover a window without the focus, and what an experiment shows is its own affair. */
static bool is_scene_still(const struct gz_window *window, int64_t now_ns)
{
	bool looked_at = glfwGetWindowAttrib(window->glfw, GLFW_FOCUSED) &&
			 !glfwGetWindowAttrib(window->glfw, GLFW_ICONIFIED);
	return window->maker && window->any_shown && !window->alone && !window->picture_hidden &&
	       looked_at && now_ns - window->motion_ns > SCENE_RESTS_NS;
}

/* The window's content in pixels of the tracker's display. */
static void report_rect(struct gz_window *window, int64_t now_ns)
{
	int rect_px[4];
	const struct gz_monitor *monitor = gz_window_tracker_monitor(window);
	gz_window_rect(window, rect_px);
	if (monitor) {
		rect_px[0] -= monitor->rect_px[0];
		rect_px[1] -= monitor->rect_px[1];
	}
	report_monitor(window, monitor);
	gz_viewer_link_scene(window->link, is_scene_still(window, now_ns));
	if (rect_px[2] > 0 && rect_px[3] > 0)
		gz_viewer_link_window(window->link, rect_px, now_ns);
}

/* The inverse of how a tracker's gaze is mapped onto the picture. */
static void report_pointer(struct gz_window *window, int64_t now_ns)
{
	int rect_px[4];
	gz_window_rect(window, rect_px);
	if (!window->cursor_inside || !window->cursor_known || rect_px[2] < 1 || rect_px[3] < 1) {
		gz_viewer_link_pointer(window->link, NULL, now_ns);
		return;
	}
	const struct gz_window_share share = gz_window_share(window);
	struct gz_point point;
	if (!gz_window_mouse_point(window, &point))
		return;
	point.x = (float)(share.x + share.width * (double)point.x);
	point.y = (float)(share.y + share.height * (double)point.y);
	gz_viewer_link_pointer(window->link, &point, now_ns);
}

void gz_window_report(struct gz_window *window)
{
	int64_t now_ns = gz_clock_now_ns();
	if (!window->link)
		return;
	report_rect(window, now_ns);
	if (window->sources->choice.kind == GZ_GAZE_POINTER)
		report_pointer(window, now_ns);
	else if (window->sources->pointer_told)
		gz_viewer_link_pointer(window->link, NULL, now_ns);
	window->sources->pointer_told = window->sources->choice.kind == GZ_GAZE_POINTER;
}

/* ---- the part ---- */

/* A daemon that reads another tracker gives no pointer. */
static bool is_available(const struct gz_window_sources *sources, int source)
{
	if (source == GZ_WINDOW_POINTER && sources->tracker_seen[0])
		return strcmp(sources->tracker_seen, "pointer") == 0;
	return sources->named[source][0] != '\0';
}

static void choose_source(struct gz_window *window, int source)
{
	char text[GZ_PATH_SIZE];
	if (!is_available(window->sources, source)) {
		gz_info(window->log, "no such source of the gaze: G has the panel to name one");
		return;
	}
	memcpy(text, window->sources->named[source], sizeof text);
	gz_window_ask_for_gaze(window, text);
}

static bool is_source(const struct gz_window *window, int source)
{
	return (int)gz_window_source_now(window) == source;
}

static void choose_next_source(struct gz_window *window, int number)
{
	(void)number;
	const struct gz_window_sources *sources = window->sources;
	int next = (int)gz_window_source_now(window);
	do {
		next = (next + 1) % GZ_WINDOW_SOURCE_COUNT;
	} while (!is_available(sources, next));
	choose_source(window, next);
}

static void toggle_freeze(struct gz_window *window, int number)
{
	(void)number;
	window->gaze_frozen = !window->gaze_frozen;
	window->present_needed = true;
}

static bool is_gaze_frozen(const struct gz_window *window, int number)
{
	(void)number;
	return window->gaze_frozen;
}

#define SOURCE(which, text, what)                                                        \
	{                                                                                \
		.number = (which), .help = (what), .name = (text), .menu = GZ_MENU_GAZE, \
		.submenu = "Gaze from", .on_picture = true, .is_on = is_source,          \
		.run = choose_source                                                     \
	}

static const struct gz_window_action gaze_actions[] = {
	SOURCE(GZ_WINDOW_DAEMON, "Daemon (tracker)", "gaze from the tracker of gazed"),
	SOURCE(GZ_WINDOW_MOUSE, "Mouse", "gaze from the mouse"),
	SOURCE(GZ_WINDOW_POINTER, "Mouse through gazed", "gaze from the mouse, through gazed"),
	SOURCE(GZ_WINDOW_ENDPOINT, "Another machine", "gaze from a daemon elsewhere"),
	SOURCE(GZ_WINDOW_LOG, "Recording", "gaze from a gaze log"),
	SOURCE(GZ_WINDOW_FIXED, "Fixed point", "gaze at a fixed point"),
	{ .letter = 'm',
	  .keys = "M",
	  .help = "next source of the gaze: daemon, mouse, log, …",
	  .name = "Next source",
	  .menu = GZ_MENU_GAZE,
	  .words = "tracker",
	  .run = choose_next_source },
	{ .letter = ' ',
	  .keys = "Space",
	  .help = "freeze the sharp region; the gaze goes on",
	  .name = "Freeze the sharp region",
	  .menu = GZ_MENU_GAZE,
	  .section = 1,
	  .on_picture = true,
	  .words = "hold stop pause",
	  .is_on = is_gaze_frozen,
	  .run = toggle_freeze },
};

static enum gz_result open_gaze(struct gz_window *window)
{
	const char *asked = window->options->gaze_text;
	copy_gaze_text(window->sources->named[GZ_WINDOW_DAEMON], "daemon");
	copy_gaze_text(window->sources->named[GZ_WINDOW_MOUSE], "mouse");
	copy_gaze_text(window->sources->named[GZ_WINDOW_POINTER], "pointer");
	copy_gaze_text(window->sources->named[GZ_WINDOW_FIXED], "0.5,0.5");
	enum gz_result r = gz_gaze_source_mouse(&window->mouse);
	return r == GZ_OK ? switch_source(window, asked[0] ? asked : "daemon") : r;
}

static void close_gaze(struct gz_window *window)
{
	gz_gaze_source_destroy(&window->source);
	gz_gaze_source_destroy(&window->mouse);
	gz_viewer_link_close(&window->link);
}

const struct gz_window_part gz_window_gaze_part = {
	.name = "gaze sources",
	.title = "gaze",
	GZ_PART_ACTIONS(gaze_actions),
	GZ_PART_STATE(sources),
	.open = open_gaze,
	.turn = turn_gaze,
	.close = close_gaze,
};
