/* A fake libtobii_research.so with the functions that the driver looks up. Its types follow the
 * SDK's reference, not our header, so that a wrong layout in the header fails the tests. */
#include "tobii_stand_in.h"

#include <math.h>
#include <pthread.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#define EXPORT __attribute__((visibility("default")))

/* Types as in the reference. */
typedef struct {
	float x, y;
} Point2;
typedef struct {
	float x, y, z;
} Point3;
typedef enum { INVALID, VALID } Validity;
typedef struct {
	Point3 position_in_user_coordinates;
	Point3 position_in_track_box_coordinates;
	Validity validity;
} GazeOrigin;
typedef struct {
	float diameter;
	Validity validity;
} PupilData;
typedef struct {
	Point2 position_on_display_area;
	Point3 position_in_user_coordinates;
	Validity validity;
} GazePoint;
typedef struct {
	GazePoint gaze_point;
	PupilData pupil_data;
	GazeOrigin gaze_origin;
} EyeData;
typedef struct {
	EyeData left_eye;
	EyeData right_eye;
	int64_t device_time_stamp;
	int64_t system_time_stamp;
} GazeData;
typedef struct {
	Point3 bottom_left, bottom_right;
	float height;
	Point3 top_left, top_right;
	float width;
} DisplayArea;
typedef struct {
	int64_t system_time_stamp;
	int notification_type;
	union {
		float output_frequency;
		DisplayArea display_area;
		char text[512];
	} value;
} Notification;
typedef struct EyeTracker {
	const char *address, *name, *serial, *model;
} EyeTracker;
typedef struct {
	EyeTracker **eyetrackers;
	size_t count;
} EyeTrackers;
typedef void GazeCallback(GazeData *, void *);
typedef void NotificationCallback(Notification *, void *);

enum { OK = 0, FAILED = 1, NOTIFY_LOST = 0, NOTIFY_DISPLAY = 6 };

static struct tobii_stand_in control = { .trackers = 1,
					 .rate_hz = 500,
					 .display_mm = { 520, 290 } };
static EyeTracker trackers[2] = {
	{ "tet-tcp://169.254.1.1", "Left desk", "TPSP1-01", "Tobii Pro Spectrum" },
	{ "tobii-prp://TPFC2-02", "", "TPFC2-02", "Tobii Pro Fusion" },
};

static GazeCallback *gaze_callback;
static void *gaze_user;
static NotificationCallback *notification_callback;
static void *notification_user;
static pthread_t thread;
static atomic_int quit;

EXPORT tobii_stand_in_control_function tobii_stand_in_control;

struct tobii_stand_in *tobii_stand_in_control(void)
{
	return &control;
}

static bool fails(const char *function)
{
	return control.fails && strcmp(control.fails, function) == 0;
}

static int64_t now_ns(void)
{
	struct timespec now;
	clock_gettime(CLOCK_MONOTONIC, &now);
	return (int64_t)now.tv_sec * 1000000000 + now.tv_nsec;
}

EXPORT int tobii_research_get_system_time_stamp(int64_t *out_us);
EXPORT int tobii_research_find_all_eyetrackers(EyeTrackers **out);
EXPORT void tobii_research_free_eyetrackers(EyeTrackers *list);
EXPORT int tobii_research_get_address(EyeTracker *tracker, char **out);
EXPORT int tobii_research_get_device_name(EyeTracker *tracker, char **out);
EXPORT int tobii_research_get_serial_number(EyeTracker *tracker, char **out);
EXPORT int tobii_research_get_model(EyeTracker *tracker, char **out);
EXPORT void tobii_research_free_string(char *text);
EXPORT int tobii_research_get_display_area(EyeTracker *tracker, DisplayArea *out);
EXPORT int tobii_research_set_gaze_output_frequency(EyeTracker *tracker, float frequency);
EXPORT int tobii_research_get_gaze_output_frequency(EyeTracker *tracker, float *out);
EXPORT int tobii_research_subscribe_to_gaze_data(EyeTracker *tracker, GazeCallback *callback,
						 void *user);
EXPORT int tobii_research_unsubscribe_from_gaze_data(EyeTracker *tracker, GazeCallback *callback);
EXPORT int tobii_research_subscribe_to_notifications(EyeTracker *tracker,
						     NotificationCallback *callback, void *user);
EXPORT int tobii_research_unsubscribe_from_notifications(EyeTracker *tracker,
							 NotificationCallback *callback);

int tobii_research_get_system_time_stamp(int64_t *out_us)
{
	if (fails("get_system_time_stamp"))
		return FAILED;
	*out_us = now_ns() / 1000 + control.system_zero_us;
	return OK;
}

int tobii_research_find_all_eyetrackers(EyeTrackers **out)
{
	if (fails("find_all_eyetrackers"))
		return FAILED;
	EyeTrackers *list = malloc(sizeof *list);
	list->eyetrackers = calloc(2, sizeof *list->eyetrackers);
	list->count = (size_t)control.trackers;
	for (size_t i = 0; i < list->count; i++)
		list->eyetrackers[i] = &trackers[i];
	atomic_fetch_add(&control.lists, 1);
	*out = list;
	return OK;
}

void tobii_research_free_eyetrackers(EyeTrackers *list)
{
	free(list->eyetrackers);
	free(list);
	atomic_fetch_sub(&control.lists, 1);
}

static int give(const char *function, const char *text, char **out)
{
	if (fails(function))
		return FAILED;
	atomic_fetch_add(&control.strings, 1);
	*out = strdup(text);
	return OK;
}

