/**
 * @file
 * A stand-in for Pupil Capture: Pupil Remote, and gaze and surface messages with Pupil's keys,
 * packed by msgpack-c alone. What it does wrong is set while it runs.
 */
#ifndef GZ_TESTS_DRIVERS_PUPIL_CAPTURE_H
#define GZ_TESTS_DRIVERS_PUPIL_CAPTURE_H

#include <pthread.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stdint.h>

/** Samples of one surface message. */
#define PUPIL_CAPTURE_ENTRIES 4

/** Settings that may change while it runs. */
struct pupil_capture {
	char address[64];         /**< of its Pupil Remote, once started */
	int64_t period_ns;        /**< between two samples */
	double skew;              /**< its clock's, no unit; not while it runs */
	_Atomic int64_t ahead_ns; /**< its clock less the host's, at the beginning */
	atomic_bool deaf;         /**< does not answer */
	atomic_bool mute;         /**< sends nothing on its stream */
	atomic_bool garbage;      /**< sends one bad message of each kind beside every good one */
	atomic_bool monocular;    /**< the right eye alone */
	atomic_int skip;          /**< samples to leave out, once */
	atomic_bool twice;        /**< sends every message twice */
	const char *port_answer;  /**< to SUB_PORT; NULL: the truth */
	/* Its own. */
	void *context, *control, *stream;
	int control_port, stream_port;
	int64_t begin_ns;
	uint64_t number;
	atomic_bool quit;
	pthread_t thread;
};

/** Bind and start; at the port of before where it was started already. Asserts. */
void pupil_capture_start(struct pupil_capture *capture);

/** Stop and close its sockets. Does nothing where it does not run. */
void pupil_capture_stop(struct pupil_capture *capture);

/** What its clock shows at host time @p host_ns, ns. */
int64_t pupil_capture_time_ns(const struct pupil_capture *capture, int64_t host_ns);

/** Where it says one looks with sample @p number: origin top left. */
void pupil_capture_point(uint64_t number, double out_xy[2]);

#endif
