/* Who watches a decoder process: what it takes, what it refuses, and that nothing is left. */
#include "suite.h"

#include <dirent.h>
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include "base/captured_log.h"
#include "render/data/series_list.h"
#include "render/data/volume.h"
#include "render/decode/decode.h"
#include "volume_files.h"

/* A patience that a decoder that does nothing exhausts soon, ms. */
#define SHORT_PATIENCE_MS 300

static int descriptors_open(void)
{
	DIR *listing = opendir("/proc/self/fd");
	int count = 0;
	assert_non_null(listing);
	while (readdir(listing))
		count++;
	closedir(listing);
	return count;
}

static void check_nothing_is_left(int descriptors)
{
	assert_int_equal(waitpid(-1, NULL, WNOHANG), -1);
	assert_int_equal(errno, ECHILD);
	assert_int_equal(descriptors_open(), descriptors);
}

/* A decoding by the stand-in. */
struct attempt {
	int patience_ms;       /* 0: as long as users wait */
	int asked, stop_after; /* stop_after: calls of goes_on(); 0: never */
	size_t bytes;
	struct gz_series_list *list; /* NULL: none is taken */
	struct captured_log log;
};

static bool attempt_goes_on(void *user, double share)
{
	struct attempt *attempt = user;
	assert_true(share >= 0 && share <= 1);
	attempt->asked++;
	return attempt->stop_after == 0 || attempt->asked < attempt->stop_after;
}

static enum gz_result attempt_accept(void *user, const struct gz_decode_header *header,
				     struct gz_decode_place *out_place)
{
	struct attempt *attempt = user;
	(void)header;
	attempt->bytes = 64;
	*out_place = (struct gz_decode_place) { .bytes = attempt->bytes };
	return GZ_OK;
}

static enum gz_result decode(const char *deed, struct attempt *attempt,
			     struct gz_decoded *out_decoded)
{
	captured_log_init(&attempt->log, NULL);
	const struct gz_decode_listener listener = gz_series_list_listener(attempt->list);
	const struct gz_decode_job job = {
		.listener = attempt->list ? &listener : NULL,
		.format = "dicom",
		.path = "some/file",
		.choice = deed,
		.program = DECODER_STAND_IN,
		.patience_ms = attempt->patience_ms,
		.scratch_fd = -1,
		.user = attempt,
		.goes_on = attempt_goes_on,
		.accept = attempt_accept,
		.log = &attempt->log.log,
	};
	return gz_decode_run(&job, out_decoded);
}

static void check_attempt_refused(struct attempt attempt, const char *deed, enum gz_result result,
				  const char *words)
{
	struct gz_decoded decoded = { 0 };
	const int descriptors = descriptors_open();
	/* A decoder that floods may need longer than this on a busy machine. */
	attempt.patience_ms = result == GZ_ERR_TIMEOUT ? SHORT_PATIENCE_MS : 0;
	const enum gz_result got = decode(deed, &attempt, &decoded);
	if (got != result || !strstr(attempt.log.last, words))
		fail_msg("%s: result %d instead of %d, \"%s\" lacks \"%s\"", deed, got, result,
			 attempt.log.last, words);
	assert_null(decoded.voxels);
	assert_non_null(strstr(attempt.log.last, "some/file"));
	check_nothing_is_left(descriptors);
}

static void check_decode_refused(const char *deed, enum gz_result result, const char *words)
{
	check_attempt_refused((struct attempt) { 0 }, deed, result, words);
}

/* Number of series that it sent. */
static size_t check_list_refused(const char *deed, enum gz_result result, const char *words)
{
	struct attempt attempt = { 0 };
	assert_int_equal(gz_series_list_create(NULL, &attempt.list), GZ_OK);
	check_attempt_refused(attempt, deed, result, words);
	const size_t count = gz_series_list_count(attempt.list);
	gz_series_list_free(&attempt.list);
	return count;
}

static void good_decoder_gives_its_voxels(void **state)
{
	(void)state;
	const char *const deeds[] = { "good", "good but stay", "many lines" };
	for (size_t i = 0; i < sizeof deeds / sizeof deeds[0]; i++) {
		struct attempt attempt = { 0 };
		struct gz_decoded decoded = { 0 };
		const int descriptors = descriptors_open();
		if (decode(deeds[i], &attempt, &decoded) != GZ_OK)
			fail_msg("%s: %s", deeds[i], attempt.log.last);
		assert_int_equal(decoded.mapped, attempt.bytes);
		assert_int_equal(decoded.header.dims[0], 3);
		for (int k = 0; k < 12; k++)
			assert_int_equal(((const uint8_t *)decoded.voxels)[k], 10 + k);
		assert_int_equal(munmap(decoded.voxels, decoded.mapped), 0);
		check_nothing_is_left(descriptors);
	}
}

