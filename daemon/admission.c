#include "daemon/admission.h"

#include <stdio.h>
#include <string.h>
#include <time.h>
#include <zmq.h>

#include "base/clock.h"
#include "protocol/key.h"

#define GZ_LOG_MODULE "security"

/* A curve25519 public key. */
enum { KEY_BYTES = 32 };

enum { FRAME_VERSION, FRAME_ID, FRAME_DOMAIN, FRAME_ADDRESS, FRAME_IDENTITY, FRAME_MECHANISM };
enum { FRAME_KEY = GZ_ZAP_FRAMES - 1 };

/* File systems take their times from kernel ticks, which are at most 10 ms apart. Chosen: a few of
 * them. */
#define FRESH_NS (50 * GZ_NS_PER_MS)

static bool frame_is(const struct gz_zap_frame *frame, const char *text)
{
	return frame->size == strlen(text) && memcmp(frame->bytes, text, frame->size) == 0;
}

/* The address is logged, so it must not hold control characters that steer a terminal. */
static void copy_printable_address(const struct gz_zap_frame *frame, char out[GZ_ADDRESS_SIZE])
{
	const unsigned char *bytes = frame->bytes;
	size_t size = frame->size < GZ_ADDRESS_SIZE ? frame->size : GZ_ADDRESS_SIZE - 1;
	for (size_t i = 0; i < size; i++)
		out[i] = bytes[i] > ' ' && bytes[i] < 0x7f ? (char)bytes[i] : '?';
	if (size == 0)
		out[size++] = '?';
	out[size] = '\0';
}

enum gz_result gz_zap_parse(const struct gz_zap_frame *frames, size_t count,
			    struct gz_zap_request *out)
{
	out->id_size = 0;
	if (count <= FRAME_ID || frames[FRAME_ID].size > sizeof out->id)
		return GZ_ERR_PROTOCOL;
	out->id_size = frames[FRAME_ID].size;
	if (out->id_size > 0)
		memcpy(out->id, frames[FRAME_ID].bytes, out->id_size);
	if (count <= FRAME_MECHANISM)
		return GZ_ERR_PROTOCOL;
	if (!frame_is(&frames[FRAME_VERSION], "1.0") ||
	    !frame_is(&frames[FRAME_MECHANISM], "CURVE"))
		return GZ_ERR_ACCESS;
	if (count != GZ_ZAP_FRAMES)
		return GZ_ERR_PROTOCOL;
	if (frames[FRAME_KEY].size != KEY_BYTES ||
	    !zmq_z85_encode(out->key, frames[FRAME_KEY].bytes, KEY_BYTES))
		return GZ_ERR_ACCESS;
	copy_printable_address(&frames[FRAME_ADDRESS], out->address);
	return GZ_OK;
}

static bool same_time(const struct timespec *a, const struct timespec *b)
{
	return a->tv_sec == b->tv_sec && a->tv_nsec == b->tv_nsec;
}

/* The change time also shows chmod, and a write that restored the size and modification time. */
static bool same_file(const struct stat *a, const struct stat *b)
{
	return a->st_dev == b->st_dev && a->st_ino == b->st_ino && a->st_size == b->st_size &&
	       same_time(&a->st_mtim, &b->st_mtim) && same_time(&a->st_ctim, &b->st_ctim);
}

static enum gz_result read_authorized_keys(struct gz_authorized_keys *keys,
					   const struct gz_log *log)
{
	enum gz_result result =
		gz_key_file_read_list(keys->path, GZ_KEY_LIST_AUTHORIZED, log, &keys->list);
	if (result != GZ_OK)
		keys->list.count = 0;
	return result;
}

/* Whether the file changed so recently that a further write might leave its times unchanged. */
static bool just_written(const struct stat *status)
{
	struct timespec now;
	clock_gettime(CLOCK_REALTIME, &now);
	int64_t age_ns = (now.tv_sec - status->st_ctim.tv_sec) * GZ_NS_PER_S + now.tv_nsec -
			 status->st_ctim.tv_nsec;
	return age_ns < FRESH_NS;
}

