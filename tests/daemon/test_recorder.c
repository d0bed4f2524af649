#include "suite.h"

#include <fcntl.h>
#include <poll.h>
#include <sched.h>
#include <signal.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/captured_log.h"
#include "base/clock.h"
#include "daemon/recorder.h"

static char path[64];

static int open_file(void)
{
	snprintf(path, sizeof path, "/tmp/gz_recorder_XXXXXX");
	int fd = mkstemp(path);
	assert_true(fd >= 0);
	return fd;
}

static void push_sample(struct gz_recorder *recorder, uint64_t seq)
{
	struct gz_gaze_log_record record = { .kind = GZ_GAZE_LOG_SAMPLE };
	record.sample = gz_sample_unmeasured();
	record.sample.seq = seq;
	record.sample.host_ns = (int64_t)seq * GZ_NS_PER_MS;
	gz_recorder_push(recorder, &record);
}

/* Wait for events of changes until the state is @p wanted. */
static void wait_state(struct gz_recorder *recorder, enum gz_recording_state wanted)
{
	struct gz_recorder_status status;
	for (int i = 0; i < 100; i++) {
		gz_recorder_get_status(recorder, &status);
		if (status.state == wanted)
			return;
		struct pollfd event = { .fd = gz_recorder_event_fd(recorder), .events = POLLIN };
		uint64_t count;
		if (poll(&event, 1, 5000) <= 0 || read(event.fd, &count, sizeof count) < 0)
			break;
	}
	fail_msg("state %s, waited for %s", gz_recording_state_name(status.state),
		 gz_recording_state_name(wanted));
}

/* A disk that is busy: while disk_busy is set, syncs of files do not return. */
static atomic_bool disk_busy;
static atomic_int syncs_waiting;

int __real_fdatasync(int fd);
int __wrap_fdatasync(int fd);

int __wrap_fdatasync(int fd)
{
	atomic_fetch_add(&syncs_waiting, 1);
	while (atomic_load(&disk_busy))
		sched_yield();
	atomic_fetch_sub(&syncs_waiting, 1);
	return __real_fdatasync(fd);
}

/* Wait until @p count samples are in the file. */
static void wait_samples(const struct gz_recorder *recorder, uint64_t count)
{
	struct gz_recorder_status status;
	const int64_t deadline_ns = gz_clock_now_ns() + PATIENCE_NS;
	do {
		gz_recorder_get_status(recorder, &status);
		if (status.samples >= count)
			return;
		sched_yield();
	} while (gz_clock_now_ns() < deadline_ns);
	fail_msg("%llu samples in the file, waited for %llu", (unsigned long long)status.samples,
		 (unsigned long long)count);
}

static const struct gz_gaze_log_header header = { .tracker = "test", .rate_hz = 1000 };

struct found {
	uint64_t samples, gaps, missing, marks;
	enum gz_gaze_log_ending ending;
};

static struct found read_back(void)
{
	struct gz_gaze_log_reader *reader = NULL;
	struct gz_gaze_log_record record;
	struct found found = { 0 };
	enum gz_result result;
	assert_int_equal(gz_gaze_log_open(path, NULL, &reader), GZ_OK);
	assert_string_equal(gz_gaze_log_header(reader)->tracker, "test");
	while ((result = gz_gaze_log_read(reader, &record)) == GZ_OK) {
		if (record.kind == GZ_GAZE_LOG_SAMPLE) {
			assert_int_equal(record.sample.seq, found.samples + found.missing);
			found.samples++;
		} else if (record.kind == GZ_GAZE_LOG_GAP) {
			found.gaps++;
			found.missing += record.missing;
		} else {
			found.marks++;
		}
	}
	assert_int_equal(result, GZ_ERR_END);
	found.ending = gz_gaze_log_ending(reader);
	gz_gaze_log_close(&reader);
	return found;
}

