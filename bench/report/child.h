/**
 * @file
 * Running another program to its end, without a shell.
 */
#ifndef GZ_BENCH_REPORT_CHILD_H
#define GZ_BENCH_REPORT_CHILD_H

#include "base/result.h"

/**
 * Run a program in @p folder, in the locale "C.UTF-8", without input; what it prints goes to the
 * file @p output inside the folder.
 *
 * @param arguments  [0] is the program, looked up in $PATH; NULL behind the last
 * @param[out] out_status  what it exited with, or -1 if a signal ended it
 * @retval GZ_ERR_NOT_FOUND  there is no such program
 * @retval GZ_ERR_IO         it cannot be started
 */
enum gz_result gz_child_run(const char *folder, char *const *arguments, const char *output,
			    int *out_status);

#endif
