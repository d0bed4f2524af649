/* Real processes from end to end: gazed with the simulator, gazeview headless on its latest
 * channel, and this test on its stream, which sees where each saccade of the viewer lands. */
#include "suite.h"

#include <dirent.h>
#include <fcntl.h>
#include <math.h>
#include <signal.h>
#include <spawn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#include "base/clock.h"
#include "base/order.h"
#include "client/stream.h"
#include "protocol/endpoint.h"
#include "render/picture/image.h"

extern char **environ;

enum {
	WIDTH = 640,
	HEIGHT = 360,
	FRAMES = 180,
	FPS = 60,
	MESSAGES_MAX = 200000,
	SACCADES_MAX = 256,
	FRAMES_MAX = FRAMES + 1,
	PATH_SIZE = 256,
};

/* Smallest saccade that is followed: larger than anything a fixation could be taken for. */
#define SACCADE_MIN_DEG 4.0
/* Largest distance of the picture's fovea from the landing. */
#define LANDING_DEG 0.5
/* Age of the gaze when a frame's plan is made, for the youngest quarter of frames. A machine with
 * other work delays some frames at will, so neither the median nor the oldest is looked at: a
 * viewer that lags behind does so in every frame. */
#define AGE_QUARTILE_MS 15.0
/* From a landing to the plan that is made for it, for the promptest saccade: a frame, what the
 * filter needs to see that the eye rests, and the same allowance. */
#define DELAY_LEAST_MS 60.0

/* Targets of the viewer: corners and centre, so that saccades are long. */
static const char targets[] = "0.2 0.25\n0.8 0.3\n0.5 0.5\n0.25 0.75\n0.75 0.8\n";

struct frame {
	bool known;
	struct gz_point gaze;
	double age_ms;
	int message; /* index of the message that it shows; -1 if none is the same */
};

static char folder[] = "/tmp/gazecast-test-saccade-XXXXXX";
static pid_t daemon_process;
static struct gz_gaze *messages;
static int message_count;
static struct gz_saccade saccades[SACCADES_MAX];
static int saccade_count;
static struct gz_display display;
static bool display_known;
static struct frame frames[FRAMES_MAX];
static int frame_count;

static const char *path_of(const char *name)
{
	static char paths[4][PATH_SIZE + sizeof folder];
	static int next;
	char *path = paths[next++ % 4];
	snprintf(path, sizeof paths[0], "%s/%s", folder, name);
	return path;
}

static pid_t start(const char *const *argv)
{
	pid_t process = -1;
	posix_spawn_file_actions_t actions;
	posix_spawn_file_actions_init(&actions);
	posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, path_of("stdout.txt"),
					 O_WRONLY | O_CREAT | O_APPEND, 0600);
	int failure = posix_spawn(&process, argv[0], &actions, NULL, (char *const *)argv, environ);
	posix_spawn_file_actions_destroy(&actions);
	if (failure != 0)
		fail_msg("%s does not start: %s", argv[0], strerror(failure));
	return process;
}