static void recorder_writes_a_whole_log_with_marks(void **state)
{
	(void)state;
	struct gz_recorder *recorder = NULL;
	struct gz_recorder_status status;
	struct gz_gaze_log_record mark = { .kind = GZ_GAZE_LOG_MARK, .text = "stimulus" };
	assert_int_equal(gz_recorder_create(NULL, &recorder), GZ_OK);
	push_sample(recorder, 99); /* before: nothing happens */
	for (int round = 0; round < 3; round++) {
		assert_int_equal(gz_recorder_start(recorder, open_file(), path, &header), GZ_OK);
		assert_int_equal(gz_recorder_start(recorder, 0, path, &header), GZ_ERR_BUSY);
		assert_true(gz_recorder_running(recorder));
		for (uint64_t i = 0; i < 5000; i++)
			push_sample(recorder, i);
		gz_recorder_push(recorder, &mark);
		gz_recorder_stop(recorder);
		push_sample(recorder, 5000); /* after the end */
		wait_state(recorder, GZ_RECORDING_OFF);
		gz_recorder_get_status(recorder, &status);
		assert_int_equal(status.samples, 5000);
		struct found found = read_back();
		assert_int_equal(found.ending, GZ_GAZE_LOG_WHOLE);
		assert_int_equal(found.samples, 5000);
		assert_int_equal(found.marks, 1);
		assert_int_equal(found.gaps, 0);
		unlink(path);
	}
	gz_recorder_destroy(&recorder);
	assert_null(recorder);
	gz_recorder_destroy(&recorder);
}

static void recorder_destroyed_while_it_records_ends_the_log(void **state)
{
	(void)state;
	struct gz_recorder *recorder = NULL;
	assert_int_equal(gz_recorder_create(NULL, &recorder), GZ_OK);
	assert_int_equal(gz_recorder_start(recorder, open_file(), path, &header), GZ_OK);
	for (uint64_t i = 0; i < 100; i++)
		push_sample(recorder, i);
	gz_recorder_destroy(&recorder);
	struct found found = read_back();
	assert_int_equal(found.ending, GZ_GAZE_LOG_WHOLE);
	assert_int_equal(found.samples, 100);
	unlink(path);
}

static void recorder_goes_on_writing_while_the_disk_is_busy(void **state)
{
	(void)state;
	struct gz_recorder *recorder = NULL;
	assert_int_equal(gz_recorder_create(NULL, &recorder), GZ_OK);
	atomic_store(&disk_busy, true);
	assert_int_equal(gz_recorder_start(recorder, open_file(), path, &header), GZ_OK);
	for (uint64_t i = 0; i < 100; i++)
		push_sample(recorder, i);
	wait_samples(recorder, 100);
	const int64_t deadline_ns = gz_clock_now_ns() + PATIENCE_NS;
	while (atomic_load(&syncs_waiting) == 0 && gz_clock_now_ns() < deadline_ns)
		sched_yield();
	assert_int_equal(atomic_load(&syncs_waiting), 1);
	for (uint64_t i = 100; i < 200; i++)
		push_sample(recorder, i);
	wait_samples(recorder, 200);
	assert_int_equal(atomic_load(&syncs_waiting), 1);
	struct found found = read_back(); /* as after a kill */
	assert_int_equal(found.ending, GZ_GAZE_LOG_CUT);
	assert_int_equal(found.samples, 200);
	atomic_store(&disk_busy, false);
	gz_recorder_stop(recorder);
	wait_state(recorder, GZ_RECORDING_OFF);
	found = read_back();
	assert_int_equal(found.ending, GZ_GAZE_LOG_WHOLE);
	assert_int_equal(found.samples, 200);
	gz_recorder_destroy(&recorder);
	unlink(path);
}

static void recorder_that_cannot_keep_up_says_what_is_missing(void **state)
{
	(void)state;
	struct gz_recorder *recorder = NULL;
	const uint64_t pushed = 5 * GZ_RECORDER_RING;
	assert_int_equal(gz_recorder_create(NULL, &recorder), GZ_OK);
	/* A reader that does not read: a FIFO accepts 64 KiB and then nothing until it is read. */
	int ends[2];
	assert_int_equal(pipe(ends), 0);
	assert_int_equal(gz_recorder_start(recorder, ends[1], "/tmp/pipe", &header), GZ_OK);
	for (uint64_t i = 0; i < pushed; i++)
		push_sample(recorder, i);
	/* Samples that the tracker itself lost meanwhile are missing too. */
	const uint64_t lost = 7;
	struct gz_gaze_log_record gap = { .kind = GZ_GAZE_LOG_GAP, .missing = lost };
	gz_recorder_push(recorder, &gap);
	/* Now the disk is fast again, and the rest is written. */
	int copy = open_file();
	char buffer[65536];
	ssize_t n;
	bool stopped = false;
	struct pollfd quiet = { .fd = ends[0], .events = POLLIN };
	for (;;) {
		/* Once the pipe has been empty for several drains, the ring is empty too. */
		if (!stopped && poll(&quiet, 1, 6 * GZ_RECORDER_DRAIN_MS) == 0) {
			push_sample(recorder, pushed + lost);
			gz_recorder_stop(recorder);
			stopped = true;
		}
		n = read(ends[0], buffer, sizeof buffer);
		if (n <= 0)
			break;
		assert_int_equal(write(copy, buffer, (size_t)n), n);
	}
	wait_state(recorder, GZ_RECORDING_OFF);
	gz_recorder_destroy(&recorder);
	close(copy);
	close(ends[0]);
	struct found found = read_back();
	assert_int_equal(found.ending, GZ_GAZE_LOG_WHOLE);
	assert_int_equal(found.gaps, 1);
	assert_true(found.missing > 0);
	assert_int_equal(found.samples + found.missing, pushed + lost + 1);
	unlink(path);
}