static void end_may_change_the_scale(void **state)
{
	(void)state;
	struct attempt attempt = { 0 };
	struct gz_decoded decoded = { 0 };
	assert_int_equal(decode("end rescaled", &attempt, &decoded), GZ_OK);
	assert_true(decoded.header.slope == 8 && decoded.header.intercept == -1);
	munmap(decoded.voxels, decoded.mapped);
}

static void lines_beyond_the_limit_are_counted(void **state)
{
	(void)state;
	struct attempt attempt = { 0 };
	struct gz_decoded decoded = { 0 };
	assert_int_equal(decode("many lines", &attempt, &decoded), GZ_OK);
	assert_int_equal(attempt.log.messages, GZ_DECODE_LINES_MAX + 1);
	assert_non_null(strstr(attempt.log.last, "36 further lines"));
	munmap(decoded.voxels, decoded.mapped);
}

static void decoder_that_fails_is_a_refusal(void **state)
{
	(void)state;
	check_decode_refused("crash", GZ_ERR_PROTOCOL, "crashed (Segmentation fault)");
	check_decode_refused("crash with voxels", GZ_ERR_PROTOCOL, "crashed");
	check_decode_refused("exit", GZ_ERR_PROTOCOL, "ended without a result (status 5)");
	check_decode_refused("half a message", GZ_ERR_PROTOCOL, "ended without a result");
	check_decode_refused("quiet failure", GZ_ERR_UNSUPPORTED, "not supported");
	check_decode_refused("unknown result", GZ_ERR_PROTOCOL, "unknown result");
	check_decode_refused("end without voxels", GZ_ERR_PROTOCOL, "without voxels");
}

static void decoder_that_stalls_is_ended(void **state)
{
	(void)state;
	check_decode_refused("hang", GZ_ERR_TIMEOUT, "no progress for 0.3 s");
	check_decode_refused("repeat step", GZ_ERR_TIMEOUT, "no progress for 0.3 s");
}

static void decoder_that_floods_is_ended(void **state)
{
	(void)state;
	check_decode_refused("flood lines", GZ_ERR_PROTOCOL, "further lines");
	check_decode_refused("flood steps", GZ_ERR_PROTOCOL, "floods");
}

static void messages_that_are_none_are_refused(void **state)
{
	(void)state;
	check_decode_refused("unknown kind", GZ_ERR_PROTOCOL, "not a message");
	check_decode_refused("step nan", GZ_ERR_PROTOCOL, "step outside");
	check_decode_refused("endless line", GZ_ERR_PROTOCOL, "malformed line");
	check_decode_refused("two headers", GZ_ERR_PROTOCOL, "malformed header");
	check_decode_refused("end larger", GZ_ERR_PROTOCOL, "another header");
	check_decode_refused("end flat", GZ_ERR_PROTOCOL, "another header");
}

static void memory_that_someone_can_still_write_is_refused(void **state)
{
	(void)state;
	struct attempt attempt = { 0 };
	struct gz_decoded decoded = { 0 };
	assert_int_equal(decode("leave writer", &attempt, &decoded), GZ_ERR_PROTOCOL);
	assert_non_null(strstr(attempt.log.last, "another process"));
}

static void lines_are_cleaned(void **state)
{
	(void)state;
	struct attempt attempt = { 0 };
	struct gz_decoded decoded = { 0 };
	assert_int_equal(decode("dirty line", &attempt, &decoded), GZ_ERR_FORMAT);
	assert_string_equal(attempt.log.last,
			    "bell ? escape ?[31m next ? c1 ?? half ?? good \xc3\xa9");
}

