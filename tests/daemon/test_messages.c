#include "suite.h"

#include <stdlib.h>
#include <string.h>

#include "base/clock.h"
#include "daemon/publisher.h"
#include "sim/tracker.h"

/* Simulated samples: 20 s at 500 Hz. */
enum { SAMPLES = 10000 };

static struct gz_sample *samples;
static struct gz_config config;

static int make_samples(void **state)
{
	(void)state;
	struct gz_sim_params params = gz_sim_default_params();
	struct gz_sim_tracker *tracker = NULL;
	params.rate_hz = 500;
	samples = calloc(SAMPLES, sizeof *samples);
	if (!samples || gz_sim_tracker_create(&params, 1000000000, NULL, &tracker) != GZ_OK)
		return -1;
	for (int i = 0; i < SAMPLES; i++) {
		struct gz_sim_sample next;
		gz_sim_tracker_next(tracker, &next);
		samples[i] = next.sample;
	}
	gz_sim_tracker_destroy(&tracker);
	char *argv[] = { (char *)"gazed", (char *)"--config", (char *)"/dev/null" };
	return gz_config_read(3, argv, NULL, &config) == GZ_OK ? 0 : -1;
}

static int free_samples(void **state)
{
	(void)state;
	free(samples);
	return 0;
}

static void make(struct gz_message_maker *maker)
{
	struct gz_display display = gz_display_default(1920, 1080);
	gz_message_maker_init(maker, &config, &config.pipeline, &display);
}

/* Whether two batches agree in every byte except publish_ns, which is the end of the gaze map. */
static bool same_but_publish_ns(const struct gz_outgoing_batch *a,
				const struct gz_outgoing_batch *b)
{
	if (a->count != b->count || a->step.rejection != b->step.rejection)
		return false;
	for (size_t i = 0; i < a->count; i++) {
		size_t size = a->item[i].body.size - (i == 0 ? GZ_WIRE_PUBLISH_SIZE : 0);
		if (strcmp(a->item[i].topic, b->item[i].topic) != 0 ||
		    a->item[i].body.size != b->item[i].body.size ||
		    memcmp(a->item[i].body.bytes, b->item[i].body.bytes, size) != 0)
			return false;
	}
	return true;
}

static void messages_of_a_sample_are_gaze_then_surfaces(void **state)
{
	(void)state;
	static struct gz_message_maker maker;
	static struct gz_outgoing_batch batch;
	make(&maker);
	gz_message_maker_step(&maker, &samples[0], 77, &batch);
	assert_true(batch.count >= 3);
	assert_string_equal(batch.item[0].topic, "gaze.3d.01.");
	assert_string_equal(batch.item[1].topic, "surfaces.screen");
	assert_string_equal(batch.item[2].topic, "surfaces.psychopy_iohub_surface");
	struct gz_gaze gaze;
	assert_int_equal(
		gz_wire_decode_gaze(batch.item[0].body.bytes, batch.item[0].body.size, &gaze),
		GZ_OK);
	assert_int_equal(gaze.publish_ns, 77);
	assert_int_equal(gaze.seq, samples[0].seq);
}

/* What nobody wants costs nothing, and the other messages stay the same bytes. */
static void messages_without_surfaces_are_the_others(void **state)
{
	(void)state;
	static struct gz_message_maker whole, part;
	static struct gz_outgoing_batch a, b;
	make(&whole);
	make(&part);
	part.without_surfaces = true;
	for (int i = 0; i < 1000; i++) {
		gz_message_maker_step(&whole, &samples[i], i, &a);
		gz_message_maker_step(&part, &samples[i], i, &b);
		assert_int_equal(a.count, b.count + whole.surface_count);
		size_t k = 0;
		for (size_t j = 0; j < a.count; j++) {
			if (strncmp(a.item[j].topic, "surfaces.", 9) == 0)
				continue;
			assert_string_equal(a.item[j].topic, b.item[k].topic);
			assert_int_equal(a.item[j].body.size, b.item[k].body.size);
			assert_memory_equal(a.item[j].body.bytes, b.item[k].body.bytes,
					    a.item[j].body.size);
			k++;
		}
		assert_int_equal(k, b.count);
	}
}

/* Note the label that a message makes certain; no sample may get a second one. */
static void note_label(const struct gz_gaze *gaze, bool labelled[SAMPLES])
{
	if (!gaze->final_known)
		return;
	for (uint64_t k = 0; k <= gaze->final_span; k++) {
		uint64_t index = gaze->final_seq - k - samples[0].seq;
		assert_true(index < SAMPLES && !labelled[index]);
		labelled[index] = true;
	}
}

