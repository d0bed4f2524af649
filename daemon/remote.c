#include "daemon/remote.h"

#include <string.h>

/* The first word of each request; only "R" and "T" may be followed by more. */
static const struct {
	const char *word;
	enum gz_remote_kind kind;
} words[] = {
	{ "R", GZ_REMOTE_RECORD },
	{ "r", GZ_REMOTE_STOP },
	{ "t", GZ_REMOTE_TIME },
	{ "T", GZ_REMOTE_SET_TIME },
	{ "v", GZ_REMOTE_VERSION },
	{ "SUB_PORT", GZ_REMOTE_STREAM_PORT },
	{ "PUB_PORT", GZ_REMOTE_INLET_PORT },
	{ "LATEST_PORT", GZ_REMOTE_LATEST_PORT },
	{ "CORRECTION", GZ_REMOTE_CORRECTION },
	{ "C", GZ_REMOTE_CALIBRATE },
	{ "c", GZ_REMOTE_CALIBRATION_STOP },
};

void gz_remote_parse(const void *bytes, size_t size, struct gz_remote_request *out)
{
	char text[GZ_REMOTE_REQUEST_SIZE];
	*out = (struct gz_remote_request) { .kind = GZ_REMOTE_UNKNOWN };
	if (size >= sizeof text || memchr(bytes, '\0', size))
		return;
	memcpy(text, bytes, size);
	text[size] = '\0';
	char *blank = strchr(text, ' ');
	const char *argument = blank ? blank + 1 : "";
	if (blank)
		*blank = '\0';
	for (size_t i = 0; i < sizeof words / sizeof *words; i++) {
		if (strcmp(words[i].word, text) == 0)
			out->kind = words[i].kind;
	}
	if (out->kind == GZ_REMOTE_RECORD)
		memcpy(out->name, argument, strlen(argument) + 1);
	else if (blank && out->kind != GZ_REMOTE_SET_TIME)
		out->kind = GZ_REMOTE_UNKNOWN;
}

enum gz_remote_notice gz_remote_notice(const char *subject)
{
	static const struct {
		const char *subject;
		enum gz_remote_notice notice;
	} subjects[] = {
		{ GZ_SUBJECT_RECORDING_START, GZ_REMOTE_NOTICE_RECORD },
		{ GZ_SUBJECT_RECORDING_STOP, GZ_REMOTE_NOTICE_STOP },
		{ GZ_SUBJECT_CALIBRATION_START, GZ_REMOTE_NOTICE_CALIBRATE },
		{ GZ_SUBJECT_SHOULD_DOC, GZ_REMOTE_NOTICE_DOC },
	};
	for (size_t i = 0; i < sizeof subjects / sizeof *subjects; i++) {
		if (strcmp(subjects[i].subject, subject) == 0)
			return subjects[i].notice;
	}
	return GZ_REMOTE_NOTICE_OTHER;
}

const char *gz_remote_doc(void)
{
	return "Requests of one frame: R [name], r, t, v, SUB_PORT, PUB_PORT, LATEST_PORT, "
	       "CORRECTION; T, C and c are refused.\n"
	       "Notifications that the daemon acts on: recording.should_start (session_name), "
	       "recording.should_stop, meta.should_doc; calibration.should_start is answered with "
	       "calibration.failed. All others are passed on to every reader.\n"
	       "Notifications that the daemon sends: recording.started, recording.stopped, "
	       "calibration.failed, meta.doc.";
}
