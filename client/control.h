/**
 * @file
 * Requests to the daemon: start and stop a recording, ask for its time, version and ports. The
 * letters are Pupil Remote's (docs/protocol.md), so this also speaks to Pupil Capture.
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

/** Where requests go. One thread at a time. */
struct gz_control;

/** Room that any reply fits in, with its NUL, bytes. */
#define GZ_CONTROL_REPLY_SIZE 2048

/** Chosen: ten times what the daemon promises (every reply within 100 ms). */
#define GZ_CONTROL_TIMEOUT_MS 1000

/**
 * Prepare to ask.
 *
 * @param endpoint  a ZeroMQ endpoint of a control socket; NULL finds the local daemon's
 * @param log       borrowed, outlives the control; may be NULL
 * @param[out] out_control  owned by the caller: gz_control_close()
 * @retval GZ_ERR_INVAL   @p endpoint is no ZeroMQ endpoint; logged
 * @retval GZ_ERR_NO_MEM  no room; logged
 * @return else as gz_keys_find(), which is asked for keys
 *
 * Succeeds also while no daemon runs.
 */
enum gz_result gz_control_open(const char *endpoint, const struct gz_log *log,
			       struct gz_control **out_control);

/** As gz_control_open() with @p keys, copied, and no others; NULL connects without any. */
enum gz_result gz_control_open_with_keys(const char *endpoint, const struct gz_keys *keys,
					 const struct gz_log *log, struct gz_control **out_control);

/**
 * Send @p request and wait for its reply. A daemon that is gone or hangs costs the timeout and
 * nothing more: the next request starts afresh, and a late reply is never taken for another's.
 *
 * @param request     "R", "R name", "r", "t", "v", "SUB_PORT", "PUB_PORT", …
 * @param timeout_ms  longest wait, ms, 1 or more
 * @param[out] out_reply  the reply's text, GZ_CONTROL_REPLY_SIZE bytes; written only on GZ_OK. A
 *                        command that was carried out is answered with text beginning "OK"; a
 *                        refusal says why
 * @retval GZ_ERR_TIMEOUT   no reply: most likely no daemon runs there
 * @retval GZ_ERR_ACCESS    the daemon refuses our keys, or we its; logged with the remedy
 * @retval GZ_ERR_PROTOCOL  the reply is too long or holds a NUL
 * @retval GZ_ERR_INVAL     @p timeout_ms is below 1
 * @retval GZ_ERR_NO_MEM    no room for a socket
 */
enum gz_result gz_control_request(struct gz_control *control, const char *request, int timeout_ms,
				  char out_reply[GZ_CONTROL_REPLY_SIZE]);

/**
 * Where the stream is that belongs to this control socket: its neighbour for ipc:// endpoints,
 * else the same host with the port that "SUB_PORT" tells.
 *
 * @param[out] text  the endpoint, written only on GZ_OK
 * @retval GZ_ERR_TIMEOUT      no reply
 * @retval GZ_ERR_UNSUPPORTED  the daemon tells no port: it serves no TCP
 * @retval GZ_ERR_FULL         @p size is too small
 * @retval …                   as gz_control_request()
 */
enum gz_result gz_control_stream_endpoint(struct gz_control *control, int timeout_ms, char *text,
					  size_t size);

/** The keys in use, NULL for none: those that its stream needs, too. Valid until the control is
 *  closed. */
const struct gz_keys *gz_control_keys(const struct gz_control *control);

/** The endpoint in use. Valid until the control is closed. */
const char *gz_control_endpoint(const struct gz_control *control);

/** Close and set to NULL; returns at once. Accepts a pointer to NULL. */
void gz_control_close(struct gz_control **control);

#ifdef __cplusplus
}
#endif

#endif
