/**
 * @file
 * A publisher that a test holds in its hand, and the directory its socket lives in.
 */
#ifndef GZ_TESTS_CLIENT_PUBLISHER_H
#define GZ_TESTS_CLIENT_PUBLISHER_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <sys/types.h>

#include "protocol/endpoint.h"
#include "protocol/gaze.h"

/** Make a new directory and set GAZECAST_RUNTIME_DIR to it. A cmocka group setup. */
int runtime_directory_make(void **state);

/** Remove the directory and its content. A cmocka group teardown. */
int runtime_directory_remove(void **state);

struct publisher {
	void *context;
	void *socket;
};

/** Bind @p channel ("latest", "stream") in the runtime directory. Asserts. */
void publisher_open(struct publisher *publisher, const char *channel);

/** Bind @p endpoint itself. Asserts. */
void publisher_open_at(struct publisher *publisher, const char *endpoint);

/** Send one message of one frame. */
void publisher_send_frame(struct publisher *publisher, const void *bytes, size_t size);

/** Send one message of two frames, a topic and a body. */
void publisher_send(struct publisher *publisher, const char *topic, const void *bytes, size_t size);

/** Send a gaze like the latest channel. */
void publisher_send_latest(struct publisher *publisher, const struct gz_gaze *gaze);

/** Send a gaze like the stream. */
void publisher_send_gaze(struct publisher *publisher, const struct gz_gaze *gaze);

/** Send a status. */
void publisher_send_status(struct publisher *publisher, const struct gz_status *status);

/** Close the socket and zero the publisher. */
void publisher_close(struct publisher *publisher);

/** A gaze of both eyes at (x, y), numbered @p seq, sampled and sent now. */
struct gz_gaze gaze_at(uint64_t seq, float x, float y);

/**
 * A process that binds @p channel and sends a gaze each millisecond, as the latest channel does if
 * @p channel is "latest", until it is killed.
 *
 * @param first_seq  number of its first gaze
 * @return its id; it has bound when this returns
 */
pid_t publisher_process_start(const char *channel, uint64_t first_seq);

/** Kill the process and wait until it has ended. */
void publisher_process_kill(pid_t process);

#endif
