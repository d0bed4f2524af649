/**
 * @file
 * frames.csv: one line a row. For bench/study/study_folder.c alone.
 */
#ifndef GZ_BENCH_STUDY_STUDY_ROWS_H
#define GZ_BENCH_STUDY_STUDY_ROWS_H

#include <stdbool.h>
#include <stdio.h>

#include "bench/study/study.h"

/** Print the line of names. */
void gz_study_rows_print_head(FILE *file);

/** Whether @p line, without its newline, is that line. */
bool gz_study_rows_is_head(const char *line);

/** Print a row as a line. */
void gz_study_rows_print(const struct gz_study *study, const struct gz_study_row *row, FILE *file);

/**
 * Read a line.
 *
 * @param line          without its newline; changed
 * @param[in,out] row   of gz_study_unit_row(): what the line must be of; what was measured is set
 * @param[out] what     on false, what is wrong with it
 * @param what_size     bytes of @p what
 */
bool gz_study_rows_parse(const struct gz_study *study, char *line, struct gz_study_row *row,
			 char *what, size_t what_size);

#endif
