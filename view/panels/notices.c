#include "view/panels/notices.h"

#include <stdio.h>
#include <string.h>

#include "base/clock.h"

void gz_notices_init(struct gz_notices *notices)
{
	memset(notices, 0, sizeof *notices);
	pthread_mutex_init(&notices->lock, NULL);
}

void gz_notices_free(struct gz_notices *notices)
{
	pthread_mutex_destroy(&notices->lock);
}

static void remove_at(struct gz_notices *notices, size_t at)
{
	notices->count--;
	memmove(&notices->notices[at], &notices->notices[at + 1],
		(notices->count - at) * sizeof notices->notices[0]);
}

/* The one with this text leaves its place; else the oldest does where there is no room. */
static struct gz_notice take_out(struct gz_notices *notices, const struct gz_notice *said)
{
	for (size_t i = 0; i < notices->count; i++) {
		const struct gz_notice found = notices->notices[i];
		if (found.level != said->level || strcmp(found.text, said->text) != 0)
			continue;
		remove_at(notices, i);
		return found;
	}
	if (notices->count == GZ_NOTICES_MAX)
		remove_at(notices, 0);
	struct gz_notice fresh = *said;
	fresh.number = ++notices->numbers;
	return fresh;
}

static void keep(struct gz_notices *notices, const struct gz_notice *said)
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
	keep(user, &said);
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
