#include "suite.h"

#include "lab.h"

#include <grp.h>
#include <inttypes.h>
#include <math.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#include "base/clock.h"
#include "base/suspend.h"
#include "guest.h"
#include "protocol/wire.h"
#include "recorded.h"

/* Bounds for host time less the time when a sample was due. On a busy machine an emulated one
 * delivers samples with delays that vary by 100 ms, and the clock fit of the first second can be
 * wrong by as much in both directions. Other tests check how well clocks are fitted. */
#define EARLY_NS (100 * GZ_NS_PER_MS)
#define LATE_NS  (3 * GZ_NS_PER_S)

enum { FILLERS_MAX = 1000 };

/* How long samples may be rejected as too fast after some that came behind their fillers: the host
 * times of those lie 1 ns apart. Chosen: a few samples. */
#define TOO_FAST_NS (50 * GZ_NS_PER_MS)

struct lab lab;

void lab_open(void)
{
	memset(&lab.gaze, 0, sizeof lab.gaze);
	lab.compared = 0;
	lab.pushed_ns = INT64_MIN / 2;
	gazed_place_make(&lab.place);
	assert_int_equal(chown(lab.place.directory, LAB_USER, LAB_USER), 0);
	assert_int_equal(chown(lab.place.recordings, LAB_USER, LAB_USER), 0);
	reader_open(&lab.reader, &lab.place, "");
}

void lab_close(void)
{
	if (!lab.place.directory[0])
		return;
	reader_close(&lab.reader);
	gazed_kill_all();
	gazed_place_remove(&lab.place);
	memset(&lab.place, 0, sizeof lab.place);
}

int lab_set_up(void **state)
{
	(void)state;
	lab = (struct lab) { 0 };
	lab_open();
	return 0;
}

int lab_tear_down(void **state)
{
	(void)state;
	lab_close();
	guest_remove_udev_rules();
	hid_gadget_remove(&lab.tracker);
	hid_gadget_remove(&lab.second);
	hid_function_remove(&lab.function);
	psvr2_gadget_remove(&lab.headset);
	tobii5_gadget_remove(&lab.desk);
	return 0;
}

void lab_plug_tracker(enum hid_layout layout)
{
	hid_gadget_plug(&lab.tracker, 0, layout, "GazeLab 200", "GL-7");
	made_stream_start(&lab.tracker.stream);
}

void lab_plug_second(void)
{
	hid_gadget_plug(&lab.second, 1, HID_LAYOUT_COARSE, "EyeWorks Fine", "EW-42");
	made_stream_start(&lab.second.stream);
}

void lab_plug_function(const char *name, const char *serial)
{
	hid_function_plug(&lab.function, 0, name, serial);
	made_stream_start(&lab.function.stream);
}

void lab_plug_headset(void)
{
	psvr2_gadget_plug(&lab.headset, "VR-123");
	made_stream_start(&lab.headset.stream);
}

void lab_start(bool as_user, const char *const *arguments)
{
	/* Let root own the folder, which the ordinary user could not do. */
	if (!as_user)
		assert_int_equal(chown(lab.place.directory, 0, 0), 0);
	struct gazed_start start = {
		.place = &lab.place,
		.arguments = arguments,
		.user = as_user ? LAB_USER : 0,
		.group = LAB_GROUP,
	};
	gazed_spawn(&start, &lab.gazed);
	gazed_wait_ready(&lab.place, &lab.gazed);
}

void lab_stop(void)
{
	int status = gazed_stop(&lab.gazed, SIGTERM);
	if (status != 0)
		fail_msg("gazed ended with %d: %s", status, lab_said());
}

const char *lab_said(void)
{
	return gazed_said(&lab.gazed);
}

void lab_expect_said(const char *text)
{
	if (!strstr(lab_said(), text))
		fail_msg("not logged: \"%s\"; but:\n%s", text, lab_said());
}

/* Receive one message. @return whether it is gaze, which is then in lab.gaze */
static bool receive(void)
{
	struct reader *reader = &lab.reader;
	uint64_t before = reader->gaze_count;
	if (!reader_receive(reader, PATIENCE_MS))
		fail_msg("nothing comes; tracker is %s (%s); gazed said:\n%s",
			 gz_tracker_state_name(reader->status.tracker.state),
			 reader->status.tracker.reason, lab_said());
	const struct received *message = &reader->messages[reader->count - 1];
	if (reader->gaze_count == before)
		return false;
	const int64_t before_ns = lab.gaze.host_ns;
	assert_int_equal(gz_wire_decode_gaze(message->bytes, message->size, &lab.gaze), GZ_OK);
	if (lab.gaze.host_ns - before_ns == 1)
		lab.pushed_ns = lab.gaze.host_ns;
	return true;
}

