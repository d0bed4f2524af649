/**
 * @file
 * What Gazepoint Control says over TCP: bytes to records to numbers, no I/O.
 *
 * The language is "Open Gaze API by Gazepoint", version 2.8 of March 2025 (Gazepoint API.pdf,
 * gazept.com): XML elements, each ended by CR LF (section 2.4). ACK and NACK answer GET and SET
 * (2.3); REC is a data record (section 5); UPDATE tells of several trackers (6); CAL is passed
 * over. Coordinates are fractions of the screen, origin top left (5.4 to 5.7); eyes are metres from
 * the camera (5.11); pupils are millimetres in LPMM (5.16) and metres in LPUPILD (5.11); flags are
 * 0 or 1.
 */
#ifndef GZ_DRIVERS_GAZEPOINT_PROTOCOL_H
#define GZ_DRIVERS_GAZEPOINT_PROTOCOL_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/result.h"
#include "drivers/gazepoint/gazepoint_xml.h"
#include "protocol/gaze.h"

/** Longest record with its line end, bytes; longer ones are skipped to their end. Chosen: with
 * every field there is, one has 1.2 KiB. */
#define GZ_GAZEPOINT_RECORD_MAX 4096

/** Bytes of a name in ACK and NACK with its NUL; longer ones do not fit any that is asked for. */
#define GZ_GAZEPOINT_ID_SIZE 32

/** Cuts what arrives into records. Zero-initialised is empty. */
struct gz_gazepoint_framer {
	char bytes[2 * GZ_GAZEPOINT_RECORD_MAX];
	size_t begin, end; /**< what is unread of bytes */
	bool skipping;     /**< within a record that is too long */
};

/** Where to put the next bytes. @param[out] out_size  how many fit, at least one record's */
char *gz_gazepoint_framer_room(struct gz_gazepoint_framer *framer, size_t *out_size);

/** @p size bytes were put there. */
void gz_gazepoint_framer_add(struct gz_gazepoint_framer *framer, size_t size);

/**
 * Take the next record.
 *
 * @param[out] out_record, out_size  without its line end, not empty; valid until the next
 *                                   gz_gazepoint_framer_room()
 * @retval GZ_OK            here it is
 * @retval GZ_ERR_TIMEOUT   none is whole yet
 * @retval GZ_ERR_PROTOCOL  a record was too long; told once for each
 */
enum gz_result gz_gazepoint_framer_next(struct gz_gazepoint_framer *framer, const char **out_record,
					size_t *out_size);

/** What a record is. */
enum gz_gazepoint_kind {
	GZ_GAZEPOINT_DATA,   /**< REC */
	GZ_GAZEPOINT_ACK,    /**< what was asked for is so */
	GZ_GAZEPOINT_NACK,   /**< what was asked for is refused or unknown */
	GZ_GAZEPOINT_UPDATE, /**< another of several trackers is the active one now (section 6) */
	GZ_GAZEPOINT_OTHER,  /**< any other element */
};

/** One eye of a data record; numbers that were not sent are NaN, flags false. */
struct gz_gazepoint_eye {
	double point[2];
	bool valid;
	double origin_m[3];
	double pupil_m; /**< LPUPILD */
	bool origin_valid;
	double pupil_mm; /**< LPMM */
	bool pupil_mm_valid;
};

/** Numbers of a record. Which fields hold something follows from the kind. */
struct gz_gazepoint_record {
	enum gz_gazepoint_kind kind;
	/* DATA */
	bool has_counter, has_tick;
	long long counter;
	long long tick;
	double time_s; /**< NaN if not sent */
	double best[2];
	bool best_valid;
	bool has_best;
	bool has_eye[GZ_EYE_COUNT];
	struct gz_gazepoint_eye eye[GZ_EYE_COUNT];
	/* ACK and NACK; UPDATE has width and height only */
	char id[GZ_GAZEPOINT_ID_SIZE];
	char value[GZ_NAME_SIZE]; /**< empty if not sent or too long */
	long long frequency;      /**< FREQ as sent; 0 if not sent */
	double width, height;     /**< NaN if not sent */
	double rate_hz;           /**< NaN if not sent */
};

/**
 * Parse one record. Attributes may come in any order; those of other names are passed over. Numbers
 * are read the same in every locale; a number that is "nan" or "inf", with the decorations that
 * Windows prints, was not measured. Does not allocate.
 *
 * @param xml          memory to parse in
 * @param record, size as received, untrusted
 * @param[out] out_record    written on success only
 * @param[out] out_malformed written on failure only
 * @retval GZ_ERR_PROTOCOL  SYNTAX: not one XML element; VALUE: a field that is no number, or no ID
 */
enum gz_result gz_gazepoint_parse(struct gz_gazepoint_xml *xml, const char *record, size_t size,
				  struct gz_gazepoint_record *out_record,
				  enum gz_malformed *out_malformed);

/**
 * Ticks a second out of what FREQ says. Some versions send the bits of a double as if they were an
 * integer, as the API's own example does: "4704405731611246592" (section 3.13) is 3330093.
 *
 * @return 0 where neither reading is between 1 kHz and 9 GHz (chosen: beyond all timers)
 */
int64_t gz_gazepoint_frequency_hz(long long sent);

#endif
