/**
 * @file
 * A program under test: started with arguments, its output collected.
 */
#ifndef GZ_TESTS_CLIENT_PROGRAM_H
#define GZ_TESTS_CLIENT_PROGRAM_H

#include <stdbool.h>
#include <stddef.h>
#include <sys/types.h>

/** A running or finished program. */
struct program {
	pid_t process; /**< 0 once it has ended */
	int out, err;  /**< pipes */
	int status;    /**< its exit status; -1 if a signal ended it */
	char out_text[16384], err_text[4096];
	size_t out_size, err_size;
};

/** Start @p arguments[0] with @p arguments, NULL-terminated. Asserts. */
void program_start(struct program *program, const char *const *arguments);

/** Collect the output that comes within @p wait_ms. @return false once both pipes are closed */
bool program_collect(struct program *program, int wait_ms);

/** Collect output until @p text appears on stdout or stderr. Asserts that it does. */
void program_wait_for(struct program *program, const char *text);

/** Collect the rest of the output and the exit status. Kills the program and fails after 20 s. */
void program_finish(struct program *program);

/** Kill the program if it is still running: for the teardown of a test that failed. */
void program_kill(struct program *program);

/** program_start() and program_finish(). */
void program_run(struct program *program, const char *const *arguments);

#endif
