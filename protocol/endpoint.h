/**
 * @file
 * Where the daemon's sockets are: the runtime directory and the names in it.
 */
#ifndef GZ_PROTOCOL_ENDPOINT_H
#define GZ_PROTOCOL_ENDPOINT_H

#include <stdbool.h>
#include <stddef.h>

#include "base/log.h"
#include "base/result.h"

#define GZ_ENDPOINT_SIZE 256 /**< bytes of an endpoint with its NUL */
/** Made by the service manager, for a daemon that serves every user in its group. */
#define GZ_SYSTEM_RUNTIME_DIRECTORY "/run/gazecast"
#define GZ_CONTROL_TCP_ENDPOINT     "tcp://127.0.0.1:50020" /**< Pupil Remote's port */

/**
 * Find the runtime directory: $XDG_RUNTIME_DIR/gazecast, else /run/gazecast where that exists, else
 * /tmp/gazecast-UID. GAZECAST_RUNTIME_DIR, if set, comes before all of them.
 *
 * @retval GZ_OK        @p text holds the path; it need not exist
 * @retval GZ_ERR_FULL  @p size is too small
 */
enum gz_result gz_runtime_directory(char *text, size_t size);

/**
 * Make the directory 0700 if it is missing, and check that nobody else can reach what is in it: a
 * real directory, not a link, ours, without access for group or others. /run/gazecast, which only
 * root can make, may be anybody's and readable by its group (0750).
 *
 * @retval GZ_ERR_ACCESS  someone else's or too open; logged with the remedy
 * @retval GZ_ERR_IO      cannot be made; logged
 */
enum gz_result gz_runtime_directory_prepare(const char *path, const struct gz_log *log);

/** Whether @p path is /run/gazecast, whose sockets its group may use. */
bool gz_runtime_directory_is_shared(const char *path);

/**
 * Where a reader finds the local daemon's socket @p name: in the first of the runtime directories
 * that has it (GAZECAST_RUNTIME_DIR, if set, is the only one), so that the daemon of the user comes
 * before that of the system; where none has it yet, where the user's daemon will bind it. In
 * /tmp/gazecast-UID only if that is ours or root's: anyone could have made it, to play the daemon.
 *
 * @retval GZ_ERR_FULL    the path is too long for a socket or for @p size
 * @retval GZ_ERR_ACCESS  /tmp/gazecast-UID is somebody else's; logged
 */
enum gz_result gz_endpoint_find(const char *name, const struct gz_log *log, char *text,
				size_t size);

/** "ipc://<directory>/<name>": names are "stream", "latest", "control", "inlet". GZ_ERR_FULL if too
 *  long for a socket path (107 bytes) or for @p size. */
enum gz_result gz_endpoint_ipc(const char *directory, const char *name, char *text, size_t size);

#endif
