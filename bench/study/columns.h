/**
 * @file
 * The columns of a study: what each counted frame has, in the order of frames.csv. Writing,
 * reading, summaries, report and docs/gazebench.md all follow this table: a new quantity is a field
 * of struct gz_study_row, a name of enum gz_study_column_id and a row in columns.c.
 */
#ifndef GZ_BENCH_STUDY_COLUMNS_H
#define GZ_BENCH_STUDY_COLUMNS_H

#include <stdbool.h>
#include <stdio.h>

#include "bench/study/study.h"

/** Places in gz_study_columns[]. */
enum gz_study_column_id {
	GZ_COLUMN_PLAN,
	GZ_COLUMN_CAST,
	GZ_COLUMN_RECONSTRUCT,
	GZ_COLUMN_FRAME,
	GZ_COLUMN_GPU,
	GZ_COLUMN_RAYS,
	GZ_COLUMN_SAMPLES,
	GZ_COLUMN_CONVERGED, /**< the first of nine: the fields of struct gz_study_errors */
	GZ_COLUMN_STANDARD = GZ_COLUMN_CONVERGED + 9, /**< the first of nine */
	GZ_COLUMN_FLICKER = GZ_COLUMN_STANDARD + 9,
	GZ_COLUMN_REFERENCE,
	GZ_COLUMN_PREPARE,
	GZ_COLUMN_TURNING,
	GZ_COLUMN_CAMERA_PATH,
	GZ_STUDY_COLUMNS,
};

/** What values a column has. */
enum gz_study_column_type {
	GZ_COLUMN_TIME,  /**< double, 0 or more; NaN: not measured */
	GZ_COLUMN_COUNT, /**< uint64_t */
	GZ_COLUMN_ERROR, /**< double, may be infinite; NaN: not measured */
};

/** How the frames of one variant at one point are joined in a summary. */
enum gz_study_column_join {
	GZ_JOIN_FRAMES, /**< every frame counts by itself: quantiles and mean over all frames */
	GZ_JOIN_MEAN,   /**< mean of the frames */
	GZ_JOIN_SAME,   /**< the same for all frames of a point: the first frame's */
};

/** One column. */
struct gz_study_column {
	const char *name; /**< in frames.csv and, of GZ_JOIN_FRAMES, in summary.json */
	const char *unit; /**< "ms", "dB", "" for none */
	enum gz_study_column_type type;
	enum gz_study_column_join join;
	size_t offset;       /**< in struct gz_study_row */
	bool later;          /**< studies of earlier versions lack it: NaN is read */
	const char *title;   /**< heading in the report; NULL: it has another place there */
	const char *meaning; /**< one sentence without its full stop, for docs/gazebench.md */
};

extern const struct gz_study_column gz_study_columns[GZ_STUDY_COLUMNS];

/** A row's value of a column as a number; counts are exact up to 2^53. */
double gz_study_column_value(enum gz_study_column_id column, const struct gz_study_row *row);

/** Which columns the lines of a frames.csv have, in their order. */
struct gz_study_layout {
	enum gz_study_column_id columns[GZ_STUDY_COLUMNS];
	size_t count;
};

/** Print the line of names, of all columns. */
void gz_study_rows_print_head(FILE *file);

/**
 * Read the line of names.
 *
 * @param line  without its newline
 * @param[out] out_layout  written on true only
 * @return false where it is not one: a column is unknown, doubled, or missing and not @p later
 */
bool gz_study_rows_parse_head(const char *line, struct gz_study_layout *out_layout);

/** Print a row as a line, with all columns. */
void gz_study_rows_print(const struct gz_study *study, const struct gz_study_row *row, FILE *file);

/**
 * Read a line.
 *
 * @param layout        of the file
 * @param line          without its newline; changed
 * @param[in,out] row   of gz_study_unit_row(): says which row the line must be; the measured values
 * are set
 * @param[out] what     on false, the error
 * @param what_size     bytes of @p what
 */
bool gz_study_rows_parse(const struct gz_study *study, const struct gz_study_layout *layout,
			 char *line, struct gz_study_row *row, char *what, size_t what_size);

#endif
