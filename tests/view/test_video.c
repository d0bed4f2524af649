/* Videos: when a picture stands in them, at what size, and what becomes of an ffmpeg that is
 * missing, slow or dies. Stand-ins of ffmpeg are scripts. */
#include "suite.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/captured_log.h"
#include "base/clock.h"
#include "view/capture/output.h"
#include "view/capture/video.h"

static const double rates[] = { 1, 12.5, 23.976, 24, 25, 29.97, 30, 50, 59.94, 60, 72, 90, 120 };

static void clock_at_the_videos_rate_counts_one_picture_a_frame(void **state)
{
	(void)state;
	for (size_t i = 0; i < sizeof rates / sizeof rates[0]; i++) {
		struct gz_video_clock clock;
		gz_video_clock_start(&clock, rates[i], 0);
		for (int k = 1; k < 20000; k++) {
			int64_t time_ns = (int64_t)floor(k * (double)GZ_NS_PER_S / rates[i]);
			uint64_t due = gz_video_clock_pass(&clock, time_ns);
			if (due != 1)
				fail_msg("%g a second: picture %d is shown %d times", rates[i], k,
					 (int)due);
		}
	}
}

static void clock_repeats_slow_pictures_and_skips_fast_ones(void **state)
{
	(void)state;
	struct gz_video_clock clock;
	gz_video_clock_start(&clock, 10, 5 * GZ_NS_PER_S);
	assert_int_equal(gz_video_clock_pass(&clock, 5 * GZ_NS_PER_S), 0);
	assert_int_equal(gz_video_clock_pass(&clock, 5 * GZ_NS_PER_S + 1), 1);
	assert_int_equal(gz_video_clock_pass(&clock, 5 * GZ_NS_PER_S + 50 * GZ_NS_PER_MS), 0);
	assert_int_equal(gz_video_clock_pass(&clock, 7 * GZ_NS_PER_S), 19);
	assert_int_equal(gz_video_clock_pass(&clock, 6 * GZ_NS_PER_S), 0);
	assert_int_equal(gz_video_clock_pass(&clock, INT64_MIN), 0);
}

static struct gz_image make_image(int width, int height, uint8_t value)
{
	struct gz_image image = { 0 };
	assert_int_equal(gz_image_resize(&image, width, height), GZ_OK);
	for (int i = 0; i < width * height * 4; i++)
		image.pixels[i] = i % 4 == 3 ? 255 : value;
	return image;
}

static int at(const struct gz_image *image, int x, int y)
{
	return image->pixels[4 * (y * image->width + x)];
}

static void picture_of_the_same_size_is_copied(void **state)
{
	(void)state;
	struct gz_image_fit fit = { 0 };
	struct gz_image source = make_image(7, 5, 10), target = make_image(7, 5, 99);
	source.pixels[4 * 17] = 200;
	assert_int_equal(gz_image_fit(&fit, &source, &target), GZ_OK);
	assert_memory_equal(target.pixels, source.pixels, 7 * 5 * 4);
	gz_image_free(&source);
	gz_image_free(&target);
	gz_image_fit_free(&fit);
}

static void picture_of_another_shape_is_centred_on_black(void **state)
{
	(void)state;
	struct gz_image_fit fit = { 0 };
	struct gz_image source = make_image(20, 10, 80), target = make_image(40, 40, 99);
	assert_int_equal(gz_image_fit(&fit, &source, &target), GZ_OK);
	for (int y = 0; y < 40; y++)
		for (int x = 0; x < 40; x++)
			assert_int_equal(at(&target, x, y), y >= 10 && y < 30 ? 80 : 0);
	gz_image_free(&source);
	gz_image_free(&target);
	gz_image_fit_free(&fit);
}

static void scaled_picture_is_at_least_one_pixel_wide(void **state)
{
	(void)state;
	struct gz_image_fit fit = { 0 };
	struct gz_image source = make_image(4000, 1, 80), target = make_image(16, 16, 99);
	assert_int_equal(gz_image_fit(&fit, &source, &target), GZ_OK);
	assert_int_equal(at(&target, 0, 7), 80);
	assert_int_equal(at(&target, 0, 8), 0);
	gz_image_free(&source);
	gz_image_free(&target);
	gz_image_fit_free(&fit);
}

static void names_by_time_are_unused_and_sort_in_order(void **state)
{
	(void)state;
	char folder[] = "/tmp/gazecast-test-name-XXXXXX", paths[3][GZ_PATH_SIZE];
	assert_non_null(mkdtemp(folder));
	for (int i = 0; i < 3; i++) {
		assert_int_equal(gz_capture_name(folder, ".png", paths[i]), GZ_OK);
		assert_non_null(strstr(paths[i], "/gazeview-2"));
		assert_non_null(strstr(paths[i], ".png"));
		FILE *file = fopen(paths[i], "wx");
		assert_non_null(file);
		fclose(file);
		assert_true(i == 0 || strcmp(paths[i - 1], paths[i]) < 0);
	}
	for (int i = 0; i < 3; i++)
		unlink(paths[i]);
	rmdir(folder);
	char deep[GZ_PATH_SIZE];
	memset(deep, 'x', sizeof deep);
	deep[sizeof deep - 1] = '\0';
	assert_int_equal(gz_capture_name(deep, ".png", paths[0]), GZ_ERR_FULL);
}

