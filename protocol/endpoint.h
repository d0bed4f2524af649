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

#define GZ_ENDPOINT_SIZE 256 /**< an endpoint with its NUL, bytes */
/** The runtime directory of a system daemon. The service manager makes it; its group may use it. */
#define GZ_SYSTEM_RUNTIME_DIRECTORY "/run/gazecast"
#define GZ_CONTROL_TCP_ENDPOINT     "tcp://127.0.0.1:50020" /**< with Pupil Remote's port */

/**
 * Find the runtime directory. It is $GAZECAST_RUNTIME_DIR if that is set; otherwise
 * $XDG_RUNTIME_DIR/gazecast; otherwise /run/gazecast if that exists; otherwise /tmp/gazecast-UID.
 *
 * @param[out] text     the path, which need not exist
 * @retval GZ_ERR_FULL  @p size is too small
 */
enum gz_result gz_runtime_directory(char *text, size_t size);

/**
 * Make the directory with mode 0700 if it is missing, and check that nobody else can reach its
 * content: it must be a directory and not a link, belong to this user, and give no access to group
 * or others. /run/gazecast, which only root can make, may belong to anybody and its group may read
 * it (0750).
 *
 * @retval GZ_ERR_ACCESS  not a directory, another user's, or too open; logged with the remedy
 * @retval GZ_ERR_IO      the directory cannot be made; logged
 */
enum gz_result gz_runtime_directory_prepare(const char *path, const struct gz_log *log);

/** Whether @p path is /run/gazecast, whose sockets its group may use. */
bool gz_runtime_directory_is_shared(const char *path);

/**
 * Find the local daemon's socket @p name for a reader.
 *
 * If GAZECAST_RUNTIME_DIR is set, the socket is there. Otherwise the first of these directories
 * that has the socket counts, so that the user's daemon comes before the system's:
 * $XDG_RUNTIME_DIR/gazecast, /run/gazecast, /tmp/gazecast-UID. If none has it yet, the result is
 * where the user's daemon will bind it. /tmp/gazecast-UID is used only if it belongs to this user
 * or root: anybody could have made it to impersonate the daemon.
 *
 * @retval GZ_ERR_FULL    the path is too long for a socket or for @p size
 * @retval GZ_ERR_ACCESS  /tmp/gazecast-UID belongs to another user; logged
 */
enum gz_result gz_endpoint_find(const char *name, const struct gz_log *log, char *text,
				size_t size);

/**
 * Print the endpoint "ipc://<directory>/<name>".
 *
 * @param name  "stream", "latest", "control" or "inlet"
 * @retval GZ_ERR_FULL  too long for the path of a socket (107 bytes) or for @p size
 */
enum gz_result gz_endpoint_ipc(const char *directory, const char *name, char *text, size_t size);

#endif