static void list_of_series_is_taken_with_its_pictures(void **state)
{
	(void)state;
	struct attempt attempt = { 0 };
	struct gz_decoded decoded = { 0 };
	struct gz_series_row row = { 0 }, other = { 0 };
	const int descriptors = descriptors_open();
	assert_int_equal(gz_series_list_create(NULL, &attempt.list), GZ_OK);
	assert_int_equal(decode("list", &attempt, &decoded), GZ_ERR_CHOICE);
	assert_int_equal(attempt.log.messages, 0);
	assert_null(decoded.voxels);
	assert_int_equal(gz_series_list_count(attempt.list), 2);
	assert_true(gz_series_list_update(attempt.list, 0, &row));
	assert_false(gz_series_list_update(attempt.list, 0, &row));
	assert_string_equal(row.series.patient, "M\xc3\xbcller");
	assert_int_equal(row.series.slices, 240);
	assert_string_equal(row.series.reason, "");
	assert_true(row.has_picture);
	assert_int_equal(row.picture[0], 10);
	assert_int_equal(row.picture[sizeof row.picture - 1], 9 + GZ_DECODE_PICTURE_BANDS);
	assert_true(gz_series_list_update(attempt.list, 1, &other));
	assert_string_equal(other.series.reason, "not ?[31m today");
	assert_false(other.has_picture);
	assert_false(gz_series_list_update(attempt.list, 2, &other));
	gz_series_list_free(&attempt.list);
	check_nothing_is_left(descriptors);
}

static void texts_of_a_list_are_cleaned(void **state)
{
	(void)state;
	struct attempt attempt = { 0 };
	struct gz_decoded decoded = { 0 };
	struct gz_series_row row = { 0 };
	assert_int_equal(gz_series_list_create(NULL, &attempt.list), GZ_OK);
	assert_int_equal(decode("dirty series", &attempt, &decoded), GZ_ERR_CHOICE);
	assert_true(gz_series_list_update(attempt.list, 0, &row));
	assert_string_equal(row.series.patient, "a?b ?? half ?");
	gz_series_list_free(&attempt.list);
}

static void list_that_nobody_asked_for_is_refused(void **state)
{
	(void)state;
	check_decode_refused("list", GZ_ERR_PROTOCOL, "malformed series");
	check_decode_refused("empty list", GZ_ERR_PROTOCOL, "empty list");
	check_decode_refused("picture before all", GZ_ERR_PROTOCOL, "malformed picture");
}

static void decoder_that_fails_within_a_list_leaves_what_it_sent(void **state)
{
	(void)state;
	assert_int_equal(check_list_refused("crash in list", GZ_ERR_PROTOCOL, "crashed"), 1);
	assert_int_equal(check_list_refused("stall in list", GZ_ERR_TIMEOUT, "no progress"), 1);
}

static void decoder_that_floods_a_list_is_ended(void **state)
{
	(void)state;
	assert_int_equal(check_list_refused("flood series", GZ_ERR_PROTOCOL, "malformed series"),
			 GZ_DECODE_SERIES_MAX);
	(void)check_list_refused("flood pictures", GZ_ERR_PROTOCOL, "malformed picture");
	(void)check_list_refused("flood refusals", GZ_ERR_PROTOCOL, "malformed refusal");
}

static void messages_of_a_list_that_are_none_are_refused(void **state)
{
	(void)state;
	static const struct {
		const char *deed, *words;
	} faults[] = {
		{ "empty list", "empty list" },
		{ "endless series", "malformed series" },
		{ "negative series", "malformed series" },
		{ "picture of none", "malformed picture" },
		{ "picture before all", "malformed picture" },
		{ "band of none", "malformed picture" },
		{ "endless refusal", "malformed refusal" },
		{ "series with voxels", "malformed series" },
		{ "voxels with series", "malformed header" },
	};
	for (size_t i = 0; i < sizeof faults / sizeof faults[0]; i++)
		(void)check_list_refused(faults[i].deed, GZ_ERR_PROTOCOL, faults[i].words);
}

static void cancelled_list_is_ended(void **state)
{
	(void)state;
	struct attempt attempt = { .stop_after = 2 };
	struct gz_decoded decoded = { 0 };
	const int descriptors = descriptors_open();
	assert_int_equal(gz_series_list_create(NULL, &attempt.list), GZ_OK);
	assert_int_equal(decode("stall in list", &attempt, &decoded), GZ_ERR_CANCELLED);
	assert_int_equal(attempt.log.messages, 0);
	gz_series_list_free(&attempt.list);
	check_nothing_is_left(descriptors);
}

