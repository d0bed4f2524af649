/**
 * @file
 * Names of recordings, which come from anyone who reaches the control socket: they cannot leave the
 * directory for recordings, and no recording overwrites another.
 */
#ifndef GZ_DAEMON_RECORDING_NAME_H
#define GZ_DAEMON_RECORDING_NAME_H

#include <stdbool.h>
#include <stddef.h>

#include "base/result.h"

/** Whether @p name is 1 to 64 of the characters A-Z a-z 0-9 . _ - . */
bool gz_recording_name_valid(const char *name);

/**
 * Make a new file for a recording: DIRECTORY/NAME.gzl, 0600, because gaze is biometric data.
 *
 * @param name  as gz_recording_name_valid() has it; ".gzl" at its end is not doubled; empty: the
 *              present time in UTC
 * @param[out] out_fd  open for writing; the caller's
 * @param[out] out_path  GZ_PATH_SIZE bytes
 * @param[out] message  on failure what is wrong and what to do, one line
 * @retval GZ_ERR_INVAL   @p name is no name
 * @retval GZ_ERR_BUSY    there is such a file already
 * @retval GZ_ERR_ACCESS, GZ_ERR_IO, GZ_ERR_FULL  the file cannot be made
 */
enum gz_result gz_recording_create(const char *directory, const char *name, int *out_fd,
				   char *out_path, char *message, size_t message_size);

#endif