/* Read the file if it may have changed. @return whether it visibly has; *out_result is then the
 * result of reading it */
static bool refresh_authorized_keys(struct gz_authorized_keys *keys, enum gz_result *out_result)
{
	struct stat status = { 0 };
	if (stat(keys->path, &status) != 0)
		status = (struct stat) { 0 };
	bool same = same_file(&status, &keys->read);
	if (same && !keys->fresh)
		return false;
	keys->read = status;
	keys->fresh = just_written(&status);
	*out_result = read_authorized_keys(keys, same ? NULL : keys->log);
	return !same;
}

enum gz_result gz_authorized_keys_open(struct gz_authorized_keys *keys, const char *path,
				       const struct gz_log *log)
{
	enum gz_result result = GZ_ERR_NOT_FOUND;
	*keys = (struct gz_authorized_keys) { .log = log };
	if ((size_t)snprintf(keys->path, sizeof keys->path, "%s", path) >= sizeof keys->path)
		return GZ_ERR_FULL;
	refresh_authorized_keys(keys, &result);
	if (result == GZ_ERR_NOT_FOUND) {
		gz_warn(log,
			"%s does not exist, so no client is let in; run gazectl keygen --client on "
			"the other machine and put the line that it prints into this file",
			path);
		return GZ_OK;
	}
	return result;
}

const struct gz_known_key *gz_authorized_keys_find(struct gz_authorized_keys *keys, const char *key)
{
	enum gz_result result;
	if (refresh_authorized_keys(keys, &result)) {
		if (result == GZ_OK)
			gz_info(keys->log, "%s has changed: %zu keys", keys->path,
				keys->list.count);
		else
			gz_warn(keys->log, "no client is let in until %s can be read and is valid",
				keys->path);
	}
	return gz_key_list_find_key(&keys->list, key);
}

static bool is_free(const struct gz_address_limit_entry *entry, int64_t now_ns)
{
	return !entry->address[0] || now_ns >= entry->limit.next_ns;
}

static struct gz_address_limit_entry *find_address(struct gz_address_limit *limit,
						   const char *address, int kind)
{
	for (int i = 0; i < GZ_ADDRESS_LIMIT_COUNT; i++) {
		struct gz_address_limit_entry *entry = &limit->entries[i];
		if (entry->kind == kind && strcmp(entry->address, address) == 0)
			return entry;
	}
	return NULL;
}

/* The free entry whose minute ended longest ago, so that a frequent caller keeps its count. */
static struct gz_address_limit_entry *oldest_free_entry(struct gz_address_limit *limit,
							int64_t now_ns)
{
	struct gz_address_limit_entry *oldest = NULL;
	for (int i = 0; i < GZ_ADDRESS_LIMIT_COUNT; i++) {
		struct gz_address_limit_entry *entry = &limit->entries[i];
		if (is_free(entry, now_ns) &&
		    (!oldest || entry->limit.next_ns < oldest->limit.next_ns))
			oldest = entry;
	}
	return oldest;
}

bool gz_address_limit_pass(struct gz_address_limit *limit, const char *address, int kind,
			   int64_t now_ns, uint64_t *out_dropped)
{
	char key[GZ_ADDRESS_SIZE];
	snprintf(key, sizeof key, "%s", address[0] ? address : "?");
	struct gz_address_limit_entry *entry = find_address(limit, key, kind);
	if (!entry) {
		entry = oldest_free_entry(limit, now_ns);
		if (!entry)
			return gz_ratelimit_pass(&limit->others, now_ns, GZ_ADDRESS_LIMIT_NS,
						 out_dropped);
		*entry = (struct gz_address_limit_entry) { .kind = kind };
		memcpy(entry->address, key, sizeof key);
	}
	return gz_ratelimit_pass(&entry->limit, now_ns, GZ_ADDRESS_LIMIT_NS, out_dropped);
}
