#include "protocol/wire_notification.h"

#include <stdio.h>

#include "base/clock.h"
#include "protocol/wire_pack.h"
#include "protocol/wire_unpack.h"

/* The head that all notifications share: "topic" and "subject". */
static void begin(struct gz_pack *pack, struct gz_wire_message *message, const char *subject,
		  size_t other_pairs)
{
	char topic[GZ_SUBJECT_SIZE + sizeof GZ_TOPIC_NOTIFY];
	snprintf(topic, sizeof topic, GZ_TOPIC_NOTIFY "%s", subject);
	gz_pack_begin(pack, message);
	gz_pack_map(pack, NULL, 2 + other_pairs);
	gz_pack_text(pack, "topic", topic);
	gz_pack_text(pack, "subject", subject);
}

enum gz_result gz_wire_encode_recording_started(const char *path, const char *session_name,
						int64_t start_ns,
						struct gz_wire_message *out_message)
{
	struct gz_pack pack;
	begin(&pack, out_message, GZ_SUBJECT_RECORDING_STARTED, 5);
	gz_pack_text(&pack, "rec_path", path);
	gz_pack_text(&pack, "session_name", session_name);
	gz_pack_bool(&pack, "record_eye", false);
	gz_pack_bool(&pack, "compression", false);
	gz_pack_time(&pack, "start_time_synced", start_ns);
	return gz_pack_end(&pack);
}

enum gz_result gz_wire_encode_recording_stopped(const char *path,
						struct gz_wire_message *out_message)
{
	struct gz_pack pack;
	begin(&pack, out_message, GZ_SUBJECT_RECORDING_STOPPED, 1);
	gz_pack_text(&pack, "rec_path", path);
	return gz_pack_end(&pack);
}

enum gz_result gz_wire_encode_calibration_failed(const char *reason, int64_t time_ns,
						 struct gz_wire_message *out_message)
{
	struct gz_pack pack;
	begin(&pack, out_message, GZ_SUBJECT_CALIBRATION_FAILED, 3);
	gz_pack_text(&pack, "reason", reason);
	gz_pack_time(&pack, "timestamp", time_ns);
	gz_pack_bool(&pack, "record", true);
	return gz_pack_end(&pack);
}

enum gz_result gz_wire_encode_doc(const char *actor, const char *doc,
				  struct gz_wire_message *out_message)
{
	struct gz_pack pack;
	begin(&pack, out_message, GZ_SUBJECT_DOC, 2);
	gz_pack_text(&pack, "actor", actor);
	gz_pack_text(&pack, "doc", doc);
	return gz_pack_end(&pack);
}

enum gz_result gz_wire_decode_notification(const void *bytes, size_t size,
					   struct gz_notification *out_notification)
{
	struct gz_notification notification = { 0 };
	struct gz_unpack unpack;
	gz_unpack_begin(&unpack, bytes, size);
	gz_unpack_text(&unpack, unpack.map, "subject", notification.subject,
		       sizeof notification.subject);
	gz_unpack_text(&unpack, unpack.map, "session_name", notification.session_name,
		       sizeof notification.session_name);
	if (notification.subject[0] == '\0')
		unpack.refused = true;
	enum gz_result result = gz_unpack_end(&unpack);
	if (result == GZ_OK)
		*out_notification = notification;
	return result;
}
