/**
 * @file
 * The TCP connection to Gazepoint Control. No call blocks for longer than its limit.
 */
#ifndef GZ_DRIVERS_GAZEPOINT_LINK_H
#define GZ_DRIVERS_GAZEPOINT_LINK_H

#include <stddef.h>
#include <stdint.h>

#include "base/result.h"

/** Longest wait for a connection, ms. Chosen: many round trips on any laboratory network. */
#define GZ_GAZEPOINT_CONNECT_MS 300

/** Longest wait for the server's answers about the tracker before the stream is requested, ms.
 * Chosen: many round trips on any laboratory network; later answers are used, too. */
#define GZ_GAZEPOINT_ANSWER_MS 300

/** A server that sends nothing for this long is gone, ms: it sends a record for each camera
 * picture, whether or not it finds an eye. Chosen: 180 pictures of the slowest tracker. */
#define GZ_GAZEPOINT_SILENCE_MS 3000

/** Bytes of a reason with its NUL. */
#define GZ_GAZEPOINT_LINK_REASON_SIZE 96

/**
 * Connect, waiting for at most GZ_GAZEPOINT_CONNECT_MS for each address of the host. Looking up the
 * host's name may take some seconds more if no name server answers.
 *
 * @param host  numeric address, or a name that the system looks up
 * @param port  1 to 65535
 * @param[out] out_fd      a connected non-blocking socket, owned by the caller
 * @param[out] out_reason  on failure: why; GZ_GAZEPOINT_LINK_REASON_SIZE bytes
 * @retval GZ_ERR_NO_DEVICE  unknown host, connection refused, or no answer in time
 */
enum gz_result gz_gazepoint_link_open(const char *host, int port, int *out_fd, char *out_reason);

/**
 * Send all of @p size bytes. The socket's buffer is expected to take them at once.
 *
 * @retval GZ_ERR_NO_DEVICE  it does not: the other side is gone or stuck
 */
enum gz_result gz_gazepoint_link_send(int fd, const char *bytes, size_t size);

/**
 * Receive what has arrived.
 *
 * @param[out] out_size  bytes received; at least 1 on success
 * @retval GZ_ERR_TIMEOUT    nothing has arrived
 * @retval GZ_ERR_NO_DEVICE  the connection is broken, errno says why; errno 0: the other side has
 *                           closed it
 */
enum gz_result gz_gazepoint_link_receive(int fd, void *bytes, size_t size, size_t *out_size);

#endif
