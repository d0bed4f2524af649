/**
 * @file
 * When the device was done with each part of a frame. All calls need the context current.
 */
#ifndef GZ_RENDER_GL_GL_TIMER_H
#define GZ_RENDER_GL_GL_TIMER_H

#include <stdint.h>

#include "render/gl/gl_device.h"

/** Most marks of a frame. */
#define GZ_GL_MARKS_MAX 3

/** Zero-initialised has no marks. */
struct gz_gl_timer {
	unsigned queries[GZ_GL_MARKS_MAX]; /**< 0: none made yet */
	int64_t marks_ns[GZ_GL_MARKS_MAX]; /**< software */
};

/** Mark the moment at which all commands so far are done. Where a processor does the work, whose
 *  timestamps tell when commands were taken and not when they were done, it waits for them. */
void gz_gl_timer_mark(struct gz_gl_timer *timer, const struct gz_gl_device *device, int mark);

/** Milliseconds from mark @p from to mark @p to; waits until the device has passed both. */
double gz_gl_timer_ms(const struct gz_gl_timer *timer, const struct gz_gl_device *device, int from,
		      int to);

/** Delete the queries and zero the struct. */
void gz_gl_timer_free(struct gz_gl_timer *timer);

#endif