int tobii_research_get_address(EyeTracker *tracker, char **out)
{
	return give("get_address", tracker->address, out);
}

int tobii_research_get_device_name(EyeTracker *tracker, char **out)
{
	return give("get_device_name", tracker->name, out);
}

int tobii_research_get_serial_number(EyeTracker *tracker, char **out)
{
	return give("get_serial_number", tracker->serial, out);
}

int tobii_research_get_model(EyeTracker *tracker, char **out)
{
	return give("get_model", tracker->model, out);
}

void tobii_research_free_string(char *text)
{
	free(text);
	atomic_fetch_sub(&control.strings, 1);
}

int tobii_research_get_display_area(EyeTracker *tracker, DisplayArea *out)
{
	(void)tracker;
	if (fails("get_display_area"))
		return FAILED;
	*out = (DisplayArea) { .width = control.display_mm[0], .height = control.display_mm[1] };
	return OK;
}

int tobii_research_set_gaze_output_frequency(EyeTracker *tracker, float frequency)
{
	(void)tracker;
	if (fails("set_gaze_output_frequency"))
		return FAILED;
	control.frequency_set_hz = frequency;
	control.rate_hz = (double)frequency;
	return OK;
}

int tobii_research_get_gaze_output_frequency(EyeTracker *tracker, float *out)
{
	(void)tracker;
	if (fails("get_gaze_output_frequency"))
		return FAILED;
	*out = (float)control.rate_hz;
	return OK;
}

/* Send sample @p number, taken at @p taken_ns. In every third one the right eye is not found and
 * its values are NaN. */
static void send_gaze(long number, int64_t taken_ns)
{
	bool found = number % 3 != 0;
	GazeData gaze = {
		.left_eye = { .gaze_point = { { 0.49f, 0.5f }, { -100, 200, 30 }, VALID },
			      .pupil_data = { 3.25f, VALID },
			      .gaze_origin = { { -100, 200, 630 }, { 0.4f, 0.5f, 0.6f }, VALID } },
		.right_eye = { .gaze_point = { { 0.51f, 0.5f }, { 130, 200, 30 }, VALID },
			       .pupil_data = { 3.5f, VALID },
			       .gaze_origin = { { 30, 200, 630 }, { 0.6f, 0.5f, 0.6f }, VALID } },
		.device_time_stamp = taken_ns / 1000 + control.device_zero_us,
		.system_time_stamp = taken_ns / 1000 + control.system_zero_us,
	};
	if (!found) {
		gaze.right_eye.gaze_point =
			(GazePoint) { { NAN, NAN }, { NAN, NAN, NAN }, INVALID };
		gaze.right_eye.pupil_data = (PupilData) { NAN, INVALID };
		gaze.right_eye.gaze_origin =
			(GazeOrigin) { { NAN, NAN, NAN }, { NAN, NAN, NAN }, INVALID };
	}
	gaze_callback(&gaze, gaze_user);
}

static void notify(int type, float width)
{
	Notification notification = { .notification_type = type };
	notification.value.display_area.width = width;
	notification.value.display_area.height = control.display_mm[1];
	if (notification_callback)
		notification_callback(&notification, notification_user);
}

static bool asked(atomic_int *what)
{
	return atomic_exchange(what, 0) != 0;
}

static void *play(void *user)
{
	(void)user;
	int64_t begin_ns = now_ns();
	int64_t period_ns = (int64_t)(1e9 / control.rate_hz);
	for (int i = 0; i < control.burst; i++)
		send_gaze(i, begin_ns - (control.burst - i) * 1000);
	bool lost = false;
	for (long i = 0; !atomic_load(&quit); i++) {
		struct timespec step = { 0, period_ns };
		nanosleep(&step, NULL);
		control.device_zero_us +=
			(int64_t)atomic_exchange(&control.step_clock_s, 0) * 1000000;
		if (asked(&control.repeat_display))
			notify(NOTIFY_DISPLAY, control.display_mm[0]);
		if (asked(&control.change_display))
			notify(NOTIFY_DISPLAY, control.display_mm[0] + 1);
		if (asked(&control.lose_connection)) {
			notify(NOTIFY_LOST, 0);
			lost = true;
		}
		/* Computing takes half a millisecond. */
		if (!lost)
			send_gaze(i, now_ns() - 500000);
	}
	return NULL;
}

int tobii_research_subscribe_to_gaze_data(EyeTracker *tracker, GazeCallback *callback, void *user)
{
	(void)tracker;
	if (fails("subscribe_to_gaze_data"))
		return FAILED;
	gaze_callback = callback;
	gaze_user = user;
	atomic_store(&quit, 0);
	atomic_fetch_add(&control.subscriptions, 1);
	return pthread_create(&thread, NULL, play, NULL) == 0 ? OK : FAILED;
}

int tobii_research_unsubscribe_from_gaze_data(EyeTracker *tracker, GazeCallback *callback)
{
	(void)tracker;
	if (callback != gaze_callback)
		return FAILED;
	atomic_store(&quit, 1);
	pthread_join(thread, NULL);
	atomic_fetch_sub(&control.subscriptions, 1);
	return OK;
}

int tobii_research_subscribe_to_notifications(EyeTracker *tracker, NotificationCallback *callback,
					      void *user)
{
	(void)tracker;
	if (fails("subscribe_to_notifications"))
		return FAILED;
	notification_callback = callback;
	notification_user = user;
	return OK;
}

int tobii_research_unsubscribe_from_notifications(EyeTracker *tracker,
						  NotificationCallback *callback)
{
	(void)tracker;
	(void)callback;
	notification_callback = NULL;
	return OK;
}
