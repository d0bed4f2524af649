#include "check.h"

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
#include "protocol/wire.h"

/* Between when a sample was due and its host time. On a busy machine an emulated one delivers
 * samples with delays that vary by 100 ms; the fit of a clock's first second can be off by that in
 * both directions. How well clocks are fitted is tested elsewhere. */
#define EARLY_NS (100 * GZ_NS_PER_MS)
#define LATE_NS  (3 * GZ_NS_PER_S)

enum { PATIENCE_MS = 20000, FILLERS_MAX = 1000 };

void lab_open(struct lab *lab)
{
	*lab = (struct lab) { 0 };
	gazed_place_make(&lab->place);
	assert_int_equal(chown(lab->place.directory, LAB_USER, LAB_USER), 0);
	assert_int_equal(chown(lab->place.recordings, LAB_USER, LAB_USER), 0);
	reader_open(&lab->reader, &lab->place, "");
}

void lab_start(struct lab *lab, bool as_user, const char *const *arguments)
{
	/* What the ordinary user could not make, it need not. */
	if (!as_user)
		assert_int_equal(chown(lab->place.directory, 0, 0), 0);
	struct gazed_start start = {
		.place = &lab->place,
		.arguments = arguments,
		.user = as_user ? LAB_USER : 0,
		.group = LAB_GROUP,
	};
	gazed_spawn(&start, &lab->gazed);
	gazed_wait_ready(&lab->place, &lab->gazed);
}

void lab_stop(struct lab *lab)
{
	int status = gazed_stop(&lab->gazed, SIGTERM);
	if (status != 0)
		fail_msg("gazed ended with %d: %s", status, lab_said(lab));
}

void lab_close(struct lab *lab)
{
	if (!lab->place.directory[0])
		return;
	reader_close(&lab->reader);
	gazed_kill_all();
	gazed_place_remove(&lab->place);
	*lab = (struct lab) { 0 };
}

const char *lab_said(const struct lab *lab)
{
	return gazed_said(&lab->gazed);
}

void lab_expect_said(const struct lab *lab, const char *text)
{
	if (!strstr(lab_said(lab), text))
		fail_msg("not logged: \"%s\"; but:\n%s", text, lab_said(lab));
}

/* Receive one message. @return whether it was a gaze, then in lab->gaze */
static bool receive(struct lab *lab)
{
	struct reader *reader = &lab->reader;
	uint64_t before = reader->gaze_count;
	if (!reader_receive(reader, PATIENCE_MS))
		fail_msg("nothing comes; tracker is %s (%s); gazed said:\n%s",
			 gz_tracker_state_name(reader->status.tracker.state),
			 reader->status.tracker.reason, lab_said(lab));
	const struct received *message = &reader->messages[reader->count - 1];
	if (reader->gaze_count == before)
		return false;
	assert_int_equal(gz_wire_decode_gaze(message->bytes, message->size, &lab->gaze), GZ_OK);
	return true;
}

static void check_patience(const struct lab *lab, int64_t begin_ns, const char *what)
{
	if (gz_clock_now_ns() - begin_ns > PATIENCE_MS * GZ_NS_PER_MS)
		fail_msg("no %s; tracker is %s (%s); gazed said:\n%s", what,
			 gz_tracker_state_name(lab->reader.status.tracker.state),
			 lab->reader.status.tracker.reason, lab_said(lab));
}

void lab_next_gaze(struct lab *lab)
{
	int64_t begin_ns = gz_clock_now_ns();
	while (!receive(lab))
		check_patience(lab, begin_ns, "gaze");
}

/* CLOCK_MONOTONIC at which sample @p number was due, ns; right since the last suspend. */
static int64_t due_ns(const struct made_stream *stream, uint64_t number)
{
	return (stream->start_us + (int64_t)number * MADE_PERIOD_US) * GZ_NS_PER_US -
	       gz_suspended_ns();
}

/* Of a tracker without a clock: the newest sample that was due until then, and was there. */
static struct made_sample sample_without_clock(const struct lab_truth *truth,
					       const struct gz_gaze *gaze)
{
	int64_t since_ns = gaze->host_ns - due_ns(truth->stream, 0);
	/* Two clocks are not read at once: some samples more. */
	uint64_t newest = (uint64_t)(since_ns / GZ_NS_PER_US / MADE_PERIOD_US) + 10;
	uint64_t oldest = newest > MADE_RATE_HZ ? newest - MADE_RATE_HZ : 0;
	for (uint64_t number = newest; number > oldest; number--) {
		struct made_sample sample = made_gaze(number);
		if (fabs(gaze->raw.x - sample.x) < truth->tolerance &&
		    fabs(gaze->raw.y - sample.y) < truth->tolerance)
			return sample;
	}
	return made_gaze(newest);
}

