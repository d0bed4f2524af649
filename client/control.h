/**
 * @file
 * Requests to the daemon: start and stop a recording, ask for its time, version and ports. The
 * requests are those of Pupil Remote (docs/protocol.md), so Pupil Capture understands them too.
 */
#ifndef GZ_CLIENT_CONTROL_H
#define GZ_CLIENT_CONTROL_H

#include <stddef.h>

#include "base/log.h"
#include "base/result.h"
#include "client/keys.h"

#ifdef __cplusplus
extern "C" {
#endif

/** A control socket of a daemon. One thread at a time. */
struct gz_control;

/** Room for any reply with its NUL, bytes. */
#define GZ_CONTROL_REPLY_SIZE 2048

/** A timeout for requests, ms. Chosen: ten times what the daemon promises (every reply within
 * 100 ms). */
#define GZ_CONTROL_TIMEOUT_MS 1000

/**
 * Prepare to send requests. Succeeds even if no daemon is running.
 *
 * @param endpoint  ZeroMQ endpoint of a control socket; NULL: that of the local daemon
 * @param log       borrowed, outlives the control; may be NULL
 * @param[out] out_control  owned by the caller: gz_control_close()
 * @retval GZ_ERR_INVAL   @p endpoint is not a ZeroMQ endpoint; logged
 * @retval GZ_ERR_NO_MEM  no memory or no socket; if no socket, logged
 * @return else as gz_keys_find(), which looks for keys
 */
enum gz_result gz_control_open(const char *endpoint, const struct gz_log *log,
			       struct gz_control **out_control);

/** Prepare like gz_control_open(), but with @p keys, which are copied; NULL: without keys. */
enum gz_result gz_control_open_with_keys(const char *endpoint, const struct gz_keys *keys,
					 const struct gz_log *log, struct gz_control **out_control);

/**
 * Send @p request and wait for its reply. Without a daemon, or with one that hangs, a request costs
 * the timeout and nothing more: the next one starts afresh, and a late reply is never taken for
 * that of another request.
 *
 * @param request     "R", "R name", "r", "t", "v", "SUB_PORT", "PUB_PORT", …
 * @param timeout_ms  longest wait, ms, 1 or more
 * @param[out] out_reply  text of the reply, GZ_CONTROL_REPLY_SIZE bytes; written only on GZ_OK. The
 *                        reply to a command that was carried out begins with "OK"; a refusal gives
 *                        the reason
 * @retval GZ_ERR_TIMEOUT   no reply: most likely no daemon is running there
 * @retval GZ_ERR_ACCESS    the daemon refuses our keys, or we refuse its; logged with the remedy
 * @retval GZ_ERR_PROTOCOL  the reply is too long or holds a NUL
 * @retval GZ_ERR_INVAL     @p timeout_ms is below 1
 * @retval GZ_ERR_NO_MEM    no socket
 */
enum gz_result gz_control_request(struct gz_control *control, const char *request, int timeout_ms,
				  char out_reply[GZ_CONTROL_REPLY_SIZE]);

/**
 * The endpoint of the stream of the same daemon: the socket "stream" in the same directory for an
 * ipc:// endpoint; otherwise the same host with the port that "SUB_PORT" returns.
 *
 * @param timeout_ms  longest wait, ms, 1 or more
 * @param[out] text   the endpoint, at most @p size bytes with its NUL; written only on GZ_OK
 * @retval GZ_ERR_TIMEOUT      no reply
 * @retval GZ_ERR_UNSUPPORTED  the daemon returns no port: its TCP is off
 * @retval GZ_ERR_FULL         @p size is too small
 * @return else as gz_control_request()
 */
enum gz_result gz_control_stream_endpoint(struct gz_control *control, int timeout_ms, char *text,
					  size_t size);

/** The keys in use, NULL for none. The stream of the same daemon needs the same keys. Valid until
 *  the control is closed. */
const struct gz_keys *gz_control_keys(const struct gz_control *control);

/** The endpoint in use. Valid until the control is closed. */
const char *gz_control_endpoint(const struct gz_control *control);

/** Close the control and set *control to NULL; returns at once. Accepts a pointer to NULL. */
void gz_control_close(struct gz_control **control);

#ifdef __cplusplus
}
#endif

#endif
