#include "view/window/gaze_sources.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/clock.h"
#include "client/viewer_link.h"
#include "view/window/loading.h"

#define GZ_LOG_MODULE "gazeview"

/* So long a turn of the loop may go on in a log on the way to a place in it (chosen: half a frame
 * at 60 Hz). */
#define SEEK_TURN_NS (GZ_NS_PER_S / 125)

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

/* A log that a scene names may lie beside it; one of the command line is read as the window opens.
 */
static void find_log(const struct gz_window *window, char path[GZ_PATH_SIZE])
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

static enum gz_result open_source(const struct gz_window *window,
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
		find_log(window, path);
		return gz_gaze_source_log(path, window->log, out_source);
	case GZ_GAZE_FIXED:
		return gz_gaze_source_fixed(choice->point, out_source);
	case GZ_GAZE_CENTRE: /* the camera always looks there */
		break;
	}
	return gz_gaze_source_fixed((struct gz_point) { 0.5f, 0.5f }, out_source);
}

/* Zero behind its end, as settings are compared. */
static void copy_text(char to[GZ_PATH_SIZE], const char *from)
{
	const size_t length = strnlen(from, GZ_PATH_SIZE - 1);
	memset(to, 0, GZ_PATH_SIZE);
	memcpy(to, from, length);
}

static enum gz_result switch_source(struct gz_window *window, const char *text)
{
	struct gz_window_sources *sources = window->sources;
	struct gz_gaze_choice choice;
	struct gz_gaze_source *source = NULL;
	enum gz_result r = gz_gaze_choice_parse(text, window->log, &choice);
	if (r == GZ_OK)
		r = open_source(window, &choice, &source);
	if (r != GZ_OK)
		return r;
	gz_gaze_source_destroy(&window->source);
	window->source = source;
	sources->choice = choice;
	copy_text(sources->text, text);
	copy_text(sources->named[source_of(&choice)], text);
	sources->log = (struct gz_window_log_clock) { 0 };
	return gz_window_report_open(window);
}

void gz_window_ask_for_gaze(struct gz_window *window, const char *text)
{
	if (switch_source(window, text) == GZ_OK)
		copy_text(window->settings.view.gaze, text);
	gz_window_wake_panels(window);
	window->present_needed = true;
}

/* Whoever has changed the setting: a panel, a scene, an undone step. */
static void follow_settings(struct gz_window *window)
{
	char *wanted = window->settings.view.gaze;
	if (!wanted[0] || strcmp(wanted, window->sources->text) == 0)
		return;
	if (switch_source(window, wanted) != GZ_OK)
		copy_text(wanted, window->sources->text);
	gz_window_wake_panels(window);
	window->present_needed = true;
}

static void see_tracker(struct gz_window *window)
{
	const struct gz_status *status =
		window->source ? gz_gaze_source_status(window->source) : NULL;
	const enum gz_window_source now = gz_window_source_now(window);
	if (status && (now == GZ_WINDOW_DAEMON || now == GZ_WINDOW_POINTER))
		memcpy(window->sources->tracker_seen, status->tracker.name,
		       sizeof window->sources->tracker_seen);
}

static void turn(struct gz_window *window)
{
	follow_settings(window);
	see_tracker(window);
}

static int64_t log_time_ns(const struct gz_window_log_clock *clock)
{
	return clock->paused ? clock->base_ns
			     : clock->base_ns + gz_clock_now_ns() - clock->anchor_ns;
}

/* Its clock goes on from @p place_ns. */
static void set_log_clock(struct gz_window_log_clock *clock, int64_t place_ns)
{
	clock->base_ns = place_ns;
	clock->anchor_ns = gz_clock_now_ns();
}

void gz_window_read_source(struct gz_window *window, struct gz_gaze_reading *out_reading)
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

/* A log is read forwards: to go back is to begin anew. */
void gz_window_seek_log(struct gz_window *window, int64_t place_ns)
{
	struct gz_window_sources *sources = window->sources;
	struct gz_gaze_log_place place;
	struct gz_gaze_source *anew;
	if (!window->source || !gz_gaze_source_log_place(window->source, &place))
		return;
	if (place_ns < place.at_ns && open_source(window, &sources->choice, &anew) == GZ_OK) {
		gz_gaze_source_destroy(&window->source);
		window->source = anew;
	}
	set_log_clock(&sources->log, place_ns);
	sources->log.seeking = true;
}

/* A daemon that is known to read another tracker gives no pointer. */
static bool can_be_had(const struct gz_window_sources *sources, int source)
{
	if (source == GZ_WINDOW_POINTER && sources->tracker_seen[0])
		return strcmp(sources->tracker_seen, "pointer") == 0;
	return sources->named[source][0] != '\0';
}

static void next_source(struct gz_window *window, int number)
{
	(void)number;
	const struct gz_window_sources *sources = window->sources;
	char text[GZ_PATH_SIZE];
	int next = (int)gz_window_source_now(window);
	do {
		next = (next + 1) % GZ_WINDOW_SOURCE_COUNT;
	} while (!can_be_had(sources, next));
	memcpy(text, sources->named[next], sizeof text);
	gz_window_ask_for_gaze(window, text);
}

static void toggle_freeze(struct gz_window *window, int number)
{
	(void)number;
	window->gaze_frozen = !window->gaze_frozen;
	window->present_needed = true;
}

static const struct gz_window_action actions[] = {
	{ .letter = 'm',
	  .keys = "M",
	  .help = "next source of the gaze: daemon, mouse, log, …",
	  .run = next_source },
	{ .letter = ' ',
	  .keys = "Space",
	  .help = "freeze what is sharp, while the gaze goes on",
	  .run = toggle_freeze },
};

static enum gz_result open_part(struct gz_window *window)
{
	const char *asked = window->options->gaze_text;
	window->sources = calloc(1, sizeof *window->sources);
	if (!window->sources)
		return GZ_ERR_NO_MEM;
	copy_text(window->sources->named[GZ_WINDOW_DAEMON], "daemon");
	copy_text(window->sources->named[GZ_WINDOW_MOUSE], "mouse");
	copy_text(window->sources->named[GZ_WINDOW_POINTER], "pointer");
	copy_text(window->sources->named[GZ_WINDOW_FIXED], "0.5,0.5");
	enum gz_result r = gz_gaze_source_mouse(&window->mouse);
	return r == GZ_OK ? switch_source(window, asked[0] ? asked : "daemon") : r;
}

static void close_part(struct gz_window *window)
{
	gz_gaze_source_destroy(&window->source);
	gz_gaze_source_destroy(&window->mouse);
	gz_viewer_link_close(&window->link);
	free(window->sources);
	window->sources = NULL;
}

const struct gz_window_part gz_window_gaze_sources = {
	.name = "gaze sources",
	.title = "gaze",
	.actions = actions,
	.action_count = sizeof actions / sizeof actions[0],
	.open = open_part,
	.turn = turn,
	.close = close_part,
};
