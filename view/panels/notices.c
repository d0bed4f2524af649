#include "view/panels/notices.h"

#include <stdio.h>
#include <string.h>

#include "base/clock.h"
#include "view/panels/widgets.h"

/* Unscaled (chosen: a path fits, and half of a small window stays free). */
#define CORNER_WIDTH 400.0f
#define LIST_WIDTH   620.0f

enum { LIST_LINES = 14, LINE_SIZE = GZ_NOTICE_SIZE + 64 };

void gz_notices_init(struct gz_notices *notices)
{
	memset(notices, 0, sizeof *notices);
	pthread_mutex_init(&notices->lock, NULL);
}

void gz_notices_free(struct gz_notices *notices)
{
	pthread_mutex_destroy(&notices->lock);
}

static void remove_notice(struct gz_notices *notices, size_t at)
{
	notices->count--;
	memmove(&notices->notices[at], &notices->notices[at + 1],
		(notices->count - at) * sizeof notices->notices[0]);
}

/* Remove the notice with this level and text; without one, the oldest if all places are taken. */
static struct gz_notice take_out(struct gz_notices *notices, const struct gz_notice *said)
{
	for (size_t i = 0; i < notices->count; i++) {
		const struct gz_notice found = notices->notices[i];
		if (found.level != said->level || strcmp(found.text, said->text) != 0)
			continue;
		remove_notice(notices, i);
		return found;
	}
	if (notices->count == GZ_NOTICES_MAX)
		remove_notice(notices, 0);
	struct gz_notice fresh = *said;
	fresh.number = ++notices->numbers;
	return fresh;
}

static void keep_notice(struct gz_notices *notices, const struct gz_notice *said)
{
	pthread_mutex_lock(&notices->lock);
	struct gz_notice notice = take_out(notices, said);
	notice.count++;
	notice.last_ns = said->last_ns;
	notices->notices[notices->count++] = notice;
	notices->version++;
	if (notices->wake)
		notices->wake();
	pthread_mutex_unlock(&notices->lock);
}

void gz_notices_sink(void *user, enum gz_log_level level, const char *module, const char *message)
{
	const int64_t now_ns = gz_clock_now_ns();
	struct gz_notice said = { .level = level, .first_ns = now_ns, .last_ns = now_ns };
	gz_log_to_stderr(NULL, level, module, message);
	if (level < GZ_LOG_INFO)
		return;
	snprintf(said.text, sizeof said.text, "%s", message);
	keep_notice(user, &said);
}

void gz_notices_wake_by(struct gz_notices *notices, void (*wake)(void))
{
	pthread_mutex_lock(&notices->lock);
	notices->wake = wake;
	pthread_mutex_unlock(&notices->lock);
}

uint64_t gz_notices_version(struct gz_notices *notices)
{
	pthread_mutex_lock(&notices->lock);
	const uint64_t version = notices->version;
	pthread_mutex_unlock(&notices->lock);
	return version;
}

size_t gz_notices_copy(struct gz_notices *notices, struct gz_notice *out_notices, size_t room)
{
	pthread_mutex_lock(&notices->lock);
	const size_t count = notices->count < room ? notices->count : room;
	for (size_t i = 0; i < count; i++)
		out_notices[i] = notices->notices[notices->count - 1 - i];
	pthread_mutex_unlock(&notices->lock);
	return count;
}

/* ---- on the screen ---- */

static struct gz_paint paint_of_level(const struct gz_notice *notice)
{
	if (notice->level >= GZ_LOG_ERROR)
		return gz_paint_red;
	return notice->level == GZ_LOG_WARN ? gz_paint_amber : gz_paint_plain;
}

static void print_notice(const struct gz_notice *notice, const char *when, char *line, size_t size)
{
	char times[32] = "";
	if (notice->count > 1)
		snprintf(times, sizeof times, " (%u times)", notice->count);
	snprintf(line, size, "%s%s%s", when, notice->text, times);
}

size_t gz_notices_panel_draw(const struct gz_notice *notices, size_t count)
{
	const struct gz_panel_place place = { .at = GZ_PANEL_BOTTOM_RIGHT, .width = CORNER_WIDTH };
	size_t clicked = count;
	if (count == 0)
		return clicked;
	if (gz_panel_begin("##notices", &place, NULL)) {
		gz_panel_raise();
		for (size_t i = count; i-- > 0;) {
			char line[LINE_SIZE];
			print_notice(&notices[i], "", line, sizeof line);
			gz_widget_text(paint_of_level(&notices[i]), line);
			if (gz_widget_clicked())
				clicked = i;
			if (i > 0)
				gz_widget_separator();
		}
	}
	gz_panel_end();
	return clicked;
}

static void print_notice_age(int64_t age_ns, char *text, size_t size)
{
	const double s = gz_ns_to_s(age_ns);
	if (s < 60)
		snprintf(text, size, "%.0f s ago: ", s);
	else if (s < 3600)
		snprintf(text, size, "%.0f min ago: ", s / 60);
	else
		snprintf(text, size, "%.0f h ago: ", s / 3600);
}

void gz_notices_list_draw(const struct gz_notice *notices, size_t count, int64_t now_ns, bool *open)
{
	const struct gz_panel_place place = { .at = GZ_PANEL_MIDDLE, .width = LIST_WIDTH };
	if (gz_panel_begin("Messages", &place, open)) {
		gz_widget_list_begin("##all", LIST_LINES);
		if (count == 0)
			gz_widget_text(gz_paint_plain, "No messages.");
		for (size_t i = 0; i < count; i++) {
			char age[32], line[LINE_SIZE];
			print_notice_age(now_ns - notices[i].last_ns, age, sizeof age);
			print_notice(&notices[i], age, line, sizeof line);
			gz_widget_text(paint_of_level(&notices[i]), line);
		}
		gz_widget_list_end();
	}
	gz_panel_end();
}
