/* The progress bar of loading, and cancelling by a signal. */
#include "suite.h"

#include <signal.h>
#include <string.h>
#include <unistd.h>

#include "base/captured_log.h"
#include "render/data/volume.h"
#include "view/headless/headless.h"

static volatile sig_atomic_t handed_on;

static void on_signal(int number)
{
	handed_on = number;
}

static void text_has_name_share_and_time_left(void **state)
{
	(void)state;
	char text[128];
	gz_loading_bar_text("head.nii.gz", 0.25, 2, text, sizeof text);
	assert_string_equal(text, "head.nii.gz [######                  ]  25 % 6 s left");
	gz_loading_bar_text("head.nii.gz", 0, 2, text, sizeof text);
	assert_string_equal(text, "head.nii.gz [                        ]   0 % ");
	gz_loading_bar_text("head.nii.gz", 1, 2, text, sizeof text);
	assert_string_equal(text, "head.nii.gz [########################] 100 % 0 s left");
}

static void long_name_is_cut_at_its_beginning(void **state)
{
	(void)state;
	char text[128];
	gz_loading_bar_text("/a/very/long/path/to/where/volumes/are/kept/big.nrrd", 0.02, 2000,
			    text, sizeof text);
	assert_non_null(strstr(text, "volumes/are/kept/big.nrrd ["));
	assert_true(strlen(text) <= 78);
}

static void quick_loading_prints_nothing(void **state)
{
	(void)state;
	struct captured_log log;
	struct gz_loading_bar bar;
	captured_log_init(&log, NULL);
	gz_loading_bar_begin(&bar, &log.log);
	assert_true(gz_loading_goes_on(&bar.loading, 0.5, "a"));
	gz_loading_bar_end(&bar);
	assert_int_equal(log.messages, 0);
	assert_false(bar.drawn);
}

static void slow_loading_without_terminal_logs_one_line(void **state)
{
	(void)state;
	struct captured_log log;
	struct gz_loading_bar bar;
	captured_log_init(&log, "*:info");
	gz_loading_bar_begin(&bar, &log.log);
	bar.terminal = false;
	bar.next_ns = 0; /* as if a second had passed */
	assert_true(gz_loading_goes_on(&bar.loading, 0.5, "a.nrrd"));
	assert_true(gz_loading_goes_on(&bar.loading, 0.6, "a.nrrd"));
	gz_loading_bar_end(&bar);
	assert_int_equal(log.messages, 1);
	assert_non_null(strstr(log.last, "a.nrrd"));
	assert_non_null(strstr(log.last, "50 %"));
}

static void signal_cancels_loading_and_is_raised_again(void **state)
{
	(void)state;
	static const int dims[3] = { 16, 16, 16 };
	struct gz_loading_bar bar;
	struct gz_volume volume = { 0 };
	struct sigaction action = { .sa_handler = on_signal }, before;
	sigaction(SIGINT, &action, &before);
	gz_loading_bar_begin(&bar, NULL);
	raise(SIGINT);
	assert_int_equal(handed_on, 0);
	assert_int_equal(
		gz_volume_generate(&(struct gz_procedural_request) { GZ_PROCEDURAL_SHELLS, dims,
								     (double[3]) { 1, 1, 1 },
								     GZ_VOXEL_U8 },
				   &bar.loading, NULL, &volume),
		GZ_ERR_CANCELLED);
	assert_null(volume.voxels);
	gz_loading_bar_end(&bar);
	assert_int_equal(handed_on, SIGINT);
	sigaction(SIGINT, &before, NULL);
}

TEST_SUITE(loading_bar)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(text_has_name_share_and_time_left),
		cmocka_unit_test(long_name_is_cut_at_its_beginning),
		cmocka_unit_test(quick_loading_prints_nothing),
		cmocka_unit_test(slow_loading_without_terminal_logs_one_line),
		cmocka_unit_test(signal_cancels_loading_and_is_raised_again),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
