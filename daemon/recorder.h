/**
 * @file
 * Recordings: their names, the ring through which records reach the recorder, and the recorder,
 * which writes the gaze log on a thread of its own so that a slow disk delays no sample.
 *
 * The thread that reads the tracker hands records over through the ring, without locking or
 * allocating. If the ring is full, the missing samples become a gap record. A record reaches the
 * file within GZ_RECORDER_DRAIN_MS, also while the disk is busy, and the disk within a second,
 * unless that is too slow.
 */
#ifndef GZ_DAEMON_RECORDER_H
#define GZ_DAEMON_RECORDER_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/log.h"
#include "base/result.h"
#include "protocol/gaze_log.h"

/*
 * Names. They come from anyone who reaches the control socket, so they must not leave the directory
 * for recordings, and no recording may overwrite another.
 */

/** Whether @p name consists of 1 to 64 of the characters A-Z a-z 0-9 . _ - */
bool gz_recording_name_valid(const char *name);

/**
 * Create a new file for a recording: DIRECTORY/NAME.gzl, 0600, because gaze is biometric data.
 *
 * @param name  valid by gz_recording_name_valid(); ".gzl" is appended unless it is there; empty: a
 *              name made from the present time in UTC
 * @param[out] out_fd    open for writing; the caller closes it
 * @param[out] out_path  GZ_PATH_SIZE bytes
 * @param[out] message   on failure, what is wrong and what to do: one line of at most
 *                       @p message_size bytes with its NUL
 * @retval GZ_ERR_INVAL   @p name is not valid
 * @retval GZ_ERR_BUSY    a file of this name exists
 * @retval GZ_ERR_FULL    the path is too long
 * @retval GZ_ERR_ACCESS  the directory may not be written
 * @retval GZ_ERR_IO      the file cannot be created for another reason
 */
enum gz_result gz_recording_create(const char *directory, const char *name, int *out_fd,
				   char *out_path, char *message, size_t message_size);

/*
 * The ring: a queue of log records between one thread that pushes and one that pops. Neither ever
 * waits, locks or allocates.
 */

/** A record in the ring, and the number of the recording to which it belongs. */
struct gz_ring_slot {
	uint32_t session;
	struct gz_gaze_log_record record;
};

/** The queue. */
struct gz_ring;

/**
 * Create an empty ring.
 *
 * @param capacity  slots; a power of two, at least 2
 * @param[out] out_ring  owned by the caller: gz_ring_destroy()
 * @retval GZ_ERR_INVAL   @p capacity is not such a number
 * @retval GZ_ERR_NO_MEM  no memory
 */
enum gz_result gz_ring_create(size_t capacity, struct gz_ring **out_ring);

/** Free slots, as seen by the pushing thread; there may be more by now. */
size_t gz_ring_room(const struct gz_ring *ring);

/** Append a copy of @p record. @return false if the ring is full. Threads: the pushing one. */
bool gz_ring_push(struct gz_ring *ring, uint32_t session, const struct gz_gaze_log_record *record);

/** The oldest slot, or NULL if the ring is empty; valid until gz_ring_pop(). Threads: the popping
 *  one. */
const struct gz_ring_slot *gz_ring_front(struct gz_ring *ring);

/** Remove the oldest slot; the ring must not be empty. Threads: the popping one. */
void gz_ring_pop(struct gz_ring *ring);

/** Free the ring and set *ring to NULL; neither thread may still use it. Accepts a pointer to NULL.
 */
void gz_ring_destroy(struct gz_ring **ring);

/*
 * The recorder.
 */

/** Records held while the disk is slow. Chosen: 4 s at 2000 Hz; 6 MB. A power of two. */
#define GZ_RECORDER_RING 8192

/** How often the ring is emptied into the file, ms. Chosen: rarely enough to cost nothing. */
#define GZ_RECORDER_DRAIN_MS 50

/** How often the file is synced to the disk, ms. Chosen: together with the drain and the sync
 * itself, a power failure costs less than a second of the recording. */
#define GZ_RECORDER_SYNC_MS 800

/** What a recorder is doing. */
struct gz_recorder_status {
	enum gz_recording_state state;
	bool finishing;             /**< state is ON, but the recording has been asked to end */
	uint64_t samples;           /**< in the file */
	char error[GZ_REASON_SIZE]; /**< reason, if state is FAILED */
};

/** A recorder. */
struct gz_recorder;

/**
 * Create a recorder and start its thread.
 *
 * @param log  borrowed; may be NULL
 * @param[out] out_recorder  owned by the caller: gz_recorder_destroy()
 * @retval GZ_ERR_NO_MEM  no memory or no thread; a failure other than the recorder's own memory is
 *                        logged
 * @retval GZ_ERR_IO      no event descriptors; logged
 */
enum gz_result gz_recorder_create(const struct gz_log *log, struct gz_recorder **out_recorder);

/** An eventfd that becomes readable whenever the state changes; the thread that polls it reads its
 * 8 bytes. Owned by the recorder. */
int gz_recorder_event_fd(const struct gz_recorder *recorder);

/** Get the state. Threads: any. */
void gz_recorder_get_status(const struct gz_recorder *recorder, struct gz_recorder_status *out);

/*
 * Only the thread that reads the tracker may call the functions from here to gz_recorder_stop().
 */

/**
 * Begin a recording.
 *
 * @param fd      open for writing, empty; on success the recorder owns it from now on
 * @param path    of the file, for messages
 * @param header  copied
 * @retval GZ_ERR_BUSY  a recording is running or being finished
 */
enum gz_result gz_recorder_start(struct gz_recorder *recorder, int fd, const char *path,
				 const struct gz_gaze_log_header *header);

/** Copy the path of the newest recording's file into @p path, which has GZ_PATH_SIZE bytes. */
void gz_recorder_get_path(const struct gz_recorder *recorder, char *path);

/** Whether a recording is running, so that records are accepted. */
bool gz_recorder_running(const struct gz_recorder *recorder);

/** Whether half of the ring is free. A source that can wait for that loses nothing. */
bool gz_recorder_has_room(const struct gz_recorder *recorder);

/** Hand over a record; ignored while no recording is running. Never waits. */
void gz_recorder_push(struct gz_recorder *recorder, const struct gz_gaze_log_record *record);

/** End the recording after the records handed over so far; returns at once. Ignored while no
 *  recording is running. */
void gz_recorder_stop(struct gz_recorder *recorder);

/** End a running recording, wait until it is on the disk, free the recorder and set *recorder to
 * NULL. Accepts a pointer to NULL. Threads: any, once no other thread uses the recorder. */
void gz_recorder_destroy(struct gz_recorder **recorder);

#endif