static void check_patience(int64_t begin_ns, const char *what)
{
	if (gz_clock_now_ns() - begin_ns > PATIENCE_NS)
		fail_msg("no %s; tracker is %s (%s); gazed said:\n%s", what,
			 gz_tracker_state_name(lab.reader.status.tracker.state),
			 lab.reader.status.tracker.reason, lab_said());
}

void lab_next_gaze(void)
{
	int64_t begin_ns = gz_clock_now_ns();
	while (!receive())
		check_patience(begin_ns, "gaze");
}

/* CLOCK_MONOTONIC at which sample @p number was due, ns; valid since the last suspend. */
static int64_t due_ns(const struct made_stream *stream, uint64_t number)
{
	return (stream->start_us + (int64_t)number * MADE_PERIOD_US) * GZ_NS_PER_US -
	       gz_suspended_ns();
}

/* For a tracker without a clock: the newest sample with this point that was due by then. */
static struct made_sample sample_without_clock(const struct made_stream *stream,
					       const struct gz_gaze *gaze)
{
	int64_t since_ns = gaze->host_ns - due_ns(stream, 0);
	/* The two clocks are not read at the same time, so allow some samples more. */
	uint64_t newest = (uint64_t)(since_ns / GZ_NS_PER_US / MADE_PERIOD_US) + 10;
	uint64_t oldest = newest > MADE_RATE_HZ ? newest - MADE_RATE_HZ : 0;
	for (uint64_t number = newest; number > oldest; number--) {
		struct made_sample sample = made_gaze(number);
		if (fabs(gaze->raw.x - sample.x) < stream->tolerance &&
		    fabs(gaze->raw.y - sample.y) < stream->tolerance)
			return sample;
	}
	return made_gaze(newest);
}

/* Compare one gaze message. @param pushed  it came so late that fillers had taken its place */
static void compare_one(const struct made_stream *stream, const struct gz_gaze *gaze, bool pushed)
{
	struct made_sample sample = stream->has_clock ? made_gaze_at(gaze->device_ns)
						      : sample_without_clock(stream, gaze);
	double off_x = gaze->raw.x - sample.x, off_y = gaze->raw.y - sample.y;
	int64_t late_ns = gaze->host_ns - due_ns(stream, sample.number);
	if (stream->has_clock)
		assert_true(llabs(gaze->device_ns / GZ_NS_PER_US - sample.device_us) <= 1000);
	if (isnan(off_x) || fabs(off_x) > stream->tolerance || fabs(off_y) > stream->tolerance)
		fail_msg("sample %" PRIu64 " is at %f %f, was sent at %f %f, confidence %f, %f ms "
			 "after one pushed behind fillers; too fast: %" PRIu64,
			 sample.number, gaze->raw.x, gaze->raw.y, sample.x, sample.y,
			 (double)gaze->confidence, gz_ns_to_ms(gaze->host_ns - lab.pushed_ns),
			 lab.reader.status.rejected[GZ_REJECT_VELOCITY]);
	if (late_ns < -EARLY_NS || (late_ns > LATE_NS && !pushed))
		fail_msg("sample %" PRIu64 " is %f ms late", sample.number, gz_ns_to_ms(late_ns));
	/* Smoothing must not move the point far. */
	if (fabs(gaze->point.x - gaze->raw.x) > 0.1 || fabs(gaze->point.y - gaze->raw.y) > 0.1)
		fail_msg("sample %" PRIu64 " at %f %f was smoothed to %f %f", sample.number,
			 gaze->raw.x, gaze->raw.y, gaze->point.x, gaze->point.y);
}

/* Whether a message is a filler for samples that a tracker omits because it cannot measure. */
static bool is_filler(const struct gz_gaze *gaze)
{
	return gaze->device_ns == GZ_NO_DEVICE_TIME && isnan(gaze->raw.x) &&
	       !gaze->eye[GZ_EYE_LEFT].valid && !gaze->eye[GZ_EYE_RIGHT].valid;
}

/* Whether a sample is rejected because its host time, or that of one shortly before, was pushed
 * behind fillers. */
static bool is_pushed_together(const struct gz_gaze *gaze)
{
	return isnan(gaze->raw.x) && gaze->host_ns - lab.pushed_ns <= TOO_FAST_NS;
}

static void compare_order(const struct gz_gaze *before, const struct gz_gaze *gaze)
{
	if (gaze->seq <= before->seq || gaze->host_ns <= before->host_ns)
		fail_msg("sample %" PRIu64 " at %" PRId64 " follows %" PRIu64 " at %" PRId64,
			 gaze->seq, gaze->host_ns, before->seq, before->host_ns);
}