/* A folder with a script as the only ffmpeg on the PATH. */
struct stand_in {
	char folder[64];
	char script[96], output[96];
	char path[4096]; /* as it was */
	struct captured_log log;
};

static int set_up(void **state)
{
	struct stand_in *self = calloc(1, sizeof *self);
	assert_non_null(self);
	strcpy(self->folder, "/tmp/gazecast-test-video-XXXXXX");
	assert_non_null(mkdtemp(self->folder));
	snprintf(self->script, sizeof self->script, "%s/ffmpeg", self->folder);
	snprintf(self->output, sizeof self->output, "%s/out.raw", self->folder);
	snprintf(self->path, sizeof self->path, "%s", getenv("PATH"));
	setenv("PATH", self->folder, 1);
	captured_log_init(&self->log, NULL);
	*state = self;
	return 0;
}

static int tear_down(void **state)
{
	struct stand_in *self = *state;
	setenv("PATH", self->path, 1);
	unlink(self->script);
	unlink(self->output);
	rmdir(self->folder);
	free(self);
	return 0;
}

/* Write the script; $out is the path of the video, ffmpeg's last argument. */
static void write_script(const struct stand_in *self, const char *body)
{
	FILE *file = fopen(self->script, "w");
	assert_non_null(file);
	fprintf(file, "#!/bin/sh\nPATH='%s'\nfor word; do out=${word#file:}; done\n%s\n",
		self->path, body);
	fclose(file);
	assert_int_equal(chmod(self->script, 0700), 0);
}

static struct gz_video_params params_of(const struct stand_in *self, bool wait)
{
	return (struct gz_video_params) {
		.path = self->output,
		.width = 4,
		.height = 2,
		.fps = 10,
		.wait = wait,
	};
}

static void show(struct gz_video *video, uint8_t value, int64_t time_ms)
{
	struct gz_image image = make_image(4, 2, value);
	assert_int_equal(gz_video_show(video, &image, time_ms * GZ_NS_PER_MS), GZ_OK);
	gz_image_free(&image);
}

/* The values of the pictures in the file, as digits. */
static void read_values(const struct stand_in *self, char *text)
{
	uint8_t picture[4 * 2 * 4];
	FILE *file = fopen(self->output, "rb");
	assert_non_null(file);
	while (fread(picture, sizeof picture, 1, file) == 1)
		*text++ = (char)('0' + picture[0]);
	*text = '\0';
	fclose(file);
}

static void video_shows_each_picture_for_its_time(void **state)
{
	struct stand_in *self = *state;
	char values[64];
	struct gz_video *video;
	write_script(self, "exec cat >\"$out\"");
	const struct gz_video_params params = params_of(self, true);
	assert_int_equal(gz_video_open(&params, &self->log.log, &video), GZ_OK);
	show(video, 1, 1000);
	show(video, 2, 1010); /* the time of the first picture is 1000: it shows 1 */
	show(video, 3, 1020);
	show(video, 4, 1500);
	assert_int_equal(gz_video_pass(video, 1650 * GZ_NS_PER_MS), GZ_OK);
	gz_video_finish(video, 1800 * GZ_NS_PER_MS);
	assert_int_equal(gz_video_close(&video), GZ_OK);
	assert_null(video);
	read_values(self, values);
	assert_string_equal(values, "13333444");
	assert_int_equal(self->log.messages, 0);
}

static void video_closed_at_once_has_one_picture(void **state)
{
	struct stand_in *self = *state;
	char values[64];
	struct gz_video *video;
	write_script(self, "exec cat >\"$out\"");
	const struct gz_video_params params = params_of(self, false);
	assert_int_equal(gz_video_open(&params, &self->log.log, &video), GZ_OK);
	show(video, 7, 1000);
	assert_int_equal(gz_video_close(&video), GZ_OK);
	read_values(self, values);
	assert_string_equal(values, "7");
}

static void slow_ffmpeg_drops_and_counts_pictures_without_blocking(void **state)
{
	enum { SHOWN = 1000 };
	struct stand_in *self = *state;
	struct gz_video *video;
	char go[128], body[512];
	snprintf(go, sizeof go, "%s/go", self->folder);
	snprintf(body, sizeof body, "while [ ! -e '%s' ]; do sleep 0.01; done; exec cat >\"$out\"",
		 go);
	write_script(self, body);
	struct gz_video_params params = params_of(self, false);
	params.width = 512; /* the queue and a full pipe hold fewer pictures than were shown */
	assert_int_equal(gz_video_open(&params, &self->log.log, &video), GZ_OK);
	for (int k = 0; k < SHOWN; k++)
		show(video, (uint8_t)(k % 7), 100 * k);
	struct gz_video_status status = gz_video_status(video);
	FILE *file = fopen(go, "w");
	assert_non_null(file);
	fclose(file);
	gz_video_finish(video, 100 * SHOWN * GZ_NS_PER_MS);
	assert_true(status.dropped > SHOWN / 2);
	assert_false(status.failed);
	assert_int_equal(gz_video_close(&video), GZ_OK);
	struct stat info;
	assert_int_equal(stat(self->output, &info), 0);
	assert_int_equal(info.st_size, (off_t)SHOWN * 512 * 2 * 4);
	unlink(go);
}