/* However many samples there are, the last ones get their certain label from the flush. */
static void messages_give_every_sample_one_certain_label(void **state)
{
	(void)state;
	static struct gz_pipeline pipeline;
	static struct gz_pipeline_output out;
	static bool labelled[SAMPLES];
	struct gz_display display = gz_display_default(1920, 1080);
	const int counts[] = { 1, 2, 3, 50, 51, 700, SAMPLES };
	int waiting = 0;
	for (size_t c = 0; c < sizeof counts / sizeof *counts; c++) {
		struct gz_gaze last;
		memset(labelled, 0, sizeof labelled);
		gz_pipeline_init(&pipeline, &config.pipeline, &display);
		for (int i = 0; i < counts[c]; i++) {
			gz_pipeline_step(&pipeline, &samples[i], &out);
			note_label(&out.gaze, labelled);
		}
		while (gz_pipeline_flush(&pipeline, &last)) {
			assert_true(last.final_known);
			assert_int_equal(last.host_ns, samples[counts[c] - 1].host_ns);
			note_label(&last, labelled);
			waiting++;
		}
		for (int i = 0; i < counts[c]; i++)
			assert_true(labelled[i]);
	}
	assert_true(waiting > 0);
}

static void messages_of_the_end_are_event_final(void **state)
{
	(void)state;
	static struct gz_message_maker maker;
	static struct gz_outgoing_batch batch;
	static struct gz_outgoing last;
	make(&maker);
	assert_false(gz_message_maker_flush(&maker, &last));
	for (int i = 0; i < 100; i++)
		gz_message_maker_step(&maker, &samples[i], i, &batch);
	assert_true(gz_message_maker_flush(&maker, &last));
	assert_string_equal(last.topic, "event_final");
	assert_int_equal(gz_wire_check(last.body.bytes, last.body.size), GZ_OK);
	while (gz_message_maker_flush(&maker, &last))
		;
}

static void messages_of_twenty_seconds_hold_every_kind(void **state)
{
	(void)state;
	static struct gz_message_maker maker;
	static struct gz_outgoing_batch batch;
	size_t fixations = 0, saccades = 0, blinks = 0;
	make(&maker);
	for (int i = 0; i < SAMPLES; i++) {
		gz_message_maker_step(&maker, &samples[i], i, &batch);
		assert_true(batch.count <= GZ_MESSAGES_MAX);
		for (size_t k = 0; k < batch.count; k++) {
			assert_true(batch.item[k].body.size > 0);
			assert_int_equal(
				gz_wire_check(batch.item[k].body.bytes, batch.item[k].body.size),
				GZ_OK);
			fixations += strcmp(batch.item[k].topic, "fixations") == 0;
			saccades += strcmp(batch.item[k].topic, "saccades") == 0;
			blinks += strcmp(batch.item[k].topic, "blinks") == 0;
		}
	}
	if (fixations < 100 || saccades < 20 || blinks < 2)
		fail_msg("%zu fixations, %zu saccades, %zu blinks", fixations, saccades, blinks);
}

static void messages_of_the_same_samples_are_the_same_bytes_but_for_publish_ns(void **state)
{
	(void)state;
	static struct gz_message_maker live, replayed;
	static struct gz_outgoing_batch a, b;
	const int first = SAMPLES / 3;
	make(&live);
	make(&replayed);
	/* The live pipeline has been running for a while when the recording begins. */
	for (int i = 0; i < first; i++)
		gz_message_maker_step(&live, &samples[i], i, &a);
	gz_message_maker_reset(&live);
	for (int i = first; i < SAMPLES; i++) {
		gz_message_maker_step(&live, &samples[i], i, &a);
		gz_message_maker_step(&replayed, &samples[i], -7 * i, &b);
		if (!same_but_publish_ns(&a, &b))
			fail_msg("sample %d differs", i);
	}
}

static void messages_without_the_reset_would_differ(void **state)
{
	(void)state;
	/* The comparison above can fail, and the reset is necessary for it to pass. */
	static struct gz_message_maker live, replayed;
	static struct gz_outgoing_batch a, b;
	const int first = SAMPLES / 3;
	int different = 0;
	make(&live);
	make(&replayed);
	for (int i = 0; i < first; i++)
		gz_message_maker_step(&live, &samples[i], i, &a);
	for (int i = first; i < SAMPLES; i++) {
		gz_message_maker_step(&live, &samples[i], i, &a);
		gz_message_maker_step(&replayed, &samples[i], i, &b);
		different += !same_but_publish_ns(&a, &b);
	}
	assert_true(different > 0);
}

TEST_SUITE(messages)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(messages_of_a_sample_are_gaze_then_surfaces),
		cmocka_unit_test(messages_without_surfaces_are_the_others),
		cmocka_unit_test(messages_give_every_sample_one_certain_label),
		cmocka_unit_test(messages_of_the_end_are_event_final),
		cmocka_unit_test(messages_of_twenty_seconds_hold_every_kind),
		cmocka_unit_test(
			messages_of_the_same_samples_are_the_same_bytes_but_for_publish_ns),
		cmocka_unit_test(messages_without_the_reset_would_differ),
	};
	return cmocka_run_group_tests(tests, make_samples, free_samples);
}
