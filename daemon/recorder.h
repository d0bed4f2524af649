/**
 * @file
 * Writes the gaze log on a thread of its own, so that a slow disk delays no sample. The thread that
 * reads the tracker hands records over by a ring, without a lock and without allocating; where the
 * ring is full, the missing samples become a gap record.
 *
 * A record reaches the file after GZ_RECORDER_DRAIN_MS at most, and the disk after a second.
 */
#ifndef GZ_DAEMON_RECORDER_H
#define GZ_DAEMON_RECORDER_H

#include <stdbool.h>
#include <stdint.h>

#include "base/log.h"
#include "base/result.h"
#include "protocol/gaze_log.h"

/** Records held while the disk is slow. Chosen: 4 s at 2000 Hz; 6 MB. A power of two. */
#define GZ_RECORDER_RING 8192

/** How often the ring is emptied into the file, ms. Chosen: rarely enough to cost nothing. */
#define GZ_RECORDER_DRAIN_MS 50

/** How often the file is synced to the disk, ms. Chosen: with the drain and the sync itself, what
 * a power failure takes stays below one second. */
#define GZ_RECORDER_SYNC_MS 800

/** What a recorder is doing. */
struct gz_recorder_status {
	enum gz_recording_state state;
	bool finishing;             /**< state is ON, but the end has been asked for */
	uint64_t samples;           /**< in the file */
	char error[GZ_REASON_SIZE]; /**< why it FAILED */
};

/** A recorder. */
struct gz_recorder;

/**
 * Make a recorder and start its thread.
 *
 * @param log  borrowed; may be NULL
 */
enum gz_result gz_recorder_create(const struct gz_log *log, struct gz_recorder **out_recorder);

/**
 * A file descriptor that becomes readable whenever the state changes; whoever polls it reads its
 * 8 bytes away. Owned by the recorder.
 */
int gz_recorder_event_fd(const struct gz_recorder *recorder);

/** What it is doing. Threads: any. */
void gz_recorder_get_status(const struct gz_recorder *recorder, struct gz_recorder_status *out);

/*
 * The rest is for one thread: the one that reads the tracker.
 */

/**
 * Begin a recording.
 *
 * @param fd      open for writing, empty; the recorder's from now on, but where this is refused
 * @param path    of the file, for messages
 * @param header  copied
 * @retval GZ_ERR_BUSY  one is running or being finished
 */
enum gz_result gz_recorder_start(struct gz_recorder *recorder, int fd, const char *path,
				 const struct gz_gaze_log_header *header);

/** Path of the newest recording's file, into @p path of GZ_PATH_SIZE bytes. */
void gz_recorder_get_path(const struct gz_recorder *recorder, char *path);

/** Whether records are taken. */
bool gz_recorder_running(const struct gz_recorder *recorder);

/** Whether half of the ring is free: a source that can wait need not lose anything. */
bool gz_recorder_has_room(const struct gz_recorder *recorder);

/** Hand over a record; nothing happens while no recording runs. Never waits. */
void gz_recorder_push(struct gz_recorder *recorder, const struct gz_gaze_log_record *record);

/** End the recording behind the records handed over; returns at once. Nothing happens while none
 *  runs. */
void gz_recorder_stop(struct gz_recorder *recorder);

/** End a running recording, wait until it is on the disk, free and set to NULL. Accepts a pointer
 * to NULL. Threads: any, once no other uses it. */
void gz_recorder_destroy(struct gz_recorder **recorder);

#endif
