#include "daemon/lsl/lsl_stream.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/clock.h"

/* One channel, with the words of XDF's gaze conventions. */
struct lsl_channel {
	const char *label;
	const char *type;
	const char *unit;
	const char *coordinates; /* NULL: it is no place */
};

/* Pixels count from the upper left corner of the display. */
static const struct lsl_channel both_channels[] = {
	{ "seq", "FrameNumber", "count", NULL },
	{ "gaze_x", "ScreenX", "pixels", "image-space" },
	{ "gaze_y", "ScreenY", "pixels", "image-space" },
	{ "raw_x", "ScreenX", "pixels", "image-space" },
	{ "raw_y", "ScreenY", "pixels", "image-space" },
	{ "confidence", "Confidence", "normalized", NULL },
};

/* The object of object-space is the tracker. */
static const struct lsl_channel eye_channels[] = {
	{ "gaze_x", "ScreenX", "pixels", "image-space" },
	{ "gaze_y", "ScreenY", "pixels", "image-space" },
	{ "confidence", "Confidence", "normalized", NULL },
	{ "pupil_diameter", "Diameter", "mm", NULL },
	{ "position_x", "PositionX", "mm", "object-space" },
	{ "position_y", "PositionY", "mm", "object-space" },
	{ "position_z", "PositionZ", "mm", "object-space" },
	{ "direction_x", "DirectionX", "normalized", "object-space" },
	{ "direction_y", "DirectionY", "normalized", "object-space" },
	{ "direction_z", "DirectionZ", "normalized", "object-space" },
};

enum {
	BOTH_CHANNELS = sizeof both_channels / sizeof *both_channels,
	EYE_CHANNELS = sizeof eye_channels / sizeof *eye_channels,
};
_Static_assert(BOTH_CHANNELS + GZ_EYE_COUNT * EYE_CHANNELS == GZ_LSL_CHANNELS,
	       "the description has every channel");

static const char *const eye_names[GZ_EYE_COUNT] = {
	[GZ_EYE_RIGHT] = "right",
	[GZ_EYE_LEFT] = "left",
};

bool gz_lsl_device_same(const struct gz_lsl_device *a, const struct gz_lsl_device *b)
{
	return strcmp(a->tracker, b->tracker) == 0 && strcmp(a->serial, b->serial) == 0 &&
	       a->rate_hz == b->rate_hz && gz_display_same(&a->display, &b->display);
}

/* @param eye  "right" or "left", which begins the label; NULL: both */
static void append_channel(const struct gz_lsl_library *library, struct gz_lsl_element *channels,
			   const struct lsl_channel *channel, const char *eye)
{
	char label[GZ_NAME_SIZE];
	struct gz_lsl_element *element = library->append_child(channels, "channel");
	snprintf(label, sizeof label, "%s%s%s", eye ? eye : "", eye ? "_" : "", channel->label);
	library->append_child_value(element, "label", label);
	library->append_child_value(element, "eye", eye ? eye : "both");
	library->append_child_value(element, "type", channel->type);
	library->append_child_value(element, "unit", channel->unit);
	if (channel->coordinates)
		library->append_child_value(element, "coordinate_system", channel->coordinates);
}

static void append_channels(const struct gz_lsl_library *library, struct gz_lsl_element *root)
{
	struct gz_lsl_element *channels = library->append_child(root, "channels");
	for (int i = 0; i < BOTH_CHANNELS; i++)
		append_channel(library, channels, &both_channels[i], NULL);
	for (int eye = 0; eye < GZ_EYE_COUNT; eye++)
		for (int i = 0; i < EYE_CHANNELS; i++)
			append_channel(library, channels, &eye_channels[i], eye_names[eye]);
}

static void append_number(const struct gz_lsl_library *library, struct gz_lsl_element *parent,
			  const char *name, double value)
{
	char text[32];
	snprintf(text, sizeof text, "%.9g", value);
	library->append_child_value(parent, name, text);
}

static void append_display(const struct gz_lsl_library *library, struct gz_lsl_element *root,
			   const struct gz_display *display)
{
	struct gz_lsl_element *setup = library->append_child(root, "setup");
	struct gz_lsl_element *element = library->append_child(setup, "display");
	append_number(library, element, "width_px", display->px[0]);
	append_number(library, element, "height_px", display->px[1]);
	append_number(library, element, "width_mm", display->mm[0]);
	append_number(library, element, "height_mm", display->mm[1]);
	append_number(library, element, "distance_mm", display->distance_mm);
}

static void append_acquisition(const struct gz_lsl_library *library, struct gz_lsl_element *root,
			       const struct gz_lsl_device *device)
{
	struct gz_lsl_element *acquisition = library->append_child(root, "acquisition");
	library->append_child_value(acquisition, "model", device->tracker);
	if (device->serial[0])
		library->append_child_value(acquisition, "serial_number", device->serial);
}

