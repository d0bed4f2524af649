/**
 * @file
 * What is installed beside gazeview: shipped scenes and experiments, and the other programs, which
 * it can start and stop. In a build tree they are found as well.
 */
#ifndef GZ_VIEW_FILES_PROGRAMS_H
#define GZ_VIEW_FILES_PROGRAMS_H

#include <stdbool.h>
#include <sys/types.h>

#include "base/result.h"
#include "protocol/gaze.h"

/**
 * The path of something that is shipped.
 *
 * @param what  such as "scenes" or "experiments/which-was-sharper.experiment"
 * @retval GZ_ERR_NOT_FOUND  it is not there; @p out_path is ""
 */
enum gz_result gz_shipped_path(const char *what, char out_path[GZ_PATH_SIZE]);

/** The path of a program of this package: "gazed", "gazeview". GZ_ERR_NOT_FOUND: as above. */
enum gz_result gz_program_path(const char *name, char out_path[GZ_PATH_SIZE]);

/**
 * Start a program. It gets SIGTERM if the calling thread ends.
 *
 * @param arguments  the program's path first; NULL-terminated
 * @param[out] out_child  to be passed to the functions below
 * @retval GZ_ERR_IO  it cannot be started; not logged
 */
enum gz_result gz_program_start(char *const arguments[], pid_t *out_child);

/** Whether a program still runs; if not, @p child becomes 0. Accepts 0. */
bool gz_program_runs(pid_t *child);

/** Stop a program by SIGTERM, and wait until it has ended. @p child becomes 0. Accepts 0. */
void gz_program_stop(pid_t *child);

#endif
