/**
 * @file
 * One daemon to a runtime directory. Without it a second one would take the first one's sockets
 * away without a word: ZeroMQ removes a socket file that is in its way.
 */
#ifndef GZ_DAEMON_LOCK_H
#define GZ_DAEMON_LOCK_H

#include "base/log.h"
#include "base/result.h"

/**
 * Take the directory, for as long as @p *out_fd is open. The lock goes with the process, however
 * that ends.
 *
 * @param directory  made and checked by gz_runtime_directory_prepare()
 * @retval GZ_ERR_BUSY  another daemon has it; logged with its process id and the remedy
 * @retval GZ_ERR_IO    the lock file cannot be made; logged
 */
enum gz_result gz_lock_take(const char *directory, const struct gz_log *log, int *out_fd);

#endif