static void cancelled_decoder_is_killed(void **state)
{
	(void)state;
	struct attempt attempt = { .stop_after = 2 };
	struct gz_decoded decoded = { 0 };
	const int descriptors = descriptors_open();
	assert_int_equal(decode("hang", &attempt, &decoded), GZ_ERR_CANCELLED);
	assert_int_equal(attempt.log.messages, 0);
	check_nothing_is_left(descriptors);
}

static void missing_decoder_is_told(void **state)
{
	(void)state;
	struct captured_log log;
	struct gz_volume volume = { 0 };
	captured_log_init(&log, NULL);
	setenv("GAZECAST_DECODER", "/nowhere/gazedecode", 1);
	const int descriptors = descriptors_open();
	const char *path = files_write("any.dcm", "x", 1);
	assert_int_equal(gz_volume_load(path, NULL, NULL, &log.log, &volume), GZ_ERR_ACCESS);
	assert_non_null(strstr(log.last, "cannot start /nowhere/gazedecode: No such file"));
	unsetenv("GAZECAST_DECODER");
	check_nothing_is_left(descriptors);
}

/* Through the loader: the name of the file tells the stand-in what to do. */
static enum gz_result load_by_stand_in(const char *name, const struct gz_loading *loading,
				       struct captured_log *log, struct gz_volume *out_volume)
{
	const char *path = files_write(name, "x", 1);
	setenv("GAZECAST_DECODER", DECODER_STAND_IN, 1);
	captured_log_init(log, NULL);
	const enum gz_result result = gz_volume_load(path, NULL, loading, &log->log, out_volume);
	unsetenv("GAZECAST_DECODER");
	unlink(path);
	return result;
}

static void headers_that_cannot_be_are_refused(void **state)
{
	(void)state;
	const char *const names[] = { "dims.dcm",
				      "type.dcm",
				      "spacing.dcm",
				      "slope.dcm",
				      "huge.dcm",
				      "oriented.dcm",
				      "modality.dcm",
				      "not_finite.dcm",
				      "colour.dcm",
				      "wide_colour.dcm",
				      "light_colours.dcm",
				      "series_too_long.dcm",
				      "series_beside_its_voxels.dcm",
				      "series_beyond_its_type.dcm",
				      "series_without_range.dcm" };
	const int descriptors = descriptors_open();
	for (size_t i = 0; i < sizeof names / sizeof names[0]; i++) {
		struct captured_log log;
		struct gz_volume volume = { 0 };
		const enum gz_result expected =
			strcmp(names[i], "huge.dcm") == 0 ? GZ_ERR_NO_MEM : GZ_ERR_FORMAT;
		const enum gz_result got = load_by_stand_in(names[i], NULL, &log, &volume);
		if (got != expected || log.messages != 1 || !strstr(log.last, names[i]))
			fail_msg("%s: result %d, %d lines: %s", names[i], got, log.messages,
				 log.last);
		assert_null(volume.voxels);
	}
	check_nothing_is_left(descriptors);
}

static void series_has_the_range_that_the_decoder_found(void **state)
{
	(void)state;
	const struct gz_loading last = { .time_point = 2 }, beyond = { .time_point = 3 };
	struct captured_log log;
	struct gz_volume volume = { 0 };
	if (load_by_stand_in("series.dcm", &last, &log, &volume) != GZ_OK)
		fail_msg("%s", log.last);
	assert_int_equal(volume.time_points, 3);
	assert_int_equal(volume.time_point, 2);
	assert_true(volume.stored_min == 5 && volume.stored_max == 200);
	assert_true(volume.number_range[0] == 5 && volume.number_range[1] == 200);
	gz_volume_free(&volume);
	assert_int_equal(load_by_stand_in("series.dcm", &beyond, &log, &volume), GZ_ERR_FORMAT);
	assert_int_equal(load_by_stand_in("good.dcm", &last, &log, &volume), GZ_ERR_FORMAT);
}

