/**
 * @file
 * Option tables. One table describes each setting once; presets, INI files, command lines, --help
 * and the settings in a gaze log are all made from it.
 *
 * Nothing is clamped. Unknown keys, trailing text, NaN, values out of range and a key given twice
 * are refused with "file:line: key: what is wrong, what is allowed". Programs leave LC_NUMERIC at
 * "C".
 *
 * Every row of a table is written in this form:
 *
 *     { "tracker.rate_hz", GZ_OPTION_DOUBLE, AT(rate_hz), 1, 1000, .preset = "60",
 *       .help = "samples a second, Hz" },
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

/** How a value is written, and the C type at the option's offset. */
enum gz_option_type {
	GZ_OPTION_BOOL,   /**< bool: true/false, yes/no, on/off, 1/0; "--key" alone means true */
	GZ_OPTION_INT,    /**< int[count], separated by blanks */
	GZ_OPTION_DOUBLE, /**< double[count], separated by blanks */
	GZ_OPTION_STRING, /**< char[max]: at most max - 1 bytes */
	GZ_OPTION_CHOICE, /**< int: index into choices */
	GZ_OPTION_SIZE,   /**< int[2] written WxH; min and max apply to each side */
};

/** One setting. Tables are const and have static storage. */
struct gz_option {
	const char *key; /**< "section.name", or "name" for a setting of the command line only */
	enum gz_option_type type;
	size_t offset;              /**< of the field in the target struct */
	double min, max;            /**< inclusive, each number; STRING: max = buffer size, bytes */
	int count;                  /**< how many numbers an INT or DOUBLE has; 0 means 1 */
	const char *const *choices; /**< CHOICE: names, NULL-terminated */
	const char *preset;         /**< default as text; NULL leaves the target unchanged */
	const char *help;           /**< one line, with the unit */
};

/** Most numbers that one option holds. Chosen: a 4x4 matrix. */
#define GZ_OPTION_NUMBERS_MAX 16

/** Size of a buffer for the message of a refused value, with the NUL, bytes. Longer ones are cut.
 */
#define GZ_OPTION_MESSAGE_SIZE 512

/** Size of a buffer for any value as text: a string of any buffer size in use, or a row of numbers.
 */
#define GZ_OPTION_TEXT_SIZE 4096

/** A table and the struct that its offsets refer to. */
struct gz_option_binding {
	const struct gz_option *options;
	size_t count;
	void *target;
	bool *given; /**< NULL, or @p count flags: set for each option a file or argument gives */
};

/**
 * Set every option that has a preset.
 *
 * @retval GZ_ERR_INVAL  a preset does not parse: a bug, which the tests of each table look for
 */
enum gz_result gz_options_preset(const struct gz_option_binding *binding);

/**
 * Parse @p text into the option's field of @p target.
 *
 * @param[out] message  on failure: what is wrong and what is allowed; may be NULL
 * @param message_size  bytes of @p message; GZ_OPTION_MESSAGE_SIZE always suffices
 * @retval GZ_OK         the field is set
 * @retval GZ_ERR_INVAL  refused; the field is unchanged
 */
enum gz_result gz_option_parse(const struct gz_option *option, const char *text, void *target,
			       char *message, size_t message_size);

/**
 * Print the option's value in @p target, as text that gz_option_parse() reads back to the same
 * value.
 *
 * @retval GZ_OK        @p text holds the value
 * @retval GZ_ERR_FULL  @p size is too small; @p text is an empty string
 */
enum gz_result gz_option_format(const struct gz_option *option, const void *target, char *text,
				size_t size);

/** Describe what the option allows: "0.1 to 100", "standard, mdc, ddc or acuity". */
void gz_option_allowed(const struct gz_option *option, char *text, size_t size);

/** How many numbers the option holds: 2 for a SIZE, otherwise its count or 1. */
int gz_option_count(const struct gz_option *option);

/**
 * Whether the option's value in @p target is one that gz_option_parse() could have set: every
 * number in its range and not NaN, a choice among its names, a string that ends within its buffer.
 * For structs that a program filled itself. Does not allocate.
 */
bool gz_option_holds(const struct gz_option *option, const void *target);

