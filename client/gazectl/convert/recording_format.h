/**
 * @file
 * Formats of recordings: readers and writers. A reader pushes the header and then the records, one
 * by one, into a sink; a writer is a sink. Neither keeps a recording in memory.
 */
#ifndef GZ_CLIENT_GAZECTL_CONVERT_RECORDING_FORMAT_H
#define GZ_CLIENT_GAZECTL_CONVERT_RECORDING_FORMAT_H

#include <stdbool.h>
#include <stddef.h>

#include "base/log.h"
#include "base/result.h"
#include "client/gazectl/convert/text_lines.h"
#include "filter/offline.h"
#include "protocol/gaze_log.h"

/** The destination of a recording. The header comes once, before the first record. */
struct gz_recording_sink {
	void *user;
	/** Take the header. A result other than GZ_OK ends the reading with that result, which must
	 * not be GZ_ERR_END or GZ_ERR_FULL; the sink has logged it. */
	enum gz_result (*header)(void *user, const struct gz_gaze_log_header *header);
	/** Take a record. Results as for the header. */
	enum gz_result (*record)(void *user, const struct gz_gaze_log_record *record);
};

/** Unit of the times of a table. */
enum gz_table_time_unit { GZ_TABLE_S, GZ_TABLE_MS, GZ_TABLE_US, GZ_TABLE_NS };

/** What the points of a table are in: fractions of the display, pixels or mm, from its top left. */
enum gz_table_points { GZ_TABLE_FRACTION, GZ_TABLE_PX, GZ_TABLE_MM };

/** What the columns of a table mean, for the reader "table". Zero-initialised: no columns. */
struct gz_convert_table {
	const char *columns; /**< "MEANING=COLUMN;…"; see read_table.c */
	const char *where;   /**< "COLUMN=VALUE": only lines with this value; empty: all */
	enum gz_table_time_unit time_unit;
	enum gz_table_points points;
};

/** What the user gives because the file may not contain it. */
struct gz_convert_settings {
	int display_px[2];    /**< 0: from the file */
	double display_mm[2]; /**< 0: from the file */
	double distance_mm;   /**< 0: from the file */
	double rate_hz;       /**< nominal; 0: from the file */
	struct gz_convert_table table;
	const char *name; /**< of the file, for messages */
	const struct gz_log *log;
};

/** What was read. */
struct gz_convert_counts {
	uint64_t samples;
	uint64_t skipped; /**< lines without a sample that could be read */
};

/** A format that can be read. Tables are const and have static storage. */
struct gz_recording_reader {
	const char *name; /**< as in "--from name" */
	const char *help; /**< one line */
	/** Whether the first line of a file that is not empty looks like this format. */
	bool (*recognises)(const char *line);
	/**
	 * Read to the end.
	 *
	 * @param counts  counted up
	 * @retval GZ_ERR_FORMAT       another format, or something necessary is missing; logged
	 * with the line
	 * @retval GZ_ERR_UNSUPPORTED  this format, but without gaze on a display; logged with the
	 *                             remedy
	 * @retval GZ_ERR_IO, GZ_ERR_NO_MEM  not logged
	 * @return else the result of the sink, if that is not GZ_OK
	 */
	enum gz_result (*read)(struct gz_text_lines *lines,
			       const struct gz_convert_settings *settings,
			       const struct gz_recording_sink *sink,
			       struct gz_convert_counts *counts);
};

/** All readers, NULL-terminated: pupil, eyelink, tobii, smi, arff, table. */
extern const struct gz_recording_reader *const gz_recording_readers[];

/** Find a reader by name, or NULL. */
const struct gz_recording_reader *gz_recording_reader_find(const char *name);

/** Find the reader that recognises @p line, or NULL. */
const struct gz_recording_reader *gz_recording_reader_recognise(const char *line);

extern const struct gz_recording_reader gz_recording_reader_pupil;
extern const struct gz_recording_reader gz_recording_reader_eyelink;
extern const struct gz_recording_reader gz_recording_reader_tobii;
extern const struct gz_recording_reader gz_recording_reader_smi;
extern const struct gz_recording_reader gz_recording_reader_arff;
extern const struct gz_recording_reader gz_recording_reader_table;

/** A recording being written. */
struct gz_recording_output;

/** A format that can be written. Tables are const and have static storage. */
struct gz_recording_writer {
	const char *name;   /**< as in "--to name" */
	const char *ending; /**< of the name to write to */
	/** Ending of the files that are written instead, "*" for the eye; NULL: there is one file,
	 *  of the given name. */
	const char *files;
	const char *help; /**< one line */
	/**
	 * Begin to write. Files are created when the header comes.
	 *
	 * @param path           of the file to write; further files get names made from it
	 * @param overwrite      whether existing files may be replaced
	 * @param[out] out_sink  filled; end it with close()
	 * @retval GZ_ERR_INVAL   @p path has another ending; logged
	 * @retval GZ_ERR_NO_MEM  no memory
	 */
	enum gz_result (*open)(const char *path, bool overwrite, const struct gz_log *log,
			       struct gz_recording_sink *out_sink);
	/**
	 * Optional: write what the eye did too. Called before the header comes.
	 *
	 * @param labels  of the samples that will come; stay valid until close()
	 */
	void (*label)(struct gz_recording_sink *sink, const struct gz_offline_labels *labels);
	/**
	 * End writing and free the sink's user.
	 *
	 * @param complete  false: remove what was written
	 * @retval GZ_ERR_IO  the disk is full or failing; what was written was removed; logged
	 */
	enum gz_result (*close)(struct gz_recording_sink *sink, bool complete);
};

/** All writers, NULL-terminated: gzl, bids, csv. */
extern const struct gz_recording_writer *const gz_recording_writers[];

/** Find a writer by name, or NULL. */
const struct gz_recording_writer *gz_recording_writer_find(const char *name);

/** Find the writer by the ending of @p path, or NULL. */
const struct gz_recording_writer *gz_recording_writer_of(const char *path);

extern const struct gz_recording_writer gz_recording_writer_gzl;
extern const struct gz_recording_writer gz_recording_writer_csv;
extern const struct gz_recording_writer gz_recording_writer_bids;

/** The header of a log converted from another format: names, rate, and the display if all of it is
 * known. */
struct gz_gaze_log_header gz_recording_header(const struct gz_convert_settings *settings,
					      const char *tracker);

/** A point on the normalised display area. NaN in both coordinates if either is not finite or
 * beyond ±1000 (chosen: no tracker reports that, and a float holds it). */
struct gz_point gz_recording_point(double x, double y);

#endif
