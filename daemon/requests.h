/**
 * @file
 * The main thread: answers requests in Pupil Remote's protocol, passes on messages from clients,
 * and waits for signals and for the end of a replay. Every request is answered little more than
 * GZ_REQUESTS_PATIENCE_MS after it came, at the latest.
 */
#ifndef GZ_DAEMON_REQUESTS_H
#define GZ_DAEMON_REQUESTS_H

#include "base/log.h"
#include "base/result.h"
#include "daemon/config.h"
#include "daemon/inlet.h"
#include "daemon/network.h"
#include "daemon/publisher.h"
#include "daemon/recorder.h"
#include "drivers/pointer/pointer_driver.h"

/** How long an answer waits for the requested action to be done, ms; after that the answer is sent
 * while the action goes on. Chosen: well below the 100 ms within which clients get an answer. */
#define GZ_REQUESTS_PATIENCE_MS 50

/** What the request server works with; all borrowed. */
struct gz_requests_parts {
	const struct gz_config *config;
	void *context;                        /**< ZeroMQ */
	const char *directory;                /**< the runtime directory */
	const struct gz_network *network;     /**< how sockets are bound; used at creation only */
	const struct gz_publisher *publisher; /**< for its ports; used at creation only */
	const struct gz_recorder *recorder;
	struct gz_inlet_counts *inlet_counts;
	struct gz_pointer_feed *pointer; /**< receives the pointer positions that viewers send */
	const struct gz_log *log;
};

/** The request server. One thread. */
struct gz_requests;

/**
 * Bind the control socket, in the runtime directory and, with TCP, at network.control; the inlet;
 * and GZ_COMMAND_ENDPOINT (service.h).
 *
 * @param parts  copied; what it points to is borrowed
 * @param[out] out_requests  owned by the caller: gz_requests_destroy()
 * @retval GZ_ERR_NO_MEM  no memory
 * @retval GZ_ERR_IO      no socket; logged
 * @return else as gz_network_bind() and gz_inlet_create()
 */
enum gz_result gz_requests_create(const struct gz_requests_parts *parts,
				  struct gz_requests **out_requests);

/**
 * Answer requests until @p signal_fd, a signalfd, becomes readable, or until a replay ends if the
 * configuration has exit_at_end.
 *
 * @retval GZ_OK      ended as asked
 * @retval GZ_ERR_IO  the sockets cannot be polled
 * @return else why the service had to stop; it was logged
 */
enum gz_result gz_requests_run(struct gz_requests *requests, int signal_fd);

/** Tell the service to quit. Waits while the queue of commands is full. */
void gz_requests_quit_service(struct gz_requests *requests);

/** The control socket's TCP port, 0 without TCP. If the settings ask for port 0, it is the one that
 * the system chose. */
int gz_requests_port(const struct gz_requests *requests);

/** Close the sockets, free and set *requests to NULL. Accepts a pointer to NULL. */
void gz_requests_destroy(struct gz_requests **requests);

#endif
