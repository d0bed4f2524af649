/**
 * @file
 * A table with every type of option, for the option tests.
 */
#ifndef GZ_TESTS_BASE_OPTION_SAMPLE_H
#define GZ_TESTS_BASE_OPTION_SAMPLE_H

#include "base/option.h"

struct settings {
	double smoothing_hz;
	double eye[3];
	int port;
	int size[2];
	int method;
	bool cross;
	char name[16];
};

static const char *const sample_methods[] = { "standard", "mdc", "ddc", "acuity", NULL };

#define AT(field) offsetof(struct settings, field)

enum { SMOOTHING, EYE, PORT, SIZE, METHOD, CROSS, NAME };

static const struct gz_option sample_options[] = {
	[SMOOTHING] = { .key = "filter.smoothing",
			.type = GZ_OPTION_DOUBLE,
			.offset = AT(smoothing_hz),
			.min = 0.1,
			.max = 100,
			.preset = "1.5",
			.help = "cutoff at rest, Hz" },
	[EYE] = { .key = "camera.eye",
		  .type = GZ_OPTION_DOUBLE,
		  .offset = AT(eye),
		  .min = -10,
		  .max = 10,
		  .count = 3,
		  .preset = "0 0 1",
		  .help = "where the camera stands" },
	[PORT] = { .key = "publish.port",
		   .type = GZ_OPTION_INT,
		   .offset = AT(port),
		   .min = 1024,
		   .max = 65535,
		   .preset = "5570",
		   .help = "TCP port" },
	[SIZE] = { .key = "size",
		   .type = GZ_OPTION_SIZE,
		   .offset = AT(size),
		   .min = 1,
		   .max = 16384,
		   .preset = "1920x1080",
		   .help = "picture, px" },
	[METHOD] = { .key = "render.method",
		     .type = GZ_OPTION_CHOICE,
		     .offset = AT(method),
		     .choices = sample_methods,
		     .preset = "standard",
		     .help = "how rays are spent" },
	[CROSS] = { .key = "show_cross",
		    .type = GZ_OPTION_BOOL,
		    .offset = AT(cross),
		    .preset = "false",
		    .help = "draw a cross at the gaze" },
	[NAME] = { .key = "publish.name",
		   .type = GZ_OPTION_STRING,
		   .offset = AT(name),
		   .max = sizeof((struct settings *)0)->name,
		   .help = "name of the stream" },
};

enum { SAMPLE_COUNT = sizeof sample_options / sizeof *sample_options };

static inline struct gz_option_binding sample_binding(struct settings *target, bool *given)
{
	return (struct gz_option_binding) {
		.options = sample_options,
		.count = SAMPLE_COUNT,
		.target = target,
		.given = given,
	};
}

#endif
