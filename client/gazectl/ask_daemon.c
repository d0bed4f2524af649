/* How the commands ask the daemon: control socket, stream, requests, status. */
#include "client/gazectl/gazectl.h"

#include <stdio.h>
#include <string.h>

#include "base/clock.h"
#include "base/utf8.h"

#define GZ_LOG_MODULE "gazectl"

/* Longest wait for a connection. Chosen: a local one takes less than a millisecond, one across a
 * network some hundred. */
#define CONNECT_PATIENCE_NS (500 * GZ_NS_PER_MS)

void gazectl_report_no_daemon(const char *endpoint, const struct gz_log *log)
{
	gz_err(log, "no daemon answers at %s: start gazed, or give its endpoint with --endpoint",
	       endpoint);
}

enum gz_result gazectl_open_control(const struct gazectl_common *common, const struct gz_log *log,
				    struct gz_control **out_control)
{
	struct gz_keys keys;
	const char *endpoint = common->endpoint[0] ? common->endpoint : NULL;
	enum gz_result result =
		gz_keys_find(endpoint, common->keys, common->server_key, log, &keys);
	if (result != GZ_OK && result != GZ_ERR_NOT_FOUND)
		return result;
	result = gz_control_open_with_keys(endpoint, result == GZ_OK ? &keys : NULL, log,
					   out_control);
	explicit_bzero(&keys, sizeof keys);
	return result;
}

static bool wait_connected(struct gz_stream *stream)
{
	int64_t deadline_ns = gz_clock_now_ns() + CONNECT_PATIENCE_NS;
	struct gz_stream_counters counters;
	gz_stream_get_counters(stream, &counters);
	while (!counters.connected && gz_clock_now_ns() < deadline_ns) {
		gz_clock_sleep_until_ns(gz_clock_now_ns() + GZ_NS_PER_MS);
		gz_stream_get_counters(stream, &counters);
	}
	return counters.connected;
}

enum gazectl_exit gazectl_open_stream(struct gz_control *control, const char *const *topics,
				      const struct gz_log *log, struct gz_stream **out_stream)
{
	char endpoint[256];
	enum gz_result result = gz_control_stream_endpoint(control, GZ_CONTROL_TIMEOUT_MS, endpoint,
							   sizeof endpoint);
	if (result == GZ_ERR_TIMEOUT) {
		gazectl_report_no_daemon(gz_control_endpoint(control), log);
		return GAZECTL_NO_DAEMON;
	}
	if (result == GZ_ERR_ACCESS)
		return GAZECTL_FAILED;
	if (result != GZ_OK) {
		gz_err(log,
		       "%s does not return the port of its stream: set tcp = loopback in "
		       "gazed.conf",
		       gz_control_endpoint(control));
		return GAZECTL_FAILED;
	}
	struct gz_stream *stream;
	if (gz_stream_open_with_keys(endpoint, topics, gz_control_keys(control), log, &stream) !=
	    GZ_OK)
		return GAZECTL_FAILED;
	if (!wait_connected(stream)) {
		gazectl_report_no_daemon(gz_control_endpoint(control), log);
		gz_stream_close(&stream);
		return GAZECTL_NO_DAEMON;
	}
	*out_stream = stream;
	return GAZECTL_DONE;
}

enum gazectl_exit gazectl_request(struct gz_control *control, const char *request,
				  const struct gz_log *log, char out_reply[GZ_CONTROL_REPLY_SIZE])
{
	enum gz_result result =
		gz_control_request(control, request, GZ_CONTROL_TIMEOUT_MS, out_reply);
	if (result == GZ_ERR_TIMEOUT) {
		gazectl_report_no_daemon(gz_control_endpoint(control), log);
		return GAZECTL_NO_DAEMON;
	}
	if (result == GZ_ERR_ACCESS)
		return GAZECTL_FAILED;
	if (result != GZ_OK) {
		gz_err(log, "%s: %s; is this the control socket of gazed?",
		       gz_control_endpoint(control), gz_result_text(result));
		return GAZECTL_FAILED;
	}
	gz_utf8_clean(out_reply);
	if (strncmp(out_reply, "OK", 2) == 0)
		return GAZECTL_DONE;
	gz_err(log, "the daemon refuses: %s", out_reply);
	return GAZECTL_FAILED;
}

static void make_status_printable(struct gz_status *status)
{
	gz_utf8_clean(status->tracker.name);
	gz_utf8_clean(status->tracker.serial);
	gz_utf8_clean(status->tracker.reason);
	gz_utf8_clean(status->recording.file);
	gz_utf8_clean(status->recording.error);
	gz_utf8_clean(status->version);
}

bool gazectl_next_status(struct gz_stream *stream, int64_t deadline_ns,
			 struct gz_status *out_status)
{
	struct gz_message message;
	while (gz_clock_now_ns() < deadline_ns && !gz_command_interrupted()) {
		if (gz_stream_read(stream, 100, &message) != GZ_OK ||
		    message.kind != GZ_MESSAGE_STATUS)
			continue;
		*out_status = message.status;
		make_status_printable(out_status);
		return true;
	}
	return false;
}