static void missing_ffmpeg_is_reported_with_the_remedy(void **state)
{
	struct stand_in *self = *state;
	struct gz_video *video = NULL;
	const struct gz_video_params params = params_of(self, true);
	assert_int_equal(gz_video_open(&params, &self->log.log, &video), GZ_ERR_NOT_FOUND);
	assert_null(video);
	assert_int_equal(self->log.messages, 1);
	assert_non_null(strstr(self->log.last, "install the package ffmpeg"));
}

/* Show pictures until the video fails. SIGPIPE, if it got through, would end the program. */
static enum gz_result show_until_it_fails(struct gz_video *video)
{
	struct gz_image image = make_image(4, 2, 1);
	enum gz_result r = GZ_OK;
	for (int k = 0; k < 100000 && r == GZ_OK; k++)
		r = gz_video_show(video, &image, k * GZ_NS_PER_S);
	gz_image_free(&image);
	return r;
}

static void failing_ffmpeg_is_reported_with_its_messages(void **state)
{
	struct stand_in *self = *state;
	struct gz_video *video;
	write_script(self, "echo before >&2; echo first >&2; echo 'No \033[31mspace left' >&2; "
			   "echo >&2; exit 1");
	const struct gz_video_params params = params_of(self, true);
	assert_int_equal(gz_video_open(&params, &self->log.log, &video), GZ_OK);
	assert_int_equal(show_until_it_fails(video), GZ_ERR_IO);
	assert_true(gz_video_status(video).failed);
	assert_int_equal(gz_video_close(&video), GZ_ERR_IO);
	assert_int_equal(self->log.messages, 1);
	assert_non_null(strstr(self->log.last, "ffmpeg: \"first; No  [31mspace left\";"));
}

/* As ffmpeg 5.1: if the disk fills up, only -xerror gives it a status that tells. */
static void full_disk_is_reported(void **state)
{
	struct stand_in *self = *state;
	struct gz_video *video;
	write_script(self, "cat >/dev/null; echo 'Error writing trailer: No space left on device' "
			   ">&2; case \"$*\" in *' -xerror '*) exit 1 ;; esac");
	const struct gz_video_params params = params_of(self, true);
	assert_int_equal(gz_video_open(&params, &self->log.log, &video), GZ_OK);
	assert_int_equal(gz_video_close(&video), GZ_ERR_IO);
	assert_non_null(strstr(self->log.last, "the video is incomplete"));
	assert_non_null(strstr(self->log.last, "No space left on device"));
}

static void killed_ffmpeg_is_reported_with_its_signal(void **state)
{
	struct stand_in *self = *state;
	struct gz_video *video;
	write_script(self, "kill -KILL $$");
	const struct gz_video_params params = params_of(self, false);
	assert_int_equal(gz_video_open(&params, &self->log.log, &video), GZ_OK);
	assert_int_equal(gz_video_close(&video), GZ_ERR_IO);
	assert_non_null(strstr(self->log.last, "ended by signal 9"));
}

TEST_SUITE(video)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(clock_at_the_videos_rate_counts_one_picture_a_frame),
		cmocka_unit_test(clock_repeats_slow_pictures_and_skips_fast_ones),
		cmocka_unit_test(names_by_time_are_unused_and_sort_in_order),
		cmocka_unit_test(picture_of_the_same_size_is_copied),
		cmocka_unit_test(picture_of_another_shape_is_centred_on_black),
		cmocka_unit_test(scaled_picture_is_at_least_one_pixel_wide),
		cmocka_unit_test_setup_teardown(video_shows_each_picture_for_its_time, set_up,
						tear_down),
		cmocka_unit_test_setup_teardown(video_closed_at_once_has_one_picture, set_up,
						tear_down),
		cmocka_unit_test_setup_teardown(
			slow_ffmpeg_drops_and_counts_pictures_without_blocking, set_up, tear_down),
		cmocka_unit_test_setup_teardown(missing_ffmpeg_is_reported_with_the_remedy, set_up,
						tear_down),
		cmocka_unit_test_setup_teardown(failing_ffmpeg_is_reported_with_its_messages,
						set_up, tear_down),
		cmocka_unit_test_setup_teardown(full_disk_is_reported, set_up, tear_down),
		cmocka_unit_test_setup_teardown(killed_ffmpeg_is_reported_with_its_signal, set_up,
						tear_down),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
