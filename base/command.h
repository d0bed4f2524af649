/**
 * @file
 * Programs that consist of commands, such as `gazectl status`: finding the command, its options and
 * help, messages on stderr, and the signals that ask it to end.
 */
#ifndef GZ_BASE_COMMAND_H
#define GZ_BASE_COMMAND_H

#include <stdbool.h>
#include <stddef.h>

#include "base/log.h"
#include "base/option.h"

/** Exit statuses of every such program. A program's own statuses begin at 3. */
enum gz_exit {
	GZ_EXIT_DONE = 0,
	GZ_EXIT_FAILED = 1, /**< failed or refused; the log says why */
	GZ_EXIT_USAGE = 2,  /**< the command line is not understood */
};

/** One command. Tables are const and have static storage. */
struct gz_command {
	const char *program;  /**< "gazectl" */
	const char *name;     /**< "status" */
	const char *operands; /**< "[NAME]", as the usage line shows them */
	int operands_max;     /**< how many may be given; -1 for any number */
	const char *summary;  /**< one line of `PROGRAM --help` */
	const char *details;  /**< more lines of `PROGRAM NAME --help`; ends with a newline */
	const struct gz_option *options; /**< over the command's own settings */
	size_t option_count;
	/** Run the command. argv[0] is its name. Called once, on the main thread.
	 *  @return the program's exit status */
	int (*run)(int argc, char *const *argv, const struct gz_log *log);
};

/** A program that consists of commands. */
struct gz_command_program {
	const char *name;
	const char *version;
	const char *purpose;                      /**< what it is for, in its help; no newline */
	const char *exits;                        /**< what its exit statuses mean, one line */
	const struct gz_command *const *commands; /**< NULL after the last */
};

/** The first member of every command's settings; the row GZ_COMMAND_HELP_OPTION refers to it. */
struct gz_command_common {
	bool help;
};

/* clang-format off */
/** The row "--help" of a command's options. */
#define GZ_COMMAND_HELP_OPTION                                                                   \
	{ "help", GZ_OPTION_BOOL, offsetof(struct gz_command_common, help), .preset = "false",   \
	  .help = "print this help and exit" }
/* clang-format on */

/** What gz_command_read_arguments() returns if the command goes on; no exit status has this value.
 */
enum { GZ_COMMAND_GO_ON = -1 };

/**
 * Read a command's arguments. Print the help if the arguments ask for it.
 *
 * @param settings           the struct that the command's option table refers to; begins with a
 *                           struct gz_command_common
 * @param[out] out_operands  the arguments that are not options; at most the command's operands_max
 * @return GZ_COMMAND_GO_ON, or the exit status to end with: GZ_EXIT_DONE after --help,
 *         GZ_EXIT_USAGE after a usage error, which is logged
 */
int gz_command_read_arguments(const struct gz_command *command, int argc, char *const *argv,
			      const struct gz_log *log, void *settings,
			      struct gz_operands *out_operands);

/**
 * main() of such a program: --help, --version, or the command that is named. Messages go to stderr
 * as "NAME: text". If standard output cannot be written, GZ_EXIT_DONE becomes GZ_EXIT_FAILED.
 */
int gz_command_main(const struct gz_command_program *program, int argc, char **argv);

/**
 * From now on SIGINT and SIGTERM set a flag instead of ending the program. The handler is installed
 * without SA_RESTART, so a signal also ends a system call that waits.
 */
void gz_command_catch_signals(void);

/** Whether one of these signals has arrived. Threads: any. */
bool gz_command_interrupted(void);

#endif