static int wait_for(pid_t process)
{
	int status = -1;
	assert_int_equal(waitpid(process, &status, 0), process);
	return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

static void take(const struct gz_message *message)
{
	switch (message->kind) {
	case GZ_MESSAGE_GAZE:
		if (message_count < MESSAGES_MAX)
			messages[message_count++] = message->gaze;
		break;
	case GZ_MESSAGE_SACCADE:
		if (saccade_count < SACCADES_MAX)
			saccades[saccade_count++] = message->saccade;
		break;
	case GZ_MESSAGE_STATUS:
		display = message->status.display;
		display_known = true;
		break;
	default:
		break;
	}
}

/* Read the stream until the viewer has ended. @return its exit status */
static int follow_until_end(struct gz_stream *stream, pid_t viewer)
{
	struct gz_message message;
	int status = 0;
	while (waitpid(viewer, &status, WNOHANG) == 0) {
		if (gz_stream_read(stream, 10, &message) == GZ_OK)
			take(&message);
	}
	int64_t end_ns = gz_clock_now_ns() + 100 * GZ_NS_PER_MS;
	while (gz_clock_now_ns() < end_ns) {
		if (gz_stream_read(stream, 10, &message) == GZ_OK)
			take(&message);
	}
	return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

/* There is one entry on each line; only the two keys that this test needs are read. */
static void read_stats(void)
{
	char line[1024];
	FILE *in = fopen(path_of("stats.json"), "r");
	assert_non_null(in);
	while (fgets(line, sizeof line, in)) {
		const char *gaze = strstr(line, "\"gaze\": ");
		const char *age = strstr(line, "\"gaze_age_ms\": ");
		if (!gaze || !age)
			continue;
		assert_true(frame_count < FRAMES_MAX);
		struct frame *frame = &frames[frame_count++];
		frame->known =
			sscanf(gaze, "\"gaze\": [%f, %f]", &frame->gaze.x, &frame->gaze.y) == 2;
		frame->age_ms = -1;
		sscanf(age, "\"gaze_age_ms\": %lf", &frame->age_ms);
	}
	fclose(in);
}

/* Each frame's message: the first with exactly its point, not before the last frame's. */
static void match_frames(void)
{
	int from = 0;
	for (int i = 0; i < frame_count; i++) {
		frames[i].message = -1;
		for (int k = from; k < message_count && frames[i].known; k++) {
			if (messages[k].point.x != frames[i].gaze.x ||
			    messages[k].point.y != frames[i].gaze.y)
				continue;
			frames[i].message = k;
			from = k;
			break;
		}
	}
}

/* Run the whole pipeline once; the tests examine the result. */
static int run_pipeline(void **state)
{
	(void)state;
	char endpoint[GZ_ENDPOINT_SIZE], stream_endpoint[GZ_ENDPOINT_SIZE];
	struct gz_stream *stream = NULL;
	struct gz_message message;
	messages = calloc(MESSAGES_MAX, sizeof *messages);
	if (!messages || !mkdtemp(folder))
		return -1;
	setenv("GAZECAST_RUNTIME_DIR", folder, 1);
	setenv("XDG_CONFIG_HOME", folder, 1); /* no settings of the user who runs the test */
	FILE *out = fopen(path_of("targets.txt"), "w");
	if (!out || fputs(targets, out) < 0 || fclose(out) != 0)
		return -1;
	/* No spikes, which look like landings without a saccade, and no pursuit, which leaves the
	 * landing point. */
	const char *const gazed[] = { GAZED_PROGRAM,
				      "--driver=sim",
				      "--tcp=off",
				      "--sim.seed=7",
				      "--sim.rate_hz=250",
				      "--sim.noise_deg=0.05",
				      "--sim.spikes=0",
				      "--sim.pursuits_per_min=0",
				      "--sim.targets",
				      path_of("targets.txt"),
				      NULL };
	daemon_process = start(gazed);
	gz_endpoint_ipc(folder, "latest", endpoint, sizeof endpoint);
	gz_endpoint_ipc(folder, "stream", stream_endpoint, sizeof stream_endpoint);
	if (gz_stream_open(stream_endpoint, NULL, NULL, &stream) != GZ_OK)
		return -1;
	int64_t deadline_ns = gz_clock_now_ns() + PATIENCE_NS;
	while (message_count == 0 && gz_clock_now_ns() < deadline_ns) {
		if (gz_stream_read(stream, 100, &message) == GZ_OK)
			take(&message);
	}
	const char *const gazeview[] = {
		GAZEVIEW,   "--headless", "--scene",  SCENE,
		"--size",   "320x180",    "--gaze",   endpoint,
		"--fps",    "60",         "--method", "acuity",
		"--frames", "180",        "--stats",  path_of("stats.json"),
		NULL
	};
	int status = follow_until_end(stream, start(gazeview));
	gz_stream_close(&stream);
	if (status != 0)
		return -1;
	read_stats();
	match_frames();
	return 0;
}

static int clean_up(void **state)
{
	(void)state;
	if (daemon_process > 0) {
		kill(daemon_process, SIGTERM);
		wait_for(daemon_process);
	}
	DIR *entries = opendir(folder);
	for (struct dirent *entry; entries && (entry = readdir(entries)) != NULL;)
		unlink(path_of(entry->d_name));
	if (entries)
		closedir(entries);
	rmdir(folder);
	free(messages);
	return 0;
}

static void every_frame_shows_a_gaze_of_the_stream_in_its_order(void **state)
{
	(void)state;
	assert_int_equal(frame_count, FRAMES);
	assert_true(message_count > 200);
	int unknown = 0;
	for (int i = 0; i < frame_count; i++) {
		if (frames[i].message < 0)
			print_error("frame %d: gaze %.6f, %.6f is of no message\n", i,
				    (double)frames[i].gaze.x, (double)frames[i].gaze.y);
		unknown += frames[i].message < 0;
	}
	assert_int_equal(unknown, 0);
	assert_true(frames[frame_count - 1].message > frames[0].message + 100);
}

/* The lower quartile of the ages of some frames. */
static double age_quartile_ms(const struct frame *from, int count)
{
	double ages[FRAMES_MAX];
	for (int i = 0; i < count; i++) {
		ages[i] = from[i].age_ms;
		assert_true(ages[i] >= 0);
	}
	qsort(ages, (size_t)count, sizeof ages[0], gz_compare_doubles);
	print_message("gaze age of %d frames: quarter %.2f ms, median %.2f ms, most %.2f ms\n",
		      count, ages[count / 4], ages[count / 2], ages[count - 1]);
	return ages[count / 4];
}

static void gaze_is_young_when_a_frame_is_planned_and_stays_so(void **state)
{
	(void)state;
	const int third = frame_count / 3;
	assert_true(age_quartile_ms(frames, third) < AGE_QUARTILE_MS);
	assert_true(age_quartile_ms(frames + frame_count - third, third) < AGE_QUARTILE_MS);
}

static int64_t planned_ns(const struct frame *frame)
{
	return messages[frame->message].host_ns + (int64_t)(frame->age_ms * 1e6);
}

/* The first frame whose gaze is of @p time_ns or later; NULL after the last. */
static const struct frame *frame_knowing_of(int64_t time_ns)
{
	for (int i = 0; i < frame_count; i++) {
		if (frames[i].message >= 0 && messages[frames[i].message].host_ns >= time_ns)
			return &frames[i];
	}
	return NULL;
}

/* Whether the eye has moved on: another saccade between the landing and @p time_ns. */
static bool left_again(const struct gz_saccade *landed, int64_t time_ns)
{
	for (int i = 0; i < saccade_count; i++) {
		if (saccades[i].start_ns > landed->start_ns && saccades[i].start_ns <= time_ns)
			return true;
	}
	return false;
}

/* Whether the frames could and did follow this saccade; records how quickly. */
static bool follow(const struct gz_saccade *saccade, double *least_delay_ms)
{
	const int64_t landing_ns = saccade->start_ns + saccade->duration_ns;
	if (saccade->amplitude_deg < SACCADE_MIN_DEG ||
	    saccade->start_ns < messages[frames[0].message].host_ns)
		return false;
	const struct frame *frame = frame_knowing_of(landing_ns);
	if (!frame || left_again(saccade, messages[frame->message].host_ns))
		return false;
	const double miss_deg = gz_display_angle_deg(&display, frame->gaze, saccade->end);
	const double delay_ms = gz_ns_to_ms(planned_ns(frame) - landing_ns);
	print_message("saccade of %.1f deg: planned for %.1f ms after its landing, %.2f deg beside "
		      "it\n",
		      (double)saccade->amplitude_deg, delay_ms, miss_deg);
	assert_true(miss_deg <= LANDING_DEG);
	*least_delay_ms = fmin(*least_delay_ms, delay_ms);
	return true;
}

static void first_picture_that_knows_of_a_landing_is_sharp_there(void **state)
{
	(void)state;
	assert_true(display_known);
	int followed = 0;
	double least_delay_ms = 1e9;
	for (int i = 0; i < saccade_count; i++)
		followed += follow(&saccades[i], &least_delay_ms);
	assert_true(followed >= 3);
	assert_true(least_delay_ms < DELAY_LEAST_MS);
}

static void render_still(const char *method, struct gz_point gaze, const char *name,
			 struct gz_image *out_image)
{
	char at[64];
	snprintf(at, sizeof at, "%.9g,%.9g", (double)gaze.x, (double)gaze.y);
	const char *const gazeview[] = { GAZEVIEW,  "--headless",  "--scene", SCENE,      "--size",
					 "640x360", "--gaze",      at,        "--method", method,
					 "--out",   path_of(name), NULL };
	assert_int_equal(wait_for(start(gazeview)), 0);
	assert_int_equal(gz_image_read_png(path_of(name), NULL, out_image), GZ_OK);
}

static void picture_is_the_full_one_at_the_gaze_and_coarser_far_from_it(void **state)
{
	(void)state;
	const struct gz_display geometry = gz_display_default(WIDTH, HEIGHT);
	const struct gz_point gaze = { 0.2f, 0.5f };
	struct gz_image sharp = { 0 }, foveated = { 0 };
	render_still("standard", gaze, "sharp.png", &sharp);
	render_still("acuity", gaze, "foveated.png", &foveated);
	int foveal = 0, different_near = 0, different_far = 0;
	for (int y = 0; y < HEIGHT; y++) {
		for (int x = 0; x < WIDTH; x++) {
			size_t i = 4 * ((size_t)y * WIDTH + (size_t)x);
			struct gz_point pixel = { ((float)x + 0.5f) / WIDTH,
						  ((float)y + 0.5f) / HEIGHT };
			double angle = gz_display_angle_deg(&geometry, pixel, gaze);
			bool different = memcmp(sharp.pixels + i, foveated.pixels + i, 4) != 0;
			foveal += angle <= 2.5; /* the fovea of every metric here */
			different_near += different && angle <= 2.5;
			different_far += different && angle > 20;
		}
	}
	gz_image_free(&sharp);
	gz_image_free(&foveated);
	assert_true(foveal > 1000);
	assert_int_equal(different_near, 0);
	assert_true(different_far > 1000);
}

TEST_SUITE(saccade_to_picture)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(every_frame_shows_a_gaze_of_the_stream_in_its_order),
		cmocka_unit_test(gaze_is_young_when_a_frame_is_planned_and_stays_so),
		cmocka_unit_test(first_picture_that_knows_of_a_landing_is_sharp_there),
		cmocka_unit_test(picture_is_the_full_one_at_the_gaze_and_coarser_far_from_it),
	};
	return cmocka_run_group_tests(tests, run_pipeline, clean_up);
}
