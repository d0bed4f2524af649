/* What clients send to the control socket and to the inlet. The first byte is the length of the
 * first frame; what is behind it is the second one, where there is anything. */
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "daemon/inlet.h"
#include "daemon/recorder.h"
#include "daemon/remote.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static void require(bool holds)
{
	if (!holds)
		abort();
}

static bool ends_within(const char *text, size_t size)
{
	return memchr(text, '\0', size) != NULL;
}

/* A name that is accepted stays in its directory. */
static void check_name(const char *name)
{
	if (gz_recording_name_valid(name))
		require(!strchr(name, '/') && strlen(name) <= 64 && name[0] != '\0');
}

static void check_request(const uint8_t *bytes, size_t size)
{
	struct gz_remote_request request;
	gz_remote_parse(bytes, size, &request);
	require(request.kind >= GZ_REMOTE_UNKNOWN && request.kind <= GZ_REMOTE_CALIBRATION_STOP);
	require(ends_within(request.name, sizeof request.name));
	require(request.kind == GZ_REMOTE_RECORD || request.name[0] == '\0');
	check_name(request.name);
}

static void check_message(const struct gz_inlet_message *message, size_t size)
{
	require(message->topic[0] != '\0' && ends_within(message->topic, sizeof message->topic));
	require(message->size == size && size <= sizeof message->body);
	require(strncmp(message->topic, "gaze", 4) != 0 || message->topic[4] != '.');
	if (message->is_mark)
		require(message->mark[0] != '\0' &&
			ends_within(message->mark, sizeof message->mark));
	if (!message->is_notification)
		return;
	const struct gz_notification *notification = &message->notification;
	require(notification->subject[0] != '\0' &&
		ends_within(notification->subject, sizeof notification->subject));
	require(ends_within(notification->session_name, sizeof notification->session_name));
	gz_remote_notice(notification->subject);
	check_name(notification->session_name);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	static struct gz_inlet_message message;
	if (size == 0)
		return 0;
	size_t first = data[0] < size - 1 ? data[0] : size - 1;
	const uint8_t *second = data + 1 + first;
	check_request(data + 1, first);
	enum gz_result result =
		gz_inlet_judge(data + 1, first, second, size - 1 - first, 77, &message);
	require(result == GZ_OK || result == GZ_ERR_ACCESS || result == GZ_ERR_PROTOCOL);
	if (result == GZ_OK)
		check_message(&message, size - 1 - first);
	else
		require(gz_inlet_refusal(result)[0] != '\0');
	return 0;
}
