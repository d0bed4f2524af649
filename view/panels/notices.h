/**
 * @file
 * What has been logged lately, kept for people who do not look at a terminal. A log's sink that
 * passes on to stderr, so that both say the same.
 */
#ifndef GZ_VIEW_PANELS_NOTICES_H
#define GZ_VIEW_PANELS_NOTICES_H

#include <pthread.h>
#include <stddef.h>
#include <stdint.h>

#include "base/log.h"

/** Kept at most; older ones make room. Chosen: more than anyone reads. */
#define GZ_NOTICES_MAX 64
/** Longest text with its end; a longer one loses its end. Chosen: two paths and what is wrong. */
#define GZ_NOTICE_SIZE 1024

/** One message. */
struct gz_notice {
	enum gz_log_level level;
	unsigned count;   /**< so often it was said */
	uint64_t number;  /**< of its kind, from 1: stays when it is said again */
	int64_t first_ns; /**< host time when it was said first, and last */
	int64_t last_ns;
	char text[GZ_NOTICE_SIZE];
};

/** What was said, in the order in which it was said last. */
struct gz_notices {
	pthread_mutex_t lock;
	void (*wake)(void);
	uint64_t version;
	uint64_t numbers;
	size_t count;
	struct gz_notice notices[GZ_NOTICES_MAX];
};

/** Make it empty. */
void gz_notices_init(struct gz_notices *notices);

/** Free what it holds. */
void gz_notices_free(struct gz_notices *notices);

/** A log's sink: @p user is a struct gz_notices. All goes to stderr, info and above is kept; what
 *  is kept already counts up instead. Threads: any. */
void gz_notices_sink(void *user, enum gz_log_level level, const char *module, const char *message);

/** Call @p wake, on whichever thread logs, when something is kept; NULL: nothing. Once this
 *  returns the one before is called no more. */
void gz_notices_wake_by(struct gz_notices *notices, void (*wake)(void));

/** Grows with each message that is kept. Threads: any. */
uint64_t gz_notices_version(struct gz_notices *notices);

/** Copy the newest @p room of them, the newest first. Threads: any. @return how many */
size_t gz_notices_copy(struct gz_notices *notices, struct gz_notice *out_notices, size_t room);

#endif
