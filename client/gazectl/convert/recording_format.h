/**
 * @file
 * Recordings of other programs: what reads them, what writes them. A reader pushes the header and
 * then record by record into a sink; a writer is a sink. None keeps a recording in memory.
 */
#ifndef GZ_CLIENT_GAZECTL_CONVERT_RECORDING_FORMAT_H
#define GZ_CLIENT_GAZECTL_CONVERT_RECORDING_FORMAT_H

#include <stdbool.h>
#include <stddef.h>

#include "base/log.h"
#include "base/result.h"
#include "client/gazectl/convert/text_lines.h"
#include "protocol/gaze_log.h"

/** Where a recording goes. The header comes once, before the first record. */
struct gz_recording_sink {
	void *user;
	/** @retval GZ_OK  else reading ends with this result, which is not GZ_ERR_END or
	 * GZ_ERR_FULL; logged by the sink */
	enum gz_result (*header)(void *user, const struct gz_gaze_log_header *header);
	/** As header. */
	enum gz_result (*record)(void *user, const struct gz_gaze_log_record *record);
};

/** What the user knows and a file may not tell. */
struct gz_convert_settings {
	int display_px[2];    /**< 0: as the file says */
	double display_mm[2]; /**< 0: as the file says */
	double distance_mm;   /**< 0: as the file says */
	double rate_hz;       /**< nominal; 0: as the file says */
	const char *name;     /**< of the file, for messages and as the tracker's name */
	const struct gz_log *log;
};

/** What came of reading. */
struct gz_convert_counts {
	uint64_t samples;
	uint64_t skipped; /**< lines that hold no sample that could be read; the first ones are
			     logged */
};

/** A format that can be read. Tables are const and have static storage. */
struct gz_recording_reader {
	const char *name; /**< as in "--from name" */
	const char *help; /**< one line */
	/** Whether the file's first line with text on it looks like one of this kind. */
	bool (*recognises)(const char *line);
	/**
	 * Read to the end.
	 *
	 * @retval GZ_ERR_FORMAT       not of this kind, or without what is needed; logged with line
	 * @retval GZ_ERR_UNSUPPORTED  of this kind, but of no use here; logged with the remedy
	 * @retval GZ_ERR_IO, GZ_ERR_NO_MEM  logged
	 * @return what the sink answers, where that is no GZ_OK
	 */
	enum gz_result (*read)(struct gz_text_lines *lines,
			       const struct gz_convert_settings *settings,
			       const struct gz_recording_sink *sink,
			       struct gz_convert_counts *counts);
};

/** All of them, NULL-terminated: pupil, eyelink, tobii. */
extern const struct gz_recording_reader *const gz_recording_readers[];

/** Find a reader by name, or NULL. */
const struct gz_recording_reader *gz_recording_reader_find(const char *name);

/** Find the reader that recognises @p line, or NULL. */
const struct gz_recording_reader *gz_recording_reader_recognise(const char *line);

extern const struct gz_recording_reader gz_recording_reader_pupil;
extern const struct gz_recording_reader gz_recording_reader_eyelink;
extern const struct gz_recording_reader gz_recording_reader_tobii;

/** A recording being written. */
struct gz_recording_output;

/** A format that can be written. Tables are const and have static storage. */
struct gz_recording_writer {
	const char *name;   /**< as in "--to name" */
	const char *ending; /**< of the files that it writes */
	const char *help;   /**< one line */
	/**
	 * Begin. Files are not made before the header comes.
	 *
	 * @param path      of the file to write; the names of others are made from it
	 * @param overwrite whether files that are there may be replaced
	 * @retval GZ_ERR_INVAL   @p path does not end as it must; logged
	 * @retval GZ_ERR_NO_MEM  logged
	 */
	enum gz_result (*open)(const char *path, bool overwrite, const struct gz_log *log,
			       struct gz_recording_sink *out_sink);
	/**
	 * End and free; the sink's user is gone then.
	 *
	 * @param complete  false removes what was written
	 * @retval GZ_ERR_IO  the disk is full or failing: what was written was removed; logged
	 */
	enum gz_result (*close)(struct gz_recording_sink *sink, bool complete);
};

/** All of them, NULL-terminated: gzl, csv, bids. */
extern const struct gz_recording_writer *const gz_recording_writers[];

/** Find a writer by name, or NULL. */
const struct gz_recording_writer *gz_recording_writer_find(const char *name);

/** Find the writer whose ending @p path has, or NULL. */
const struct gz_recording_writer *gz_recording_writer_of(const char *path);

extern const struct gz_recording_writer gz_recording_writer_gzl;
extern const struct gz_recording_writer gz_recording_writer_csv;
extern const struct gz_recording_writer gz_recording_writer_bids;

/** The header that a foreign file leads to: names, rate, and the display if all of it is known. */
struct gz_gaze_log_header gz_recording_header(const struct gz_convert_settings *settings,
					      const char *tracker);

/** A point in parts of the display; NaN in both where either is not finite, or farther from it than
 * a thousand displays (chosen: no tracker says so, and a float holds it). */
struct gz_point gz_recording_point(double x, double y);

#endif
