/**
 * @file
 * Answers summed up: as lines of text, and as a page with each psychometric function drawn.
 */
#ifndef GZ_BENCH_ANSWERS_ANSWER_PAGE_H
#define GZ_BENCH_ANSWERS_ANSWER_PAGE_H

#include <stdio.h>

#include "bench/answers/answer_table.h"

/** Print the shares of right answers, and the thresholds where a key varied. */
void gz_answer_table_print(struct gz_answer_table *table,
			   const struct gz_psychometric_params *params, FILE *out);

/** Write the same as a page of its own, with the functions drawn. @return what gz_text_write()
 *  returns; logged */
enum gz_result gz_answer_page_write(struct gz_answer_table *table,
				    const struct gz_psychometric_params *params, const char *path,
				    const struct gz_log *log);

#endif
