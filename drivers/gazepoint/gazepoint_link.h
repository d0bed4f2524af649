/**
 * @file
 * The TCP connection to Gazepoint Control: never blocks longer than it is told to.
 */
#ifndef GZ_DRIVERS_GAZEPOINT_LINK_H
#define GZ_DRIVERS_GAZEPOINT_LINK_H

#include <stddef.h>
#include <stdint.h>

#include "base/result.h"

/** Bytes of a reason with its NUL. */
#define GZ_GAZEPOINT_LINK_REASON_SIZE 96

/**
 * Connect.
 *
 * @param host        numeric address, or a name that the system looks up
 * @param port        1 to 65535
 * @param timeout_ms  longest wait for each of the host's addresses, once it is looked up
 * @param[out] out_fd      a connected socket that does not block; the caller's
 * @param[out] out_reason  on failure: why, GZ_GAZEPOINT_LINK_REASON_SIZE bytes
 * @retval GZ_ERR_NO_DEVICE  no such host, nobody listens, or no answer in time
 */
enum gz_result gz_gazepoint_link_open(const char *host, int port, int timeout_ms, int *out_fd,
				      char *out_reason);

/**
 * Send all of @p size bytes, which the socket's buffer is expected to take at once.
 *
 * @retval GZ_ERR_NO_DEVICE  it does not: the other side is gone or stuck
 */
enum gz_result gz_gazepoint_link_send(int fd, const char *bytes, size_t size);

/**
 * Wait until something can be received.
 *
 * @retval GZ_ERR_TIMEOUT    nothing until @p deadline_ns, host time
 * @retval GZ_ERR_NO_DEVICE  the socket is broken
 */
enum gz_result gz_gazepoint_link_wait(int fd, int64_t deadline_ns);

/**
 * Receive what is there.
 *
 * @param[out] out_size  how much; at least 1 on success
 * @retval GZ_ERR_TIMEOUT    nothing now
 * @retval GZ_ERR_NO_DEVICE  the other side has closed, or the connection broke; errno tells, 0 for
 *                           a close
 */
enum gz_result gz_gazepoint_link_receive(int fd, void *bytes, size_t size, size_t *out_size);

#endif
