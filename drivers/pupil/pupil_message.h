/**
 * @file
 * Pupil's messages as samples. Bytes to meaning; no I/O, no clock.
 *
 * A gaze message (https://docs.pupil-labs.com/core/developer/, "Gaze Datum Format") has one point,
 * norm_pos, in the picture of the scene camera, and in base_data the pupils of one or two eyes. A
 * surface message ("Surface Datum Format") maps gaze onto a surface, for instance the screen, and
 * refers to each gaze message by its timestamp. Both eyes then look at the one point.
 *
 * Another gazed sends the same messages, with the eyes' own points and numbers that count up.
 */
#ifndef GZ_DRIVERS_PUPIL_MESSAGE_H
#define GZ_DRIVERS_PUPIL_MESSAGE_H

#include <stddef.h>

#include "base/result.h"
#include "protocol/gaze.h"
#include "protocol/wire.h"

/** Gaze messages remembered for the surface messages that refer to them. Chosen: more than a second
 * of Pupil Core's 400 a second; surface messages follow within a frame of the scene camera. */
#define GZ_PUPIL_MEMORY 512

/** Most entries of a surface message that are taken. Chosen: as many as are remembered. */
#define GZ_PUPIL_ENTRIES_MAX GZ_PUPIL_MEMORY

/** What a gaze message says. */
struct gz_pupil_gaze {
	struct gz_sample sample; /**< device_ns is Pupil time; seq and host_ns are not filled */
	uint64_t number;         /**< the sender's own, from another gazed; 0 where it has none */
	bool own_points;         /**< the eyes' points are their own, not the common one */
};

/**
 * Read a gaze message.
 *
 * @param confidence  samples and eyes below it are invalid, [0, 1]
 * @param[out] out_gaze    written on success only
 * @param[out] out_reason  on failure: what was wrong
 * @retval GZ_ERR_PROTOCOL  no gaze message
 */
enum gz_result gz_pupil_read_gaze(const void *bytes, size_t size, double confidence,
				  struct gz_pupil_gaze *out_gaze, enum gz_malformed *out_reason);

/** Newest gaze messages. Zero-initialised is empty. */
struct gz_pupil_memory {
	size_t count; /**< taken in so far; the newest is at (count - 1) % GZ_PUPIL_MEMORY */
	struct gz_pupil_gaze gaze[GZ_PUPIL_MEMORY];
};

/** Remember a gaze message in place of the oldest. */
void gz_pupil_remember(struct gz_pupil_memory *memory, const struct gz_pupil_gaze *gaze);

/** Entries of a surface message that wait to be read. Zero-initialised is none. */
struct gz_pupil_entries {
	size_t count;
	size_t next;
	struct gz_surface_gaze entry[GZ_PUPIL_ENTRIES_MAX];
};

/**
 * Take in a surface message in place of the last one.
 *
 * @param[out] out_reason  on failure: what was wrong; GZ_MALFORMED_LONG for too many entries
 * @retval GZ_ERR_PROTOCOL  no surface message; there are no entries then
 */
enum gz_result gz_pupil_read_surface(const void *bytes, size_t size,
				     struct gz_pupil_entries *entries,
				     enum gz_malformed *out_reason);

/**
 * The next entry as a sample: its point and time, and of the gaze message it refers to the pupils.
 *
 * @param confidence  as gz_pupil_read_gaze() has it
 * @param[out] out_gaze  written only on GZ_OK
 * @retval GZ_ERR_END  there are no more
 */
enum gz_result gz_pupil_next_entry(struct gz_pupil_entries *entries,
				   const struct gz_pupil_memory *memory, double confidence,
				   struct gz_pupil_gaze *out_gaze);

/** The order of samples. Zero-initialised is the start state. */
struct gz_pupil_order {
	bool begun;
	int64_t pupil_ns; /**< of the newest */
	uint64_t number;
	uint64_t steps;   /**< seen since the period is followed */
	double period_ns; /**< that nine in ten steps are not above */
};

/**
 * Whether @p gaze is newer than the one before it, and how many are missing between: by the
 * sender's numbers where it has them, else by its time. Pupil Core's steps are uneven, because two
 * cameras run free, so that only a step far above most of them counts as a loss.
 *
 * @param[out] out_missing  written on success only
 * @retval GZ_ERR_PROTOCOL  not newer: sent before, or out of order
 */
enum gz_result gz_pupil_order_step(struct gz_pupil_order *order, const struct gz_pupil_gaze *gaze,
				   uint32_t *out_missing);

/** Pupil's clock was set: what comes next is newer whatever its time. */
void gz_pupil_order_restart(struct gz_pupil_order *order);

#endif
