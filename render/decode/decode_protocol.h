/**
 * @file
 * What a decoder process says to the program that started it, and in which descriptors.
 *
 * Decoders of other projects run in a process of their own. Its arguments are the process id of the
 * program that started it, the name of the format, the path, what to choose of it (may be empty),
 * the time point from 0, the range of the series: its least and greatest number with a blank
 * between, or empty if it is not known, and how to resample it ("off", "linear", "nearest"). It
 * writes messages of one size to GZ_DECODE_FD_MESSAGES: any number of lines and steps, a header,
 * more of them, one end. After the header it waits for an answer of one byte, then writes the
 * voxels into the file that the answer names.
 *
 * Some formats list instead what there is to choose from: "dicom-list" always does, "dicom-choose"
 * if there are several series. Such a decoder sends no header but all series first, then what it
 * finds out about them, pictures or why one cannot be shown, and ends with GZ_DECODE_LISTED.
 */
#ifndef GZ_RENDER_DECODE_PROTOCOL_H
#define GZ_RENDER_DECODE_PROTOCOL_H

#include <assert.h>
#include <stdint.h>

/** Descriptors of the decoder. The first three are /dev/null, for what libraries print. Nothing
 *  else is open. */
enum gz_decode_fd {
	GZ_DECODE_FD_ANSWERS = 3,  /**< a pipe to read from: one byte, enum gz_decode_answer */
	GZ_DECODE_FD_MESSAGES = 4, /**< a pipe to write to */
	GZ_DECODE_FD_MEMORY = 5,   /**< a memfd; it has its size once the answer names it */
	GZ_DECODE_FD_SCRATCH = 6,  /**< a file on the disk; open only if there is one */
	GZ_DECODE_FD_END = 7,      /**< the first descriptor that is never open */
};

/** Where the voxels go. */
enum gz_decode_answer {
	GZ_DECODE_INTO_MEMORY = 'm',
	GZ_DECODE_INTO_SCRATCH = 's',
};

/** Kinds of messages. */
enum gz_decode_kind {
	GZ_DECODE_STEP = 1,   /**< share, and in detail the number of steps so far */
	GZ_DECODE_LINE = 2,   /**< a line for the log: text; detail is its enum gz_log_level */
	GZ_DECODE_HEADER = 3, /**< header; once */
	GZ_DECODE_ENDED = 4,  /**< the last one; detail is an enum gz_result. If it is GZ_OK, header
				 again, whose slope, intercept, time points and range of the series
				 may have changed */
	GZ_DECODE_SERIES = 5, /**< series: the next one of the list, counted from 0 */
	GZ_DECODE_PICTURE = 6, /**< picture: some rows of that of series number detail */
	GZ_DECODE_REFUSED = 7, /**< series number detail cannot be shown after all: why, in text */
	GZ_DECODE_LISTED = 8,  /**< the last one, in place of GZ_DECODE_ENDED: that was the list */
};

/** The volume that follows. Its voxels are turned to RAS+, x varies fastest. */
struct gz_decode_header {
	int32_t dims[3];
	uint32_t type;     /**< enum gz_voxel_type */
	uint32_t oriented; /**< 1: it is known where right, front and up are; else 0 */
	uint32_t colour;   /**< enum gz_volume_colour; the colours follow the voxels as
			      gz_volume_place_colours() says */
	double spacing[3];
	double slope, intercept;
	double number_range[2]; /**< of a series: its range as in struct gz_volume; known at the end
				 */
	int32_t time_points;    /**< 0 or 1: no series; known at the end */
	uint16_t labels;        /**< 1: values are numbers of things; else 0 */
	uint8_t spacing_assumed; /**< 1: the file does not state the spacing; else 0 */
	uint8_t modality;        /**< enum gz_modality */
};

/** Size of a line with its NUL, bytes. */
#define GZ_DECODE_TEXT_SIZE 920

/** Pixels along an edge of a series' picture, rows in one message, and messages for all rows. */
#define GZ_DECODE_PICTURE_EDGE  72
#define GZ_DECODE_PICTURE_ROWS  12
#define GZ_DECODE_PICTURE_BANDS (GZ_DECODE_PICTURE_EDGE / GZ_DECODE_PICTURE_ROWS)

/** One series of a list. Texts are UTF-8 in one line and end with a NUL; empty: not known. */
struct gz_decode_series {
	int32_t slices;        /**< above 0; 0: not known */
	char uid[68];          /**< what chooses it; at most 64 bytes (PS3.5, 9) */
	char date[12];         /**< of the study: "2024-03-31" */
	char modality[20];     /**< "CT" */
	char patient[200];     /**< name */
	char description[200]; /**< of the series */
	char reason[416];      /**< why it cannot be shown; empty: it can, as far as is known */
};

/** Some rows of a picture, grey, the topmost row first. What lies beside it is 0. */
struct gz_decode_picture {
	uint32_t band; /**< its first row is this times GZ_DECODE_PICTURE_ROWS */
	uint8_t pixels[GZ_DECODE_PICTURE_ROWS * GZ_DECODE_PICTURE_EDGE];
};

/** One message, in the byte order of the machine. What a kind does not use is 0. A pipe takes it
 *  whole or not at all, whichever thread writes it (pipe(7), PIPE_BUF). */
struct gz_decode_message {
	uint32_t kind;
	int32_t detail;
	double share; /**< of the work that is done, 0 to 1 */
	struct gz_decode_header header;
	union {
		char text[GZ_DECODE_TEXT_SIZE];
		struct gz_decode_series series;
		struct gz_decode_picture picture;
	};
};

static_assert(sizeof(struct gz_decode_message) == 1024, "no padding, less than PIPE_BUF");
static_assert(sizeof(struct gz_decode_series) == GZ_DECODE_TEXT_SIZE, "no padding");
static_assert(GZ_DECODE_PICTURE_BANDS * GZ_DECODE_PICTURE_ROWS == GZ_DECODE_PICTURE_EDGE,
	      "bands fill the picture");

#endif
