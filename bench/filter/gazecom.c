#include "bench/filter/gazecom.h"

#include <stdio.h>
#include <string.h>
#include <zlib.h>

const char *const gz_gazecom_films[GZ_GAZECOM_FILMS] = { "beach",      "bridge_2",
							 "ducks_boat", "holsten_gate",
							 "puppies",    "st_petri_mcdonalds" };

/* The label of a letter; 0 if there is no such label. */
static int label_of_letter(char letter)
{
	switch (letter) {
	case 'F':
		return GZ_HUMAN_FIXATION;
	case 'S':
		return GZ_HUMAN_SACCADE;
	case 'P':
		return GZ_HUMAN_PURSUIT;
	case 'B':
		return GZ_HUMAN_BLINK;
	default:
		return 0;
	}
}

/* Add a line to the recording of its observer, whose lines are consecutive. */
static bool add_line(const char *line, char last_observer[GZ_OBSERVER_SIZE], struct gz_gazecom *out)
{
	char observer[GZ_OBSERVER_SIZE], letter;
	double x, y, confidence;
	if (sscanf(line, "%15s %lf %lf %lf %c", observer, &x, &y, &confidence, &letter) != 5 ||
	    !label_of_letter(letter))
		return false;
	if (strcmp(observer, last_observer) != 0) {
		if (out->count == GZ_GAZECOM_OBSERVERS_MAX)
			return false;
		out->recording[out->count++] = (struct gz_labelled_recording) {
			.display = { { 1280, 720 }, { 400, 225 }, 450 },
		};
		strcpy(out->recording[out->count - 1].observer, observer);
		strcpy(last_observer, observer);
	}
	struct gz_labelled_recording *recording = &out->recording[out->count - 1];
	struct gz_sample sample = gz_sample_unmeasured();
	sample.seq = recording->count;
	sample.host_ns = 1000000000 + (int64_t)recording->count * 4000000;
	sample.valid = confidence >= 0.5 && (x != 0 || y != 0);
	if (sample.valid)
		sample.point = (struct gz_point) { (float)x, (float)y };
	return gz_labelled_recording_add(recording, &sample, label_of_letter(letter));
}

bool gz_gazecom_read(const char *data, size_t film, struct gz_gazecom *out)
{
	*out = (struct gz_gazecom) { .count = 0 };
	char path[1024], line[256], observer[GZ_OBSERVER_SIZE] = "";
	if (!data || snprintf(path, sizeof path, "%s/gaze/gazecom/%s.tsv.gz", data,
			      gz_gazecom_films[film]) >= (int)sizeof path)
		return false;
	gzFile file = gzopen(path, "rb");
	if (!file)
		return false;
	bool good = gzgets(file, line, sizeof line); /* the names of the columns */
	while (good && gzgets(file, line, sizeof line))
		good = add_line(line, observer, out);
	gzclose(file);
	return good && out->count > 0;
}

void gz_gazecom_free(struct gz_gazecom *gazecom)
{
	for (size_t i = 0; i < gazecom->count; i++)
		gz_labelled_recording_free(&gazecom->recording[i]);
	gazecom->count = 0;
}
