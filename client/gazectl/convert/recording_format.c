#include "client/gazectl/convert/recording_format.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

const struct gz_recording_reader *const gz_recording_readers[] = {
	&gz_recording_reader_pupil,
	&gz_recording_reader_eyelink,
	&gz_recording_reader_tobii,
	NULL,
};

const struct gz_recording_writer *const gz_recording_writers[] = {
	&gz_recording_writer_gzl,
	&gz_recording_writer_bids,
	&gz_recording_writer_csv,
	NULL,
};

const struct gz_recording_reader *gz_recording_reader_find(const char *name)
{
	for (size_t i = 0; gz_recording_readers[i]; i++)
		if (strcmp(gz_recording_readers[i]->name, name) == 0)
			return gz_recording_readers[i];
	return NULL;
}

const struct gz_recording_reader *gz_recording_reader_recognise(const char *line)
{
	for (size_t i = 0; gz_recording_readers[i]; i++)
		if (gz_recording_readers[i]->recognises(line))
			return gz_recording_readers[i];
	return NULL;
}

const struct gz_recording_writer *gz_recording_writer_find(const char *name)
{
	for (size_t i = 0; gz_recording_writers[i]; i++)
		if (strcmp(gz_recording_writers[i]->name, name) == 0)
			return gz_recording_writers[i];
	return NULL;
}

const struct gz_recording_writer *gz_recording_writer_of(const char *path)
{
	size_t length = strlen(path);
	for (size_t i = 0; gz_recording_writers[i]; i++) {
		size_t ending = strlen(gz_recording_writers[i]->ending);
		if (length > ending &&
		    strcmp(path + length - ending, gz_recording_writers[i]->ending) == 0)
			return gz_recording_writers[i];
	}
	return NULL;
}

struct gz_gaze_log_header gz_recording_header(const struct gz_convert_settings *settings,
					      const char *tracker)
{
	struct gz_gaze_log_header header = { .rate_hz = settings->rate_hz };
	gz_text_copy(header.tracker, sizeof header.tracker, tracker);
	snprintf(header.software, sizeof header.software, "gazectl %s", GAZECAST_VERSION);
	memcpy(header.display.px, settings->display_px, sizeof header.display.px);
	memcpy(header.display.mm, settings->display_mm, sizeof header.display.mm);
	header.display.distance_mm = settings->distance_mm;
	header.has_display = gz_display_valid(&header.display);
	if (!header.has_display)
		header.display = (struct gz_display) { 0 };
	return header;
}

struct gz_point gz_recording_point(double x, double y)
{
	if (!(fabs(x) <= 1000) || !(fabs(y) <= 1000))
		return (struct gz_point) { NAN, NAN };
	return (struct gz_point) { (float)x, (float)y };
}
