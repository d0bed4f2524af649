#include "bench/filter/labelled_recording.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <zlib.h>

const char *const gz_labelled_stimulus_names[GZ_LABELLED_STIMULI] = { "img", "dots", "video" };

const struct gz_labelled_file gz_labelled_files[GZ_LABELLED_FILES] = {
	{ GZ_LABELLED_IMAGES, "img_TH34_img_Europe" },
	{ GZ_LABELLED_IMAGES, "img_TH34_img_vy" },
	{ GZ_LABELLED_IMAGES, "img_TL20_img_konijntjes" },
	{ GZ_LABELLED_IMAGES, "img_UH21_img_Rome" },
	{ GZ_LABELLED_IMAGES, "img_UH29_img_Europe" },
	{ GZ_LABELLED_IMAGES, "img_UL23_img_Europe" },
	{ GZ_LABELLED_IMAGES, "img_UL43_img_Rome" },
	{ GZ_LABELLED_DOTS, "dots_TH20_trial1" },
	{ GZ_LABELLED_DOTS, "dots_TL22_trial17" },
	{ GZ_LABELLED_DOTS, "dots_UH21_trial17" },
	{ GZ_LABELLED_DOTS, "dots_UH25_trial1" },
	{ GZ_LABELLED_DOTS, "dots_UL27_trial17" },
	{ GZ_LABELLED_VIDEOS, "video_TH34_video_BergoDalbana" },
	{ GZ_LABELLED_VIDEOS, "video_TL30_video_triple_jump" },
	{ GZ_LABELLED_VIDEOS, "video_UH21_video_BergoDalbana" },
	{ GZ_LABELLED_VIDEOS, "video_UL23_video_triple_jump" },
};

/* Coder MN corrected one file, which therefore has another name. */
static gzFile open_labelled(const char *data, size_t file, int coder)
{
	static const char *const coders[GZ_LABELLED_CODERS] = { "MN", "RA" };
	const char *name = gz_labelled_files[file].name;
	const bool corrected = coder == 0 && strcmp(name, "img_UH29_img_Europe") == 0;
	char path[1024];
	const int length = snprintf(
		path, sizeof path, "%s/gaze/andersson2017/%s_labelled_%s%s.tsv.gz", data,
		corrected ? "fix_UH29_img_Europe" : name, corrected ? "FIX_" : "", coders[coder]);
	return length < (int)sizeof path ? gzopen(path, "rb") : NULL;
}

static bool make_room(struct gz_labelled_recording *recording)
{
	if (recording->count < recording->room)
		return true;
	const size_t room = recording->room ? 2 * recording->room : 4096;
	struct gz_sample *sample = realloc(recording->sample, room * sizeof *sample);
	if (sample)
		recording->sample = sample;
	int *label = realloc(recording->label, room * sizeof *label);
	if (label)
		recording->label = label;
	if (!sample || !label)
		return false;
	recording->room = room;
	return true;
}

bool gz_labelled_recording_add(struct gz_labelled_recording *recording,
			       const struct gz_sample *sample, int label)
{
	if (!make_room(recording))
		return false;
	recording->sample[recording->count] = *sample;
	recording->label[recording->count++] = label;
	return true;
}

/* @param pupil_px  mean of its width and height in the eye camera's picture */
static bool add_labelled(struct gz_labelled_recording *recording, double x_px, double y_px,
			 double pupil_px, int label)
{
	size_t i = recording->count;
	struct gz_sample sample = gz_sample_unmeasured();
	sample.seq = i;
	sample.host_ns = 1000000000 + (int64_t)i * 2000000; /* some files have no times: 500 Hz */
	bool measured = isfinite(x_px) && isfinite(y_px) && (x_px != 0 || y_px != 0);
	if (measured) {
		sample.valid = true;
		sample.point = (struct gz_point) { (float)(x_px / recording->display.px[0]),
						   (float)(y_px / recording->display.px[1]) };
		if (pupil_px > 0)
			sample.eye[GZ_EYE_RIGHT].pupil_mm = (float)pupil_px;
	}
	return gz_labelled_recording_add(recording, &sample, label);
}

bool gz_labelled_recording_read(const char *data, size_t recording, int coder,
				struct gz_labelled_recording *out)
{
	*out = (struct gz_labelled_recording) { .display = { { 1024, 768 }, { 380, 300 }, 670 } };
	/* As in img_TH34_img_Europe. */
	(void)sscanf(gz_labelled_files[recording].name, "%*[^_]_%15[^_]", out->observer);
	gzFile file = data ? open_labelled(data, recording, coder) : NULL;
	if (!file)
		return false;
	char line[256];
	bool good = true;
	while (good && gzgets(file, line, sizeof line)) {
		double time_us, pupil_h, pupil_v, x_px, y_px;
		int label;
		if (line[0] == '#')
			continue;
		good = sscanf(line, "%lf %lf %lf %lf %lf %d", &time_us, &pupil_h, &pupil_v, &x_px,
			      &y_px, &label) == 6 &&
		       add_labelled(out, x_px, y_px, (pupil_h + pupil_v) / 2, label);
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

void gz_agreement_add(struct gz_agreement *agreement, bool ours, bool theirs)
{
	agreement->all++;
	agreement->both += ours && theirs;
	agreement->ours += ours;
	agreement->theirs += theirs;
}

double gz_agreement_kappa(const struct gz_agreement *a)
{
	const double neither = a->all - a->ours - a->theirs + a->both;
	const double observed = (a->both + neither) / a->all;
	const double chance = (a->ours * a->theirs + (a->all - a->ours) * (a->all - a->theirs)) /
			      (a->all * a->all);
	return (observed - chance) / (1 - chance);
}
