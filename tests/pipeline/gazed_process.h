/**
 * @file
 * The real daemon as a child process with a runtime directory of its own, and what a test needs to
 * talk with it.
 */
#ifndef GZ_TESTS_PIPELINE_GAZED_PROCESS_H
#define GZ_TESTS_PIPELINE_GAZED_PROCESS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <sys/types.h>

#include "protocol/gaze.h"

/** The directories of a daemon: runtime and recordings. */
struct gazed_place {
	char directory[64];
	char recordings[80];
};

/** Make both directories. */
void gazed_place_make(struct gazed_place *place);

/** Remove both directories and their content. */
void gazed_place_remove(struct gazed_place *place);

/** A daemon. */
struct gazed_process {
	pid_t pid;
	char log[128]; /**< file with its log */
};

/** How a daemon is started. */
struct gazed_start {
	const struct gazed_place *place;
	const char *const *arguments; /**< NULL-terminated; after those that every test needs */
	uint64_t file_size_max;       /**< limit of a file's size, bytes; 0: unlimited */
	bool without_streams;         /**< with standard input, output and error closed */
	uid_t user;                   /**< user and group; 0: those of the test */
	gid_t group;                  /**< a further group, with user */
	const int *handed;            /**< sockets that a service manager hands over */
	int handed_count;
};

/**
 * Start gazed without TCP unless @p start's arguments say otherwise, with a configuration of
 * presets.
 */
void gazed_spawn(const struct gazed_start *start, struct gazed_process *out);

/** Kill the daemons that a failed test has left running. */
void gazed_kill_all(void);

/** Wait until its control socket answers; fails the test when patience ends or when it exits. */
void gazed_wait_ready(const struct gazed_place *place, struct gazed_process *process);

/** Wait until it ends. @return exit status, or -signal */
int gazed_wait_exit(struct gazed_process *process);

/** Send @p signal and wait for the end. */
int gazed_stop(struct gazed_process *process, int signal);

/** Its log so far; static buffer. */
const char *gazed_said(const struct gazed_process *process);

/** The memory of a running daemon that lies in RAM, KiB. */
long gazed_resident_kib(const struct gazed_process *process);

/** One request over the control socket; the answer in a static buffer; fails the test after
 * PATIENCE_S.
 *  @param[out] out_ms  how long it took; may be NULL */
const char *gazed_request(const struct gazed_place *place, const char *request, double *out_ms);

/** One message of the stream. */
struct received {
	char topic[80];
	size_t size;
	unsigned char *bytes;
};

/** A reader of the stream that keeps what it receives. */
struct reader {
	void *context;
	void *socket;
	struct received *messages;
	size_t count;
	size_t room;
	size_t gaze_count;       /**< gaze messages among them */
	uint64_t newest_seq;     /**< of the newest gaze */
	struct gz_status status; /**< the newest one */
	size_t status_count;
};

/** Subscribe to @p topic of the stream of @p place; works before the daemon runs. */
void reader_open(struct reader *reader, const struct gazed_place *place, const char *topic);

/** Receive one message, @p timeout_ms at most. @return whether one came */
bool reader_receive(struct reader *reader, int timeout_ms);

/** Receive until there are @p count gaze messages; fails the test if none comes for PATIENCE_S. */
void reader_receive_gaze(struct reader *reader, size_t count);

/** Receive until the daemon's recording is in @p state; fails the test after PATIENCE_S. */
void reader_wait_recording(struct reader *reader, enum gz_recording_state state);

/** Receive the remaining messages, until nothing comes for @p quiet_ms. */
void reader_drain(struct reader *reader, int quiet_ms);

/** Close the socket, and keep what was received. An open reader would connect to the next daemon.
 * */
void reader_hang_up(struct reader *reader);

/** Close and free. */
void reader_close(struct reader *reader);

#endif
