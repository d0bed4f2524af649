#include "suite.h"

#include "recorded.h"

#include <stdio.h>

static void count_sample(struct recorded *recorded, const struct gz_sample *sample,
			 int64_t *last_ns)
{
	if (recorded->samples++ == 0) {
		recorded->first_seq = sample->seq;
	} else {
		int64_t step_ns = sample->host_ns - *last_ns;
		recorded->backwards += step_ns <= 0;
		if (step_ns > recorded->longest_ns)
			recorded->longest_ns = step_ns;
	}
	recorded->last_seq = sample->seq;
	*last_ns = sample->host_ns;
}

struct recorded recorded_read(const char *recordings, const char *name)
{
	char path[256];
	struct gz_gaze_log_reader *reader = NULL;
	struct gz_gaze_log_record record;
	struct recorded recorded = { 0 };
	enum gz_result result;
	int64_t last_ns = 0;
	snprintf(path, sizeof path, "%s/%s", recordings, name);
	assert_int_equal(gz_gaze_log_open(path, NULL, &reader), GZ_OK);
	while ((result = gz_gaze_log_read(reader, &record)) != GZ_ERR_END) {
		if (result != GZ_OK) {
			recorded.malformed++;
		} else if (record.kind == GZ_GAZE_LOG_SAMPLE) {
			count_sample(&recorded, &record.sample, &last_ns);
		} else if (record.kind == GZ_GAZE_LOG_GAP) {
			recorded.outages += record.missing == 0;
			/* Those before the first sample are no gap between two. */
			recorded.missing += recorded.samples > 0 ? record.missing : 0;
		}
	}
	recorded.ending = gz_gaze_log_ending(reader);
	gz_gaze_log_close(&reader);
	return recorded;
}
