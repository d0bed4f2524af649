/**
 * @file
 * Programs made of commands, as `gazectl status`: finding the command, its options and help,
 * messages on stderr, signals that ask for an end.
 */
#ifndef GZ_BASE_COMMAND_H
#define GZ_BASE_COMMAND_H

#include <stdbool.h>
#include <stddef.h>

#include "base/log.h"
#include "base/option.h"

/** What every such program may end with; those with more to say count on from 3. */
enum gz_exit {
	GZ_EXIT_DONE = 0,
	GZ_EXIT_FAILED = 1, /**< failed or refused; what was logged says why */
	GZ_EXIT_USAGE = 2,  /**< a command line that is not understood */
};

/** One command. Tables are const and have static storage. */
struct gz_command {
	const char *program;  /**< "gazectl" */
	const char *name;     /**< "status" */
	const char *operands; /**< "[NAME]", as the usage line shows them */
	int operands_max;     /**< how many may be given; -1 for any number */
	const char *summary;  /**< one line of `PROGRAM --help` */
	/** What `PROGRAM NAME --help` says beyond that; ends with a newline. */
	const char *details;
	const struct gz_option *options; /**< over the command's own settings */
	size_t option_count;
	/** Do it. argv[0] is the command's name. Called once, on the main thread.
	 *  @return what the program exits with */
	int (*run)(int argc, char *const *argv, const struct gz_log *log);
};

/** A program made of commands. */
struct gz_command_program {
	const char *name;
	const char *version;
	const char *purpose;                      /**< what it is for, for its help; no newline */
	const char *exits;                        /**< what its exit statuses mean, one line */
	const struct gz_command *const *commands; /**< NULL behind the last */
};

/** Begins the settings of every command: where the row GZ_COMMAND_HELP_OPTION points to. */
struct gz_command_common {
	bool help;
};

/* clang-format off */
/** The row "--help" of a command's options. */
#define GZ_COMMAND_HELP_OPTION                                                                   \
	{ .key = "help",                                                                         \
	  .type = GZ_OPTION_BOOL,                                                                \
	  .offset = offsetof(struct gz_command_common, help),                                    \
	  .preset = "false",                                                                     \
	  .help = "print this and exit" }
/* clang-format on */

/** Most arguments that a command line may have. Chosen: more than any use needs. */
enum { GZ_COMMAND_ARGUMENTS_MAX = 1024 };

/** What of a command line is no option. */
struct gz_operands {
	const char *items[GZ_COMMAND_ARGUMENTS_MAX + 1]; /**< NULL behind the last */
	int count;
};

/**
 * Read a command's arguments.
 *
 * @param settings            what the command's option table points into; begins with a
 *                            struct gz_command_common
 * @param[out] out_operands   filled
 * @param[out] out_exit       what to exit with where it is false
 * @return whether to go on: false after --help and after a usage error, which is logged
 */
bool gz_command_read_arguments(const struct gz_command *command, int argc, char *const *argv,
			       const struct gz_log *log, void *settings,
			       struct gz_operands *out_operands, int *out_exit);

/**
 * main() of such a program: --help, --version, or the command asked for. Messages go to stderr as
 * "NAME: text". What cannot be written to stdout turns success into GZ_EXIT_FAILED.
 */
int gz_command_main(const struct gz_command_program *program, int argc, char **argv);

/** From now on SIGINT and SIGTERM set a flag in place of ending the program; without SA_RESTART,
 *  so that waiting ends. */
void gz_command_catch_signals(void);

/** Whether one of them arrived. Threads: any. */
bool gz_command_interrupted(void);

#endif