struct gz_lsl_info *gz_lsl_describe_gaze(const struct gz_lsl_library *library, const char *name,
					 const char *host, const struct gz_lsl_device *device)
{
	char source[5 * GZ_NAME_SIZE];
	/* A reader that lost its stream goes on with one of the same source. */
	snprintf(source, sizeof source, "gazed gaze %s %s %s %s", host, name, device->tracker,
		 device->serial);
	struct gz_lsl_info *info = library->create_streaminfo(
		name, "Gaze", GZ_LSL_CHANNELS,
		device->rate_hz > 0 ? device->rate_hz : GZ_LSL_IRREGULAR_RATE, GZ_LSL_DOUBLE,
		source);
	if (!info)
		return NULL;
	struct gz_lsl_element *root = library->get_desc(info);
	append_channels(library, root);
	append_acquisition(library, root, device);
	append_display(library, root, &device->display);
	return info;
}

struct gz_lsl_info *gz_lsl_describe_events(const struct gz_lsl_library *library, const char *name,
					   const char *host)
{
	char stream[GZ_NAME_SIZE + 16], source[5 * GZ_NAME_SIZE];
	snprintf(stream, sizeof stream, "%s events", name);
	snprintf(source, sizeof source, "gazed events %s %s", host, name);
	return library->create_streaminfo(stream, "Markers", 1, GZ_LSL_IRREGULAR_RATE,
					  GZ_LSL_STRING, source);
}

static void fill_pixels(struct gz_point point, const struct gz_display *display,
			double out_values[2])
{
	out_values[0] = (double)point.x * display->px[0];
	out_values[1] = (double)point.y * display->px[1];
}

static void fill_eye(const struct gz_gaze_eye *eye, const struct gz_display *display,
		     double out_values[EYE_CHANNELS])
{
	const struct gz_point nowhere = { NAN, NAN };
	fill_pixels(eye->valid ? eye->point : nowhere, display, out_values);
	out_values[2] = (double)eye->confidence;
	out_values[3] = (double)eye->pupil_mm;
	for (int i = 0; i < 3; i++) {
		out_values[4 + i] = (double)eye->origin_mm[i];
		out_values[7 + i] = (double)eye->direction[i];
	}
}

void gz_lsl_values(const struct gz_gaze *gaze, const struct gz_display *display,
		   double out_values[GZ_LSL_CHANNELS])
{
	out_values[0] = (double)gaze->seq;
	fill_pixels(gaze->point, display, out_values + 1);
	fill_pixels(gaze->raw, display, out_values + 3);
	out_values[5] = (double)gaze->confidence;
	for (int eye = 0; eye < GZ_EYE_COUNT; eye++)
		fill_eye(&gaze->eye[eye], display, out_values + BOTH_CHANNELS + eye * EYE_CHANNELS);
}

static size_t add_event(struct gz_lsl_event *events, size_t count, int64_t host_ns,
			const char *label)
{
	events[count] = (struct gz_lsl_event) { host_ns, label };
	return count + 1;
}

static size_t add_fixation(struct gz_lsl_events *events, const struct gz_fixation *fixation,
			   struct gz_lsl_event *out_events, size_t count)
{
	if (!events->in_fixation || events->fixation_id != fixation->id)
		count = add_event(out_events, count, fixation->onset_ns, "fixation_onset");
	if (fixation->final)
		count = add_event(out_events, count, fixation->onset_ns + fixation->duration_ns,
				  "fixation_offset");
	events->in_fixation = !fixation->final;
	events->fixation_id = fixation->id;
	return count;
}

size_t gz_lsl_events_step(struct gz_lsl_events *events, const struct gz_pipeline_output *step,
			  struct gz_lsl_event out_events[GZ_LSL_EVENTS_MAX])
{
	size_t count = 0;
	for (size_t i = 0; i < step->fixation_count; i++)
		count = add_fixation(events, &step->fixations[i], out_events, count);
	for (size_t i = 0; i < step->blink_count; i++)
		count = add_event(out_events, count, step->blinks[i].time_ns,
				  step->blinks[i].onset ? "blink_onset" : "blink_offset");
	for (size_t i = 0; i < step->saccade_count; i++) {
		const struct gz_saccade *saccade = &step->saccades[i];
		count = add_event(out_events, count, saccade->start_ns, "saccade_onset");
		count = add_event(out_events, count, saccade->start_ns + saccade->duration_ns,
				  "saccade_offset");
	}
	return count;
}

double gz_lsl_offset_step(double offset_s, int64_t before_ns, double lsl_s, int64_t after_ns)
{
	double error_s = gz_ns_to_s(after_ns - before_ns) / 2;
	double measured_s = lsl_s - gz_ns_to_s(before_ns) - error_s;
	return fabs(measured_s - offset_s) <= error_s ? offset_s : measured_s;
}
