/**
 * @file
 * A fake Pupil Capture: Pupil Remote, and gaze and surface messages with Pupil's keys, packed by
 * msgpack-c alone. Its faults can be switched on while it runs.
 */
#ifndef GZ_TESTS_DRIVERS_PUPIL_CAPTURE_H
#define GZ_TESTS_DRIVERS_PUPIL_CAPTURE_H

#include <pthread.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stdint.h>

/** Samples in one surface message. */
#define PUPIL_CAPTURE_ENTRIES 4

/** Settings; those that are atomic may change while it runs. */
struct pupil_capture {
	char address[64];          /**< of its Pupil Remote, once started */
	int64_t period_ns;         /**< time between two samples */
	double skew;               /**< skew of its clock, no unit */
	_Atomic int64_t ahead_ns;  /**< its clock - host clock at the start */
	atomic_bool deaf;          /**< do not answer requests */
	atomic_bool mute;          /**< send nothing on the stream */
	atomic_bool garbage;       /**< send one bad message of each kind with every good one */
	atomic_bool monocular;     /**< send the right eye only */
	atomic_int skip;           /**< samples to skip, once */
	atomic_bool twice;         /**< send every message twice */
	const char *port_answer;   /**< answer to SUB_PORT; NULL: the true port */
	const char *latest_answer; /**< answer to LATEST_PORT, as of a gazed; NULL: none of that */
	/* Internal. */
	void *context, *control, *stream;
	int control_port, stream_port;
	int64_t begin_ns;
	uint64_t number;
	atomic_bool quit;
	pthread_t thread;
};

/** Bind and start; a second start uses the same port for Pupil Remote. Asserts. */
void pupil_capture_start(struct pupil_capture *capture);

/** Stop and close the sockets. Does nothing if it is not running. */
void pupil_capture_stop(struct pupil_capture *capture);

/** Its clock at host time @p host_ns, ns. */
int64_t pupil_capture_time_ns(const struct pupil_capture *capture, int64_t host_ns);

/** Gaze point of sample @p number, origin top left. */
void pupil_capture_point(uint64_t number, double out_xy[2]);

#endif
