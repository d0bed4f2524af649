/**
 * @file
 * What a decoder process says to the program that started it, and in which descriptors.
 *
 * Decoders of other projects run in a process of their own. Its arguments are the process id of the
 * program that started it, the name of the format, the path, what to choose of it (may be empty),
 * the time point from 0, and the range of the series: its least and greatest number with a blank
 * between, or empty if it is not known. It writes messages of one size to GZ_DECODE_FD_MESSAGES:
 * any number of lines and steps, a header, more of them, one end. After the header it waits for an
 * answer of one byte, then writes the voxels into the file that the answer names.
 */
#ifndef GZ_RENDER_DECODE_PROTOCOL_H
#define GZ_RENDER_DECODE_PROTOCOL_H

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
	uint32_t unused;        /**< 0 */
};

/** Size of a line with its NUL, bytes. */
#define GZ_DECODE_TEXT_SIZE 920

/** One message, in the byte order of the machine. What a kind does not use is 0. A pipe takes it
 *  whole or not at all, whichever thread writes it (pipe(7), PIPE_BUF). */
struct gz_decode_message {
	uint32_t kind;
	int32_t detail;
	double share; /**< of the work that is done, 0 to 1 */
	struct gz_decode_header header;
	char text[GZ_DECODE_TEXT_SIZE];
};

_Static_assert(sizeof(struct gz_decode_message) == 1024, "no padding, less than PIPE_BUF");

#endif
