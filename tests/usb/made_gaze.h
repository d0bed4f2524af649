/**
 * @file
 * Gaze whose truth is known: a point that wanders over a screen, computed from the number of the
 * sample. A tracker sends it, and a receiver finds the number by the device time.
 */
#ifndef GZ_TESTS_USB_MADE_GAZE_H
#define GZ_TESTS_USB_MADE_GAZE_H

#include <pthread.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stdint.h>

/** Screen of the tests, mm. */
#define MADE_WIDTH_MM  500.0
#define MADE_HEIGHT_MM 300.0

/** Samples a second, and the time between two. */
#define MADE_RATE_HZ   200
#define MADE_PERIOD_US (1000000 / MADE_RATE_HZ)

/** The device's clock at its first sample, µs. */
#define MADE_CLOCK_START_US INT64_C(7000000000)

/** One sample of the truth. */
struct made_sample {
	uint64_t number;
	int64_t device_us; /**< MADE_CLOCK_START_US + number * MADE_PERIOD_US, up to 1.5 ms later */
	double x, y;       /**< fractions of the screen from its top left corner */
};

/** Sample @p number. Slow enough for an eye, never at rest, within the screen. */
struct made_sample made_gaze(uint64_t number);

/** The sample whose device time is @p device_ns. */
struct made_sample made_gaze_at(int64_t device_ns);

/** Sends samples as time passes, on a thread of its own. The device clock runs on while the host is
 * suspended or the stream is stopped; samples that were due then are never sent. Zero-initialised
 * is none. */
struct made_stream {
	/** Called with each sample that is due. A sample that cannot be sent is lost. */
	void (*send)(void *tracker, const struct made_sample *sample);
	void *tracker;
	bool has_clock;   /**< the tracker stamps its samples */
	double tolerance; /**< of its points, screen sides; by how they are encoded */
	pthread_t thread;
	bool running;
	atomic_bool stop;
	_Atomic int64_t start_us; /**< CLOCK_BOOTTIME at which sample 0 was due */
};

/** Start, or continue. */
void made_stream_start(struct made_stream *stream);

/** Stop. Does nothing if it is not running. */
void made_stream_stop(struct made_stream *stream);

#endif
