/**
 * @file
 * Option tables: one table describes each setting once; presets, files (INI), command lines, --help
 * and the settings written into a gaze log are all made from it.
 *
 * Nothing is clamped: unknown keys, trailing text, NaN, values out of range and a key given twice
 * are refused with "file:line: key: what is wrong, what is allowed". Programs leave LC_NUMERIC at
 * "C".
 */
#ifndef GZ_BASE_OPTION_H
#define GZ_BASE_OPTION_H

#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

#include "base/log.h"
#include "base/result.h"

#ifdef __cplusplus
extern "C" {
#endif

/** How a value reads, and the C type at the option's offset. */
enum gz_option_type {
	GZ_OPTION_BOOL,   /**< bool: true/false, yes/no, on/off, 1/0; "--key" alone means true */
	GZ_OPTION_INT,    /**< int[count], separated by blanks */
	GZ_OPTION_DOUBLE, /**< double[count], separated by blanks */
	GZ_OPTION_STRING, /**< char[max]: at most max - 1 bytes */
	GZ_OPTION_CHOICE, /**< int: index into choices */
	GZ_OPTION_SIZE,   /**< int[2] written WxH; min and max hold for each side */
};

/** One setting. Tables are const and have static storage. */
struct gz_option {
	const char *key; /**< "section.name", or "name" for command-line-only settings */
	enum gz_option_type type;
	size_t offset;              /**< of the field in the target struct */
	double min, max;            /**< inclusive, each number; STRING: max = buffer size, bytes */
	int count;                  /**< numbers of an INT or DOUBLE; 0 means 1 */
	const char *const *choices; /**< CHOICE: names, NULL-terminated */
	const char *preset;         /**< default as text; NULL leaves the target as it is */
	const char *help;           /**< one line, with the unit */
};

/** A table and the struct that its offsets point into. */
struct gz_option_binding {
	const struct gz_option *options;
	size_t count;
	void *target;
	bool *given; /**< NULL, or @p count flags: set for each option a file or argument gave */
};

/** Set every option that has a preset. A preset that does not parse is a bug: asserted by tests. */
enum gz_result gz_options_preset(const struct gz_option_binding *binding);

/**
 * Parse @p text into the option's field of @p target.
 *
 * @param[out] message  on failure: what is wrong and what is allowed; may be NULL
 * @param message_size  bytes of @p message
 * @retval GZ_OK         the field is set
 * @retval GZ_ERR_INVAL  refused; the field is unchanged
 */
enum gz_result gz_option_parse(const struct gz_option *option, const char *text, void *target,
			       char *message, size_t message_size);

/**
 * Print the option's value in @p target as text that gz_option_parse() reads back to the same
 * value.
 *
 * @retval GZ_OK        @p text holds it
 * @retval GZ_ERR_FULL  @p size is too small; @p text holds an empty string
 */
enum gz_result gz_option_format(const struct gz_option *option, const void *target, char *text,
				size_t size);

/**
 * Whether the option's value in @p target is one that gz_option_parse() could have set: every
 * number in its range and not NaN, a choice among its names, a string that ends within its buffer.
 * For structs that a program filled itself. Does not allocate.
 */
bool gz_option_holds(const struct gz_option *option, const void *target);

/**
 * Find an option by its key.
 *
 * @param[out] out_binding  index of the binding that has it; may be NULL
 * @return the option, or NULL
 */
const struct gz_option *gz_options_find(const struct gz_option_binding *bindings, size_t count,
					const char *key, size_t *out_binding);

/**
 * Read an INI file (ini.h): "[section]" and "name = value" make the key "section.name". Values are
 * set in order; on failure earlier ones stay set.
 *
 * @retval GZ_OK             read
 * @retval GZ_ERR_NOT_FOUND  no such file; logged
 * @retval GZ_ERR_IO         cannot be read; logged
 * @retval GZ_ERR_FORMAT     refused; logged with file, line, key and remedy
 * @retval GZ_ERR_NO_MEM     nothing is set
 */
enum gz_result gz_options_read_file(const struct gz_option_binding *bindings, size_t count,
				    const char *path, const struct gz_log *log);

/**
 * The line of the INI file @p path that gives @p key, for messages about values that each by itself
 * were fine: 0 if none does, or if the file cannot be read.
 */
int gz_options_file_line(const char *path, const char *key);

/** As gz_options_read_file() over @p size bytes at @p text; @p name stands for the file in
 * messages. */
enum gz_result gz_options_read_text(const struct gz_option_binding *bindings, size_t count,
				    const char *name, const char *text, size_t size,
				    const struct gz_log *log);

/**
 * Read a command line: "--key value", "--key=value", "--key" for a BOOL, "--" ends options.
 * Dashes and underscores in a key are the same ("--rate-hz" is "rate_hz"). A value may begin with
 * one dash ("--turn -3"), with two only after '='. "-" alone is no option. A BOOL takes a value
 * only by '=' ("--cross=no").
 *
 * @param argc, argv     as main() has them; argv[0] is skipped
 * @param[out] out_positional  arguments that are no options, in order, pointing into @p argv;
 *                             room for @p argc; NULL refuses them
 * @param[out] out_positional_count  how many; may be NULL if @p out_positional is
 * @retval GZ_OK         read
 * @retval GZ_ERR_INVAL  refused; logged with key and remedy
 */
enum gz_result gz_options_read_arguments(const struct gz_option_binding *bindings, size_t count,
					 int argc, char *const *argv, const char **out_positional,
					 int *out_positional_count, const struct gz_log *log);

/** The key of the options nearest to @p key, or NULL if none is near. */
const char *gz_options_nearest(const struct gz_option_binding *bindings, size_t count,
			       const char *key);

/** What the option allows, as text: "0.1 to 100", "standard, mdc, ddc or acuity". */
void gz_option_allowed(const struct gz_option *option, char *text, size_t size);

/** Print one aligned line per option: --key VALUE, help, allowed range, default. */
void gz_options_print_help(const struct gz_option_binding *bindings, size_t count, FILE *out);

/** Print a commented INI file: each option's help, range and present value. */
void gz_options_print_file(const struct gz_option_binding *bindings, size_t count, FILE *out);

#ifdef __cplusplus
}
#endif

#endif
