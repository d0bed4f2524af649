/**
 * @file
 * Messages of Pupil Capture as samples: from bytes to numbers, without I/O and without a clock.
 *
 * A gaze message (https://docs.pupil-labs.com/core/developer/, "Gaze Datum Format") has one point,
 * norm_pos, in the picture of the scene camera, and in base_data the pupils of one or two eyes. A
 * surface message ("Surface Datum Format") maps gaze to a surface, for instance the screen, and
 * refers to each gaze message by its timestamp. Both eyes then look at the one point.
 *
 * Another gazed sends the same messages, with a point for each eye and numbers that count up.
 */
#ifndef GZ_DRIVERS_PUPIL_MESSAGE_H
#define GZ_DRIVERS_PUPIL_MESSAGE_H

#include <stddef.h>

#include "base/result.h"
#include "protocol/gaze.h"
#include "protocol/wire.h"

/** Gaze messages kept for the surface messages that refer to them. Chosen: more than a second of
 * Pupil Core's 400 a second; surface messages follow within a frame of the scene camera. */
#define GZ_PUPIL_MEMORY 512

/** Most entries of a surface message that are accepted. Chosen: as many as gaze messages are kept.
 */
#define GZ_PUPIL_ENTRIES_MAX GZ_PUPIL_MEMORY

/** Content of a gaze message. */
struct gz_pupil_gaze {
	struct gz_sample sample; /**< device_ns is Pupil time; seq and host_ns are not set */
	uint64_t number;         /**< sequence number of another gazed; 0 if there is none */
	bool own_points;         /**< each eye has its own point, not the common one */
};

/**
 * Read a gaze message.
 *
 * @param confidence  limit below which samples and eyes are invalid, [0, 1]
 * @param[out] out_gaze    written on success only
 * @param[out] out_reason  what is wrong; written on failure only
 * @retval GZ_ERR_PROTOCOL  not a gaze message
 */
enum gz_result gz_pupil_read_gaze(const void *bytes, size_t size, double confidence,
				  struct gz_pupil_gaze *out_gaze, enum gz_malformed *out_reason);

/** Newest gaze messages. Zero-initialised is empty. */
struct gz_pupil_memory {
	size_t count; /**< messages so far; the newest is at (count - 1) % GZ_PUPIL_MEMORY */
	struct gz_pupil_gaze gaze[GZ_PUPIL_MEMORY];
};

/** Keep a gaze message, in place of the oldest. */
void gz_pupil_remember(struct gz_pupil_memory *memory, const struct gz_pupil_gaze *gaze);

/** Entries of a surface message that wait to be read. Zero-initialised is none. */
struct gz_pupil_entries {
	size_t count;
	size_t next;
	struct gz_surface_gaze entry[GZ_PUPIL_ENTRIES_MAX];
};

/**
 * Read a surface message, in place of the last one.
 *
 * @param[out] out_reason  what is wrong, GZ_MALFORMED_LONG for too many entries; written on failure
 *                         only
 * @retval GZ_ERR_PROTOCOL  not a surface message; there are no entries then
 */
enum gz_result gz_pupil_read_surface(const void *bytes, size_t size,
				     struct gz_pupil_entries *entries,
				     enum gz_malformed *out_reason);

/**
 * Turn the next entry into a sample: point and time from the entry, pupils from the gaze message
 * that it refers to.
 *
 * @param confidence  limit as in gz_pupil_read_gaze()
 * @param[out] out_gaze  written only on GZ_OK
 * @retval GZ_ERR_END  there are no more
 */
enum gz_result gz_pupil_next_entry(struct gz_pupil_entries *entries,
				   const struct gz_pupil_memory *memory, double confidence,
				   struct gz_pupil_gaze *out_gaze);

/** Order of the samples. Zero-initialised is the start state. */
struct gz_pupil_order {
	bool begun;
	int64_t pupil_ns; /**< of the newest */
	uint64_t number;
	uint64_t steps;   /**< steps from which period_ns was learnt */
	double period_ns; /**< nine in ten steps are not longer */
};

/**
 * Check that @p gaze is newer than the last one and count what is missing between them: by the
 * numbers of the sender if it has them, else by time. The steps of Pupil Core are uneven, because
 * two cameras run free, so only a step far longer than most counts as a loss.
 *
 * @param[out] out_missing  written on success only
 * @retval GZ_ERR_PROTOCOL  not newer: a duplicate, or out of order
 */
enum gz_result gz_pupil_order_step(struct gz_pupil_order *order, const struct gz_pupil_gaze *gaze,
				   uint32_t *out_missing);

/** Restart because Pupil's clock was set: the next message is newer whatever its time. */
void gz_pupil_order_restart(struct gz_pupil_order *order);

#endif
