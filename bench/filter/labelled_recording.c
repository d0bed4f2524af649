#include "bench/filter/labelled_recording.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <zlib.h>

static bool grow(struct gz_labelled_recording *recording, size_t *capacity)
{
	if (recording->count < *capacity)
		return true;
	*capacity = *capacity ? 2 * *capacity : 4096;
	struct gz_sample *sample = realloc(recording->sample, *capacity * sizeof *sample);
	if (sample)
		recording->sample = sample;
	int *label = realloc(recording->label, *capacity * sizeof *label);
	if (label)
		recording->label = label;
	return sample && label;
}

static void add_labelled(struct gz_labelled_recording *recording, double x_px, double y_px,
			 int label)
{
	size_t i = recording->count++;
	struct gz_sample sample = gz_sample_unmeasured();
	sample.seq = i;
	sample.host_ns = 1000000000 + (int64_t)i * 2000000; /* some files have no times: 500 Hz */
	bool measured = isfinite(x_px) && isfinite(y_px) && (x_px != 0 || y_px != 0);
	if (measured) {
		sample.valid = true;
		sample.point = (struct gz_point) { (float)(x_px / recording->display.px[0]),
						   (float)(y_px / recording->display.px[1]) };
	}
	recording->sample[i] = sample;
	recording->label[i] = label;
}

bool gz_labelled_recording_read(const char *path, struct gz_labelled_recording *out)
{
	*out = (struct gz_labelled_recording) { .display = { { 1024, 768 }, { 380, 300 }, 670 } };
	gzFile file = gzopen(path, "rb");
	if (!file)
		return false;
	char line[256];
	size_t capacity = 0;
	bool good = true;
	while (good && gzgets(file, line, sizeof line)) {
		double time_us, pupil_h, pupil_v, x_px, y_px;
		int label;
		if (line[0] == '#')
			continue;
		good = sscanf(line, "%lf %lf %lf %lf %lf %d", &time_us, &pupil_h, &pupil_v, &x_px,
			      &y_px, &label) == 6 &&
		       grow(out, &capacity);
		if (good)
			add_labelled(out, x_px, y_px, label);
	}
	gzclose(file);
	return good && out->count > 0;
}

void gz_labelled_recording_free(struct gz_labelled_recording *recording)
{
	free(recording->sample);
	free(recording->label);
	*recording = (struct gz_labelled_recording) { .count = 0 };
}
