/**
 * @file
 * The language of Gazepoint Control on TCP: from bytes to records to numbers, without I/O.
 *
 * The source is "Open Gaze API by Gazepoint", version 2.8 of March 2025 (Gazepoint API.pdf,
 * gazept.com). Records are XML elements, each ended by CR LF (section 2.4). ACK and NACK answer GET
 * and SET (2.3); REC is a data record (section 5); UPDATE reports which of several trackers is
 * active (6); CAL is ignored. Coordinates are fractions of the screen, origin top left (5.4 to
 * 5.7). Eyes are metres from the camera (5.11). Pupils are millimetres in LPMM (5.16) and metres in
 * LPUPILD (5.11). Flags are 0 or 1.
 *
 * An element is read by Expat within a fixed piece of memory: whatever the text claims, Expat gets
 * GZ_GAZEPOINT_XML_ARENA bytes, and malloc() is not called. Document types are refused, so there
 * are no entities but the five of XML itself.
 */
#ifndef GZ_DRIVERS_GAZEPOINT_PROTOCOL_H
#define GZ_DRIVERS_GAZEPOINT_PROTOCOL_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/result.h"
#include "protocol/gaze.h"

/** Longest record with its line end, bytes; longer ones are skipped to their end. Chosen: a record
 * with every field has 1.2 KiB. */
#define GZ_GAZEPOINT_RECORD_MAX 4096

/** Bytes of a name in ACK and NACK with its NUL. A longer name is none that the driver asks for. */
#define GZ_GAZEPOINT_ID_SIZE 32

/** Splits the received bytes into records. Zero-initialised is empty. */
struct gz_gazepoint_framer {
	char bytes[2 * GZ_GAZEPOINT_RECORD_MAX];
	size_t begin, end; /**< the unread part of bytes */
	bool skipping;     /**< within a record that is too long */
};

/** Where to put the next bytes. @param[out] out_size  room, bytes; at least one record */
char *gz_gazepoint_framer_room(struct gz_gazepoint_framer *framer, size_t *out_size);

/** Note that @p size bytes were put there. */
void gz_gazepoint_framer_add(struct gz_gazepoint_framer *framer, size_t size);

/**
 * Take the next record.
 *
 * @param[out] out_record, out_size  without its line end, not empty; valid until the next
 *                                   gz_gazepoint_framer_room()
 * @retval GZ_OK            a record
 * @retval GZ_ERR_TIMEOUT   none is complete yet
 * @retval GZ_ERR_PROTOCOL  a record was too long; reported once for each
 */
enum gz_result gz_gazepoint_framer_next(struct gz_gazepoint_framer *framer, const char **out_record,
					size_t *out_size);

/** Bytes that Expat may use for one record. Chosen: a record of 4 KiB with the shortest attributes
 * takes about 100 KiB with Expat 2.5. */
#define GZ_GAZEPOINT_XML_ARENA (256 * 1024)

/** Memory for parsing, used again for each record. */
struct gz_gazepoint_xml;

/** Allocate the memory. @retval GZ_ERR_NO_MEM  out of memory */
enum gz_result gz_gazepoint_xml_create(struct gz_gazepoint_xml **out_xml);

/** Free and set to NULL. Accepts a pointer to NULL. */
void gz_gazepoint_xml_destroy(struct gz_gazepoint_xml **xml);

/** What a record is. */
enum gz_gazepoint_kind {
	GZ_GAZEPOINT_DATA,   /**< REC */
	GZ_GAZEPOINT_ACK,    /**< the answer to a command that was accepted */
	GZ_GAZEPOINT_NACK,   /**< the answer to a command that was refused or is unknown */
	GZ_GAZEPOINT_UPDATE, /**< another of several trackers is now active (section 6) */
	GZ_GAZEPOINT_OTHER,  /**< any other element */
};

/** One eye of a data record. Numbers that were not sent are NaN, flags false. */
struct gz_gazepoint_eye {
	double point[2];
	bool valid;
	double origin_m[3];
	double pupil_m; /**< LPUPILD */
	bool origin_valid;
	double pupil_mm; /**< LPMM */
	bool pupil_mm_valid;
};

/** Numbers of a record. The kind says which fields are filled. */
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
 * Parse one record: one XML element, empty or not closed. Attributes may come in any order; unknown
 * ones are ignored. Numbers are read alike in every locale. A number "nan" or "inf", also as
 * Windows prints it, was not measured. Does not allocate.
 *
 * @param xml           memory to parse in
 * @param record, size  as received, untrusted
 * @param[out] out_record     written on success only
 * @param[out] out_malformed  written on failure only
 * @retval GZ_ERR_PROTOCOL  SYNTAX: not exactly one XML element, a document type, or more than fits
 *                          the memory; VALUE: a field that is not a number, or no ID
 *
 * Threads: one at a time for each @p xml.
 */
enum gz_result gz_gazepoint_parse(struct gz_gazepoint_xml *xml, const char *record, size_t size,
				  struct gz_gazepoint_record *out_record,
				  enum gz_malformed *out_malformed);

/**
 * Ticks a second, from FREQ. Some versions send the bits of a double as if they were an integer, as
 * the API's own example does: "4704405731611246592" (section 3.13) is 3330093.
 *
 * @return 0 if neither reading is between 1 kHz and 9 GHz (chosen: beyond all timers)
 */
int64_t gz_gazepoint_frequency_hz(long long sent);

#endif
