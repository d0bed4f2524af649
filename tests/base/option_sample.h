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
	[SMOOTHING] = { "filter.smoothing", GZ_OPTION_DOUBLE, AT(smoothing_hz), 0.1, 100,
			.preset = "1.5", .help = "cutoff at rest, Hz" },
	[EYE] = { "camera.eye", GZ_OPTION_DOUBLE, AT(eye), -10, 10, .count = 3, .preset = "0 0 1",
		  .help = "where the camera stands" },
	[PORT] = { "publish.port", GZ_OPTION_INT, AT(port), 1024, 65535, .preset = "5570",
		   .help = "TCP port" },
	[SIZE] = { "size", GZ_OPTION_SIZE, AT(size), 1, 16384, .preset = "1920x1080",
		   .help = "picture, px" },
	[METHOD] = { "render.method", GZ_OPTION_CHOICE, AT(method), .choices = sample_methods,
		     .preset = "standard", .help = "how rays are spent" },
	[CROSS] = { "show_cross", GZ_OPTION_BOOL, AT(cross), .preset = "false",
		    .help = "draw a cross at the gaze" },
	[NAME] = { "publish.name", GZ_OPTION_STRING, AT(name),
		   .max = sizeof((struct settings *)0)->name, .help = "name of the stream" },
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