void lab_compare(const struct made_stream *stream, uint64_t count)
{
	uint64_t fillers = 0;
	assert_true(count > 0);
	while (count > 0) {
		struct gz_gaze before = lab.gaze;
		lab_next_gaze();
		if (lab.compared++ > 0)
			compare_order(&before, &lab.gaze);
		if (is_filler(&lab.gaze) || is_pushed_together(&lab.gaze)) {
			assert_true(++fillers < FILLERS_MAX);
			continue;
		}
		/* Host time does not run backwards, so a late sample comes directly behind the
		 * fillers. */
		compare_one(stream, &lab.gaze, lab.gaze.host_ns - before.host_ns == 1);
		count--;
	}
}

void lab_wait(bool (*done)(void), const char *what)
{
	int64_t begin_ns = gz_clock_now_ns();
	while (!done()) {
		receive();
		check_patience(begin_ns, what);
	}
}

void lab_wait_state(enum gz_tracker_state state)
{
	int64_t begin_ns = gz_clock_now_ns();
	while (lab.reader.status_count == 0 || lab.reader.status.tracker.state != state) {
		receive();
		check_patience(begin_ns, gz_tracker_state_name(state));
	}
}

void lab_wait_malformed(enum gz_malformed kind, uint64_t count)
{
	int64_t begin_ns = gz_clock_now_ns();
	while (lab.reader.status_count == 0 || lab.reader.status.malformed[kind] < count) {
		receive();
		check_patience(begin_ns, gz_malformed_name(kind));
	}
	assert_int_equal(lab.reader.status.malformed[kind], count);
}

void lab_check_replug(const struct lab_replug *how)
{
	lab_wait_state(GZ_TRACKER_ABSENT);
	print_message("           without: %s\n", lab.reader.status.tracker.reason);
	int64_t plugged_ns = gz_clock_now_ns();
	how->plug();
	lab_compare(how->stream, 1);
	print_message("           first gaze %.1f s after the plug\n",
		      gz_ns_to_s(gz_clock_now_ns() - plugged_ns));
	assert_string_equal(gazed_request(&lab.place, "R replug", NULL), "OK");
	lab_compare(how->stream, how->count);
	for (int i = 0; i < how->times; i++) {
		uint64_t last_seq = lab.gaze.seq;
		how->unplug();
		lab_wait_state(GZ_TRACKER_LOST);
		print_message("           unplugged: %s\n", lab.reader.status.tracker.reason);
		how->replug();
		lab_wait_state(GZ_TRACKER_RUNNING);
		lab_compare(how->stream, how->count);
		assert_true(lab.gaze.seq > last_seq);
	}
	assert_string_equal(gazed_request(&lab.place, "r", NULL), "OK");
	lab_stop();
	struct recorded found = recorded_read(lab.place.recordings, "replug.gzl");
	print_message("           recorded %d samples; %d outages, and %d samples lost otherwise\n",
		      (int)found.samples, (int)found.outages, (int)found.missing);
	assert_int_equal(found.ending, GZ_GAZE_LOG_WHOLE);
	assert_int_equal(found.backwards, 0);
	/* There are more if the machine was held up for a second. */
	assert_true(found.outages >= (uint64_t)how->times);
}

void lab_check_stall(struct made_stream *stream, int endpoint, uint64_t count)
{
	lab_compare(stream, 50);
	made_stream_stop(stream);
	gadget_stall(endpoint);
	made_stream_start(stream);
	int64_t begin_ns = gz_clock_now_ns();
	lab_compare(stream, count);
	print_message("           %d samples %.2f s after the stall\n", (int)count,
		      gz_ns_to_s(gz_clock_now_ns() - begin_ns));
}

/* In the child process: run gazectl as that user. */
static void become_gazectl(bool as_user, int out)
{
	dup2(out, STDOUT_FILENO);
	dup2(out, STDERR_FILENO);
	const gid_t group = LAB_GROUP;
	if (as_user &&
	    (setgroups(1, &group) != 0 || setgid(LAB_USER) != 0 || setuid(LAB_USER) != 0))
		_exit(126);
	execl("/usr/bin/gazectl", "gazectl", "devices", (char *)NULL);
	_exit(127);
}

const char *lab_devices(bool as_user)
{
	static char text[4096];
	int pipes[2], status;
	size_t length = 0;
	ssize_t size;
	assert_int_equal(pipe(pipes), 0);
	pid_t process = fork();
	if (process == 0)
		become_gazectl(as_user, pipes[1]);
	close(pipes[1]);
	while ((size = read(pipes[0], text + length, sizeof text - 1 - length)) > 0)
		length += (size_t)size;
	text[length] = '\0';
	close(pipes[0]);
	assert_int_equal(waitpid(process, &status, 0), process);
	print_message("%s", text);
	if (!WIFEXITED(status) || WEXITSTATUS(status) > 1)
		fail_msg("gazectl devices ended with status 0x%x: %s", status, text);
	return text;
}