static void recorder_on_a_full_disk_fails_and_leaves_no_empty_file(void **state)
{
	(void)state;
	struct gz_recorder *recorder = NULL;
	struct gz_recorder_status status;
	struct captured_log captured;
	captured_log_init(&captured, NULL);
	assert_int_equal(gz_recorder_create(&captured.log, &recorder), GZ_OK);
	int fd = open("/dev/full", O_WRONLY | O_CLOEXEC);
	assert_true(fd >= 0);
	assert_int_equal(gz_recorder_start(recorder, fd, "/tmp/gz_no_such_file", &header), GZ_OK);
	wait_state(recorder, GZ_RECORDING_FAILED);
	gz_recorder_get_status(recorder, &status);
	assert_non_null(strstr(status.error, "No space left on device"));
	push_sample(recorder, 0);
	gz_recorder_stop(recorder);
	/* Another recording can be tried. */
	assert_int_equal(gz_recorder_start(recorder, open_file(), path, &header), GZ_OK);
	push_sample(recorder, 0);
	gz_recorder_destroy(&recorder);
	assert_int_equal(read_back().samples, 1);
	unlink(path);
	assert_int_equal(captured.messages, 2);
}

static void recorder_out_of_room_keeps_whole_lines_and_ends_the_log(void **state)
{
	(void)state;
	struct gz_recorder *recorder = NULL;
	struct gz_recorder_status status;
	struct rlimit limit, tight;
	signal(SIGXFSZ, SIG_IGN);
	assert_int_equal(getrlimit(RLIMIT_FSIZE, &limit), 0);
	tight = limit;
	tight.rlim_cur = 20000;
	assert_int_equal(setrlimit(RLIMIT_FSIZE, &tight), 0);
	assert_int_equal(gz_recorder_create(NULL, &recorder), GZ_OK);
	assert_int_equal(gz_recorder_start(recorder, open_file(), path, &header), GZ_OK);
	for (uint64_t i = 0; i < 5000; i++)
		push_sample(recorder, i);
	wait_state(recorder, GZ_RECORDING_FAILED);
	assert_int_equal(setrlimit(RLIMIT_FSIZE, &limit), 0);
	gz_recorder_get_status(recorder, &status);
	gz_recorder_destroy(&recorder);
	struct found found = read_back();
	struct stat file;
	assert_int_equal(stat(path, &file), 0);
	assert_true(file.st_size <= 20000 && file.st_size > 19000);
	assert_true(found.samples > 100);
	assert_int_equal(found.samples, status.samples);
	/* The "#end" line replaces the line that was cut, even if that was longer. */
	assert_true(found.ending == GZ_GAZE_LOG_WHOLE || found.ending == GZ_GAZE_LOG_CUT);
	unlink(path);
}

TEST_SUITE(recorder)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(recorder_writes_a_whole_log_with_marks),
		cmocka_unit_test(recorder_destroyed_while_it_records_ends_the_log),
		cmocka_unit_test(recorder_goes_on_writing_while_the_disk_is_busy),
		cmocka_unit_test(recorder_that_cannot_keep_up_says_what_is_missing),
		cmocka_unit_test(recorder_on_a_full_disk_fails_and_leaves_no_empty_file),
		cmocka_unit_test(recorder_out_of_room_keeps_whole_lines_and_ends_the_log),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
