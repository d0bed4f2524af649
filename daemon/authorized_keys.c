#include "daemon/authorized_keys.h"

#include <stdio.h>
#include <string.h>
#include <time.h>

#include "base/clock.h"
#include "protocol/key_file.h"

#define GZ_LOG_MODULE "security"

/* Chosen: some kernel ticks. */
#define FRESH_NS (50 * GZ_NS_PER_MS)

static bool same_time(const struct timespec *a, const struct timespec *b)
{
	return a->tv_sec == b->tv_sec && a->tv_nsec == b->tv_nsec;
}

/* The change time also tells of a write that left size and modification time as they were, and of
 * chmod. */
static bool same_file(const struct stat *a, const struct stat *b)
{
	return a->st_dev == b->st_dev && a->st_ino == b->st_ino && a->st_size == b->st_size &&
	       same_time(&a->st_mtim, &b->st_mtim) && same_time(&a->st_ctim, &b->st_ctim);
}

static enum gz_result read_again(struct gz_authorized_keys *keys, const struct gz_log *log)
{
	enum gz_result result =
		gz_key_file_read_list(keys->path, GZ_KEY_LIST_AUTHORIZED, log, &keys->list);
	if (result != GZ_OK)
		keys->list.count = 0;
	return result;
}

/* Whether the file may be written once more without a sign of it: file systems' times move on by
 * kernel ticks, at most 10 ms apart. */
static bool is_fresh(const struct stat *status)
{
	struct timespec now;
	clock_gettime(CLOCK_REALTIME, &now);
	int64_t age_ns = (now.tv_sec - status->st_ctim.tv_sec) * GZ_NS_PER_S + now.tv_nsec -
			 status->st_ctim.tv_nsec;
	return age_ns < FRESH_NS;
}

/* @return whether there was something new, whose first reading ended with *out_result */
static bool look(struct gz_authorized_keys *keys, enum gz_result *out_result)
{
	struct stat status = { 0 };
	if (stat(keys->path, &status) != 0)
		status = (struct stat) { 0 };
	bool same = same_file(&status, &keys->read);
	if (same && !keys->fresh)
		return false;
	keys->read = status;
	keys->fresh = is_fresh(&status);
	*out_result = read_again(keys, same ? NULL : keys->log);
	return !same;
}

enum gz_result gz_authorized_keys_open(struct gz_authorized_keys *keys, const char *path,
				       const struct gz_log *log)
{
	enum gz_result result = GZ_ERR_NOT_FOUND;
	*keys = (struct gz_authorized_keys) { .log = log };
	if ((size_t)snprintf(keys->path, sizeof keys->path, "%s", path) >= sizeof keys->path)
		return GZ_ERR_FULL;
	look(keys, &result);
	if (result == GZ_ERR_NOT_FOUND) {
		gz_warn(log,
			"%s is not there, so no client is let in; add the line that gazectl keygen "
			"--client prints on the other machine",
			path);
		return GZ_OK;
	}
	return result;
}

const struct gz_known_key *gz_authorized_keys_find(struct gz_authorized_keys *keys, const char *key)
{
	enum gz_result result;
	if (look(keys, &result)) {
		if (result == GZ_OK)
			gz_info(keys->log, "%s has changed: %zu keys", keys->path,
				keys->list.count);
		else
			gz_warn(keys->log, "no client is let in until %s is there and in order",
				keys->path);
	}
	return gz_key_list_find_key(&keys->list, key);
}
