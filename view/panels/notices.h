/**
 * @file
 * Messages on the screen: a log's sink that keeps the latest messages and passes all of them on to
 * stderr, and the panels that show them. The panels are drawn inside a frame of panels/widgets.h.
 */
#ifndef GZ_VIEW_PANELS_NOTICES_H
#define GZ_VIEW_PANELS_NOTICES_H

#include <pthread.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/log.h"

/** Most notices that are kept; the oldest makes room for a new one. Chosen: more than anyone reads.
 */
#define GZ_NOTICES_MAX 64
/** Size of a text with its NUL, bytes; longer texts are cut. Chosen: two paths and what is wrong.
 */
#define GZ_NOTICE_SIZE 1024

/** One message, said once or more often. */
struct gz_notice {
	enum gz_log_level level;
	unsigned count;   /**< how often it was said */
	uint64_t number;  /**< identifies level and text, from 1; stays when it is said again */
	int64_t first_ns; /**< host time when it was said first */
	int64_t last_ns;  /**< host time when it was said last */
	char text[GZ_NOTICE_SIZE];
};

/** The notices, in the order in which they were said last. */
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

/** Free what it holds. No other thread may use it any more. */
void gz_notices_free(struct gz_notices *notices);

/** A log's sink; @p user is a struct gz_notices. Writes every message to stderr and keeps those
 * from GZ_LOG_INFO up; a message that is kept already is counted instead. Threads: any. */
void gz_notices_sink(void *user, enum gz_log_level level, const char *module, const char *message);

/** Call @p wake on the thread that logs, under the lock, each time something is kept; NULL: do not.
 *  Once this returns, the previous @p wake is not called any more. */
void gz_notices_wake_by(struct gz_notices *notices, void (*wake)(void));

/** A number that grows with each message that is kept. Threads: any. */
uint64_t gz_notices_version(struct gz_notices *notices);

/** Copy up to @p room notices, the newest first. Threads: any. @return how many were copied */
size_t gz_notices_copy(struct gz_notices *notices, struct gz_notice *out_notices, size_t room);

/** Draw @p count notices in the lower right corner, the first one lowest. @return index of the one
 *  that was clicked, else @p count */
size_t gz_notices_panel_draw(const struct gz_notice *notices, size_t count);

/**
 * Draw the list of all notices in the middle, each with its age.
 *
 * @param now_ns       host time
 * @param[in,out] open set to false when the panel's cross is clicked
 */
void gz_notices_list_draw(const struct gz_notice *notices, size_t count, int64_t now_ns,
			  bool *open);

#endif