static void voxels_go_into_the_scratch_folder(void **state)
{
	(void)state;
	const struct gz_loading kinds[] = {
		{ .scratch = NULL },
		{ .scratch = files_folder() },
		{ .scratch = files_folder(), .scratch_from = 1000 },
		{ .scratch = "/nowhere", .scratch_from = 1000 },
	};
	struct captured_log log;
	const int descriptors = descriptors_open();
	for (size_t i = 0; i < sizeof kinds / sizeof kinds[0]; i++) {
		struct gz_volume volume = { 0 };
		if (load_by_stand_in("good.dcm", &kinds[i], &log, &volume) != GZ_OK)
			fail_msg("%zu: %s", i, log.last);
		assert_int_equal(volume.mapped, 12 + GZ_VOLUME_PADDING);
		assert_int_equal(((const uint8_t *)volume.voxels)[11], 21);
		assert_true(volume.stored_min == 10 && volume.stored_max == 21);
		assert_true(volume.slope == 2 && volume.intercept == -1);
		for (int k = 0; k < GZ_VOLUME_PADDING; k++)
			assert_int_equal(((const uint8_t *)volume.voxels)[12 + k], 0);
		gz_volume_free(&volume);
	}
	const struct gz_loading none = { .scratch = "/nowhere" };
	struct gz_volume volume = { 0 };
	assert_int_equal(load_by_stand_in("good.dcm", &none, &log, &volume), GZ_ERR_NOT_FOUND);
	assert_non_null(strstr(log.last, "make room there"));
	check_nothing_is_left(descriptors);
}

static void colours_follow_the_voxels(void **state)
{
	(void)state;
	struct captured_log log;
	struct gz_volume volume = { 0 };
	const struct gz_loading kinds[] = { { .scratch = NULL }, { .scratch = files_folder() } };
	for (size_t i = 0; i < 2; i++) {
		if (load_by_stand_in("good_colours.dcm", &kinds[i], &log, &volume) != GZ_OK)
			fail_msg("%zu: %s", i, log.last);
		assert_int_equal(volume.colour, GZ_COLOUR_LUMINANCE);
		assert_int_equal(volume.mapped, 128 + 48 + GZ_VOLUME_PADDING);
		for (uint32_t k = 0; k < 12; k++)
			assert_int_equal(volume.colours[k], k | 0xFF000000);
		gz_volume_free(&volume);
	}
}

static void confined_process_cannot_do_more(void **state)
{
	(void)state;
	char command[4096], folder[1024];
	snprintf(folder, sizeof folder, "%s/given", files_folder());
	assert_int_equal(mkdir(folder, 0700), 0);
	const char *other = files_write("other", "secret", 6);
	const char *file = files_write("given/file", "given", 5);
	snprintf(command, sizeof command, "%s %s %s %s && %s %s %s %s", CONFINED_ATTEMPTS, folder,
		 file, other, CONFINED_ATTEMPTS, file, file, other);
	assert_int_equal(system(command), 0);
	/* A link in the folder stands for the file that it points to. */
	snprintf(command, sizeof command, "ln -s ../other %s/link && %s %s %s/link /etc/passwd",
		 folder, CONFINED_ATTEMPTS, folder, folder);
	assert_int_equal(system(command), 0);
	snprintf(command, sizeof command, "rm -r %s", folder);
	assert_int_equal(system(command), 0);
}

TEST_SUITE(decode)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(good_decoder_gives_its_voxels),
		cmocka_unit_test(end_may_change_the_scale),
		cmocka_unit_test(lines_beyond_the_limit_are_counted),
		cmocka_unit_test(decoder_that_fails_is_a_refusal),
		cmocka_unit_test(decoder_that_stalls_is_ended),
		cmocka_unit_test(decoder_that_floods_is_ended),
		cmocka_unit_test(messages_that_are_none_are_refused),
		cmocka_unit_test(memory_that_someone_can_still_write_is_refused),
		cmocka_unit_test(lines_are_cleaned),
		cmocka_unit_test(list_of_series_is_taken_with_its_pictures),
		cmocka_unit_test(texts_of_a_list_are_cleaned),
		cmocka_unit_test(list_that_nobody_asked_for_is_refused),
		cmocka_unit_test(decoder_that_fails_within_a_list_leaves_what_it_sent),
		cmocka_unit_test(decoder_that_floods_a_list_is_ended),
		cmocka_unit_test(messages_of_a_list_that_are_none_are_refused),
		cmocka_unit_test(cancelled_list_is_ended),
		cmocka_unit_test(cancelled_decoder_is_killed),
		cmocka_unit_test(missing_decoder_is_told),
		cmocka_unit_test(headers_that_cannot_be_are_refused),
		cmocka_unit_test(series_has_the_range_that_the_decoder_found),
		cmocka_unit_test(voxels_go_into_the_scratch_folder),
		cmocka_unit_test(colours_follow_the_voxels),
		cmocka_unit_test(confined_process_cannot_do_more),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
