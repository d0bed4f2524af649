/**
 * @file
 * What the files that implement option.h share; nobody else includes it.
 */
#ifndef GZ_BASE_OPTION_INTERNAL_H
#define GZ_BASE_OPTION_INTERNAL_H

#include "base/option.h"

/** Room for a value as text: a string of any buffer size in use, or a row of numbers. */
enum { GZ_OPTION_TEXT_SIZE = 4096 };

/** Room for one message of gz_option_parse(). */
enum { GZ_OPTION_MESSAGE_SIZE = 512 };

/** Numbers that the option holds. */
int gz_option_count(const struct gz_option *option);

/** A pass over one file or command line: refuses what is given twice. */
struct gz_option_reader {
	const struct gz_option_binding *bindings;
	size_t count;
	int *first_place; /**< per option over all bindings, where it was given; 0 = not yet */
};

/** @retval GZ_ERR_NO_MEM  nothing to free */
enum gz_result gz_option_reader_init(struct gz_option_reader *reader,
				     const struct gz_option_binding *bindings, size_t count);

/** Free what gz_option_reader_init() allocated. */
void gz_option_reader_free(struct gz_option_reader *reader);

/**
 * Set @p key to @p text.
 *
 * @param place            line or argument number, from 1
 * @param[out] out_first   0, or the place that gave the key before: refused then
 * @param[out] message     on failure: what is wrong and what is allowed
 * @retval GZ_ERR_NOT_FOUND  no such key; @p message names the nearest
 * @retval GZ_ERR_INVAL      given twice, or the value is refused
 */
enum gz_result gz_option_reader_set(struct gz_option_reader *reader, const char *key,
				    const char *text, int place, int *out_first, char *message,
				    size_t message_size);

#endif
