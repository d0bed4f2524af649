/**
 * @file
 * The main thread's work: answers requests in Pupil Remote's letters, and waits for signals and for
 * the end of a replay. Every request is answered within GZ_REQUESTS_PATIENCE_MS and some.
 */
#ifndef GZ_DAEMON_REQUESTS_H
#define GZ_DAEMON_REQUESTS_H

#include "base/log.h"
#include "base/result.h"
#include "daemon/config.h"
#include "daemon/network.h"
#include "daemon/publisher.h"
#include "daemon/recorder.h"
#include "drivers/pointer/pointer_feed.h"

/** How long an answer waits for what was asked to have happened, ms; then it says that it goes on.
 * Chosen: well below the 100 ms in which a client may count on an answer. */
#define GZ_REQUESTS_PATIENCE_MS 50

/** What requests work with, borrowed. */
struct gz_requests_parts {
	const struct gz_config *config;
	void *context;                        /**< ZeroMQ */
	const char *directory;                /**< the runtime directory */
	const struct gz_network *network;     /**< how to bind; needed at creation alone */
	const struct gz_publisher *publisher; /**< its ports are asked for once, at creation */
	const struct gz_recorder *recorder;
	struct gz_pointer_feed *pointer; /**< takes what viewers tell of their pointers */
	const struct gz_log *log;
};

/** The request server. One thread. */
struct gz_requests;

/**
 * Bind the control socket, in the runtime directory and, where the configuration has TCP, at
 * network.control; and GZ_COMMAND_ENDPOINT.
 *
 * @return GZ_OK, GZ_ERR_IO, GZ_ERR_NO_MEM, or as gz_network_bind(); logged
 */
enum gz_result gz_requests_create(const struct gz_requests_parts *parts,
				  struct gz_requests **out_requests);

/**
 * Answer requests until @p signal_fd, a signalfd, becomes readable, or until a replay ends and the
 * configuration says to leave then.
 *
 * @return GZ_OK, or the reason for which the service could not go on
 */
enum gz_result gz_requests_run(struct gz_requests *requests, int signal_fd);

/** Tell the service to end. */
void gz_requests_quit_service(struct gz_requests *requests);

/** Close and set to NULL. Accepts a pointer to NULL. */
void gz_requests_destroy(struct gz_requests **requests);

#endif
