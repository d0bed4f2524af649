/**
 * @file
 * The thread that serves samples: reads the tracker, takes each sample through the pipeline,
 * publishes what comes of it and hands it to the recorder. Takes commands (command.h).
 */
#ifndef GZ_DAEMON_SERVICE_H
#define GZ_DAEMON_SERVICE_H

#include "base/log.h"
#include "base/result.h"
#include "daemon/config.h"
#include "daemon/notify.h"
#include "daemon/publisher.h"
#include "daemon/recorder.h"
#include "drivers/pointer/pointer_feed.h"

/** Longest wait for a sample before commands are looked at, ms. Chosen: an answer comes well within
 * the 100 ms of a request. */
#define GZ_SERVICE_WAIT_MS 10

/** How often commands are looked for while samples come, ms. Chosen: looking costs a system call,
 * which is not spent on every sample of a fast tracker. */
#define GZ_SERVICE_COMMANDS_MS 5

/** How often connections and states are looked at, ms. */
#define GZ_SERVICE_CARE_MS 50

/** How often the status is sent at least, ms. */
#define GZ_SERVICE_STATUS_MS 1000

/** What a service works with; all borrowed and its alone until it is destroyed. */
struct gz_service_parts {
	const struct gz_config *config;
	void *context; /**< ZeroMQ; GZ_COMMAND_ENDPOINT is bound in it */
	struct gz_publisher *publisher;
	struct gz_recorder *recorder;
	struct gz_pointer_feed *pointer; /**< lent to the driver */
	struct gz_notify *notify;        /**< told that samples are served */
	const struct gz_log *log;
};

/** A service. */
struct gz_service;

/**
 * Open the tracker.
 *
 * @return GZ_OK, or a result after one logged line where the tracker's settings cannot work
 */
enum gz_result gz_service_create(const struct gz_service_parts *parts,
				 struct gz_service **out_service);

/**
 * Begin a recording before the first sample.
 *
 * @param fd    as for gz_recorder_start()
 * @param path  of the file
 */
enum gz_result gz_service_record(struct gz_service *service, int fd, const char *path);

/** Start the thread. It runs until it is told GZ_COMMAND_QUIT. */
enum gz_result gz_service_start(struct gz_service *service);

/** Wait for the thread to end, if it was started, free and set to NULL. Accepts a pointer to NULL.
 */
void gz_service_destroy(struct gz_service **service);

#endif
