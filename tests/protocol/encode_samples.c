/* Write one message of each kind into a folder: for read_samples.py, and as seeds of
 * tests/fuzz/corpus/wire. */
#include <stdio.h>

#include "protocol/sample_messages.h"
#include "protocol/wire.h"

static int write_message(const char *folder, const char *name, enum gz_result encoded,
			 const struct gz_wire_message *message)
{
	char path[4096];
	snprintf(path, sizeof path, "%s/%s", folder, name);
	FILE *file = encoded == GZ_OK ? fopen(path, "wb") : NULL;
	if (!file) {
		fprintf(stderr, "cannot write %s\n", path);
		return 1;
	}
	size_t written = fwrite(message->bytes, 1, message->size, file);
	return fclose(file) != 0 || written != message->size;
}

int main(int argc, char **argv)
{
	if (argc != 2) {
		fprintf(stderr, "usage: %s FOLDER\n", argv[0]);
		return 2;
	}
	const char *folder = argv[1];
	struct gz_wire_message message;
	struct gz_display display = sample_display();
	struct gz_gaze gaze = sample_gaze();
	struct gz_fixation fixation = sample_fixation();
	struct gz_blink blink = sample_blink();
	struct gz_saccade saccade = sample_saccade();
	struct gz_status status = sample_status();
	int failed = 0;
	failed |= write_message(folder, "gaze", gz_wire_encode_gaze(&gaze, &display, &message),
				&message);
	failed |=
		write_message(folder, "surface",
			      gz_wire_encode_surface(&gaze, NULL, 0, "screen", &message), &message);
	gaze.eye[GZ_EYE_LEFT].valid = false;
	gaze.raw = (struct gz_point) { NAN, NAN };
	gaze.device_ns = GZ_NO_DEVICE_TIME;
	gaze.final_known = false;
	failed |= write_message(folder, "gaze_right",
				gz_wire_encode_gaze(&gaze, &display, &message), &message);
	failed |= write_message(folder, "fixation", gz_wire_encode_fixation(&fixation, &message),
				&message);
	failed |= write_message(folder, "blink", gz_wire_encode_blink(&blink, &message), &message);
	failed |= write_message(folder, "saccade", gz_wire_encode_saccade(&saccade, &message),
				&message);
	failed |=
		write_message(folder, "status", gz_wire_encode_status(&status, &message), &message);
	return failed;
}
