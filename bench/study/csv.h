/**
 * @file
 * Lines of comma-separated values (RFC 4180).
 */
#ifndef GZ_BENCH_STUDY_CSV_H
#define GZ_BENCH_STUDY_CSV_H

/**
 * Cut the next field off a line, without the quotes around it.
 *
 * @param[in,out] line  the rest of the line, which is changed; moved behind the field's comma, or
 *                      to NULL behind the last field
 * @return the field; NULL where there is none, or its quotes do not end
 */
char *gz_csv_next_field(char **line);

#endif