/** Whether gz_option_holds() for every option of a table. Does not allocate. */
bool gz_options_hold(const struct gz_option *options, size_t count, const void *target);

/**
 * Whether two structs have equal values for an option. Numbers compare by value, so 0 equals -0;
 * NaN equals NaN; strings compare up to their NUL. Padding and fields without an option are
 * ignored. Does not allocate.
 */
bool gz_option_same(const struct gz_option *option, const void *a, const void *b);

/** Whether gz_option_same() for every option of a table. Does not allocate. */
bool gz_options_same(const struct gz_option *options, size_t count, const void *a, const void *b);

/**
 * Find an option by its key.
 *
 * @param[out] out_binding  index of the binding that has it; may be NULL; unchanged if there is
 * none
 * @return the option, or NULL
 */
const struct gz_option *gz_options_find(const struct gz_option_binding *bindings, size_t count,
					const char *key, size_t *out_binding);

/** The key that is most similar to @p key, for "did you mean"; NULL if none is similar. */
const char *gz_options_nearest(const struct gz_option_binding *bindings, size_t count,
			       const char *key);

/**
 * Read an INI file (ini.h): "[section]" and "name = value" give the key "section.name". Values are
 * set in order; on failure the earlier ones stay set.
 *
 * @retval GZ_OK             read
 * @retval GZ_ERR_NOT_FOUND  no such file; logged
 * @retval GZ_ERR_IO         the file cannot be read; logged
 * @retval GZ_ERR_FORMAT     refused; logged with file, line, key and remedy
 * @retval GZ_ERR_NO_MEM     out of memory; nothing is set
 */
enum gz_result gz_options_read_file(const struct gz_option_binding *bindings, size_t count,
				    const char *path, const struct gz_log *log);

/**
 * Read an INI text of @p size bytes, like gz_options_read_file().
 *
 * @param name  the file's name in messages
 * @retval GZ_OK          read
 * @retval GZ_ERR_FORMAT  refused; logged with file, line, key and remedy
 * @retval GZ_ERR_NO_MEM  out of memory; nothing is set
 */
enum gz_result gz_options_read_text(const struct gz_option_binding *bindings, size_t count,
				    const char *name, const char *text, size_t size,
				    const struct gz_log *log);

/**
 * The number of the line of the INI file @p path that gives @p key; 0 if no line gives it or the
 * file cannot be read. For messages about values that are valid one by one but not together.
 */
int gz_options_file_line(const char *path, const char *key);

/** Most arguments of a command line that are not options. Chosen: more than any use needs. */
#define GZ_OPERANDS_MAX 1024

/** The arguments of a command line that are not options. */
struct gz_operands {
	const char *items[GZ_OPERANDS_MAX + 1]; /**< in order, NULL after the last */
	int count;
};

/**
 * Read a command line: "--key value", "--key=value", "--key" for a BOOL; "--" ends the options.
 * "-h" is "--help" if there is an option of that key. Dashes and underscores in a key are
 * equivalent ("--rate-hz" is "rate_hz"). A value may begin with one dash ("--turn -3"), with two
 * only after '='. "-" alone is an operand. A BOOL takes a value only after '=' ("--cross=no").
 *
 * @param argc, argv         as main() gets them; argv[0] is skipped
 * @param[out] out_operands  the other arguments, pointing into @p argv; written on success only;
 *                           NULL refuses them
 * @retval GZ_OK         read
 * @retval GZ_ERR_INVAL  refused; logged with key and remedy
 * @retval GZ_ERR_NO_MEM  out of memory; nothing is set
 */
enum gz_result gz_options_read_arguments(const struct gz_option_binding *bindings, size_t count,
					 int argc, char *const *argv,
					 struct gz_operands *out_operands,
					 const struct gz_log *log);

/** Print one aligned line per option: --key VALUE, help, allowed range, default. */
void gz_options_print_help(const struct gz_option_binding *bindings, size_t count, FILE *out);

/** Print a commented INI file: each option's help, range and current value. */
void gz_options_print_file(const struct gz_option_binding *bindings, size_t count, FILE *out);

#ifdef __cplusplus
}
#endif

#endif
