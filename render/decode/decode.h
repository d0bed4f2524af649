/**
 * @file
 * Decoders of other projects, each file in a process of its own: started, watched and ended here.
 *
 * A file that makes a decoder crash, hang or take too much memory costs one line in the log. What
 * the process may do is in render/decode/child/confine.h; docs/security.md tells it to users.
 */
#ifndef GZ_RENDER_DECODE_H
#define GZ_RENDER_DECODE_H

#include <stdbool.h>
#include <stddef.h>
#include <sys/types.h>

#ifdef __cplusplus
extern "C" {
#endif

#include "base/log.h"
#include "base/result.h"
#include "render/decode/decode_protocol.h"

/** Time without progress after which a decoder is ended unless a job says otherwise, ms. Chosen:
 *  the largest slice, 16384 pixels squared in JPEG 2000, takes about a minute. */
#define GZ_DECODE_PATIENCE_MS 180000

/** Memory that a decoder may use beside the voxels, bytes. Chosen: heads of 65536 files and a few
 *  frames of the largest size. Address space counts, so that it is more than will be used. */
#define GZ_DECODE_WORK_BYTES ((size_t)4 << 30)

/** Lines of one decoder that are logged; later ones are counted. */
#define GZ_DECODE_LINES_MAX 64

/** Messages after which a decoder counts as broken. Chosen: it sends 20 steps a second at most, so
 *  this is nearly three hours. */
#define GZ_DECODE_MESSAGES_MAX 200000

/** Most series of a list. Chosen: a medium holds some hundreds. */
#define GZ_DECODE_SERIES_MAX 1024

/** Who takes a list. Its functions are called on the thread of gz_decode_run(), with messages that
 *  have been checked: texts end and are clean, and numbers are in range. */
struct gz_decode_listener {
	void *user; /**< passed to the functions below */
	/** Takes the next series. @return GZ_OK, or why decoding ends */
	enum gz_result (*series)(void *user, const struct gz_decode_series *series);
	/** Takes rows of the picture of a series that was sent before: band below
	 *  GZ_DECODE_PICTURE_BANDS. A hostile decoder may leave some out, or send them twice. */
	void (*picture)(void *user, uint32_t index, const struct gz_decode_picture *picture);
	/** Takes why a series that was sent before cannot be shown after all. */
	void (*refused)(void *user, uint32_t index, const char *why);
};

/** Where the voxels of a header go. */
struct gz_decode_place {
	size_t bytes;    /**< above 0 */
	bool in_scratch; /**< into the job's scratch file, which has that size by now */
};

/** One file to decode. */
struct gz_decode_job {
	const char *format; /**< "dicom" */
	const char *path;   /**< a file or a folder */
	const char *choice; /**< what to choose of it; NULL: nothing */
	int time_point;     /**< of a series, from 0 */
	/** Least and greatest number of the series, finite. Borrowed; NULL: not known. */
	const double *number_range;
	/** What to do with slices that do not lie evenly: a name of gz_resampling_names[]; NULL:
	 *  "off" */
	const char *resampling;
	const char *program; /**< the decoder's path; NULL: gz_decode_find_program() */
	int patience_ms;     /**< 0: GZ_DECODE_PATIENCE_MS */
	int scratch_fd;      /**< a writable file for the voxels; -1: none. Borrowed */
	void *user;          /**< passed to the functions below */
	/** Reports progress, about 20 times a second. Returns false to stop. */
	bool (*goes_on)(void *user, double share);
	/** Checks a header in full and says where its voxels go. Logs why it refuses one. */
	enum gz_result (*accept)(void *user, const struct gz_decode_header *header,
				 struct gz_decode_place *out_place);
	/** Takes a list, if the format makes one; NULL: a list is refused. Borrowed. */
	const struct gz_decode_listener *listener;
	const struct gz_log *log;
};

/** What was decoded. */
struct gz_decoded {
	/** As it was accepted, but for slope and intercept: finite, the first not 0. What it says
	 *  of a series is not checked. */
	struct gz_decode_header header;
	void *voxels;  /**< the bytes asked for, mapped to be read; munmap() frees them */
	size_t mapped; /**< bytes */
};

/**
 * Decode a file. Blocks until the decoder has ended; nothing of it is left then, whatever happens.
 *
 * @param[out] out_decoded  written on GZ_OK; the caller frees its voxels
 * @retval GZ_ERR_NOT_FOUND, GZ_ERR_IO, GZ_ERR_FORMAT, GZ_ERR_UNSUPPORTED, GZ_ERR_INVAL
 *                           the decoder's own result; logged by it or here
 * @retval GZ_ERR_PROTOCOL   it crashed, or its messages are no valid ones; logged
 * @retval GZ_ERR_TIMEOUT    no progress for the patience; logged
 * @retval GZ_ERR_NO_MEM     memory or descriptors ran out; logged
 * @retval GZ_ERR_ACCESS     the decoder is not installed or cannot be started; logged
 * @retval GZ_ERR_CANCELLED  goes_on() said so; not logged
 * @retval GZ_ERR_CHOICE     the listener has a list of at least one series, and there are no
 *                           voxels; not logged
 * @return else what accept() or the listener returned
 *
 * Threads: any, several at a time. The calling thread must live until it returns: if it ends, the
 * decoder is killed.
 */
enum gz_result gz_decode_run(const struct gz_decode_job *job, struct gz_decoded *out_decoded);

/**
 * Find the decoder program: the environment variable GAZECAST_DECODER (unless the running program
 * has raised rights), then libexec/gazecast/gazedecode in the folder above that of the running
 * program, or in one of the two above that one, which is how the tree of a build looks. A program
 * that is not found by the variable must belong to root or to the owner of the running program.
 *
 * @retval GZ_ERR_NOT_FOUND  not logged
 */
enum gz_result gz_decode_find_program(char *out_path, size_t size);

#ifdef __cplusplus
}
#endif

#endif