/* @param pushed  it came so late that fillers stood in its place already */
static void compare_one(const struct lab_truth *truth, const struct gz_gaze *gaze, bool pushed)
{
	struct made_sample sample = truth->has_clock ? made_gaze_at(gaze->device_ns)
						     : sample_without_clock(truth, gaze);
	double off_x = gaze->raw.x - sample.x, off_y = gaze->raw.y - sample.y;
	int64_t late_ns = gaze->host_ns - due_ns(truth->stream, sample.number);
	if (truth->has_clock)
		assert_true(llabs(gaze->device_ns / GZ_NS_PER_US - sample.device_us) <= 1000);
	if (isnan(off_x) || fabs(off_x) > truth->tolerance || fabs(off_y) > truth->tolerance)
		fail_msg("sample %" PRIu64 " is at %f %f, was sent at %f %f, confidence %f",
			 sample.number, gaze->raw.x, gaze->raw.y, sample.x, sample.y,
			 (double)gaze->confidence);
	if (late_ns < -EARLY_NS || (late_ns > LATE_NS && !pushed))
		fail_msg("sample %" PRIu64 " is %f ms late", sample.number, gz_ns_to_ms(late_ns));
	/* Smoothing does not lead away. */
	if (fabs(gaze->point.x - gaze->raw.x) > 0.1 || fabs(gaze->point.y - gaze->raw.y) > 0.1)
		fail_msg("sample %" PRIu64 " at %f %f was smoothed to %f %f", sample.number,
			 gaze->raw.x, gaze->raw.y, gaze->point.x, gaze->point.y);
}

/* What a driver puts where a tracker that leaves out what it cannot measure sent nothing. */
static bool is_filler(const struct gz_gaze *gaze)
{
	return gaze->device_ns == GZ_NO_DEVICE_TIME && isnan(gaze->raw.x) &&
	       !gaze->eye[GZ_EYE_LEFT].valid && !gaze->eye[GZ_EYE_RIGHT].valid;
}

static void compare_order(const struct gz_gaze *before, const struct gz_gaze *gaze)
{
	if (gaze->seq <= before->seq || gaze->host_ns <= before->host_ns)
		fail_msg("sample %" PRIu64 " at %" PRId64 " follows %" PRIu64 " at %" PRId64,
			 gaze->seq, gaze->host_ns, before->seq, before->host_ns);
}

void lab_compare(struct lab *lab, const struct lab_truth *truth, uint64_t count)
{
	uint64_t fillers = 0;
	assert_true(count > 0);
	while (count > 0) {
		struct gz_gaze before = lab->gaze;
		lab_next_gaze(lab);
		if (lab->compared++ > 0)
			compare_order(&before, &lab->gaze);
		if (is_filler(&lab->gaze)) {
			assert_true(++fillers < FILLERS_MAX);
			continue;
		}
		/* Time does not run backwards, so it is put right behind them. */
		compare_one(truth, &lab->gaze, lab->gaze.host_ns - before.host_ns == 1);
		count--;
	}
}

void lab_wait(struct lab *lab, bool (*done)(const struct lab *lab), const char *what)
{
	int64_t begin_ns = gz_clock_now_ns();
	while (!done(lab)) {
		receive(lab);
		check_patience(lab, begin_ns, what);
	}
}

void lab_wait_state(struct lab *lab, enum gz_tracker_state state)
{
	int64_t begin_ns = gz_clock_now_ns();
	while (lab->reader.status_count == 0 || lab->reader.status.tracker.state != state) {
		receive(lab);
		check_patience(lab, begin_ns, gz_tracker_state_name(state));
	}
}

void lab_wait_malformed(struct lab *lab, enum gz_malformed kind, uint64_t count)
{
	int64_t begin_ns = gz_clock_now_ns();
	while (lab->reader.status_count == 0 || lab->reader.status.malformed[kind] < count) {
		receive(lab);
		check_patience(lab, begin_ns, gz_malformed_name(kind));
	}
	assert_int_equal(lab->reader.status.malformed[kind], count);
}

/* In the child: gazectl as that user. */
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
