/**
 * @file
 * The outlet to the Lab Streaming Layer: a stream of gaze and a stream of events, which programs on
 * the network find and record.
 *
 * The thread that serves samples hands them over through a queue, without locking, waiting or
 * allocating; a thread of the outlet calls the library. What finds the queue full is counted and
 * dropped; what the library refuses is counted, too. Every function except gz_lsl_outlet_create()
 * accepts NULL, an outlet that is switched off, and does nothing.
 */
#ifndef GZ_DAEMON_LSL_OUTLET_H
#define GZ_DAEMON_LSL_OUTLET_H

#include <stdint.h>

#include "base/log.h"
#include "base/result.h"
#include "daemon/lsl/lsl_stream.h"
#include "filter/pipeline.h"
#include "protocol/gaze_log.h"

/** Samples and events that wait for the library. Chosen: 4 s at 2000 Hz, as the recorder's ring;
 * 5 MB, only while the outlet is on. A power of two. */
#define GZ_LSL_QUEUE 8192

/** How often the queue is emptied, ms. Chosen: readers have the time of each sample, so this is
 * only how much later they see it; waking the thread for each sample would cost a system call in
 * the thread that serves samples. */
#define GZ_LSL_DRAIN_MS 4

/** Longest text of an annotation with its NUL, bytes; longer ones are cut. */
#define GZ_LSL_TEXT_SIZE GZ_GAZE_LOG_TEXT_SIZE

/** An outlet. */
struct gz_lsl_outlet;

/**
 * Load the library and start the thread, which opens the stream of events. The stream of gaze opens
 * when a tracker is known. Call it once the signals that threads must not get are blocked: the
 * library starts threads.
 *
 * @param path  of the library, for gz_lsl_library_open()
 * @param name  of the stream of gaze; not empty
 * @param log   borrowed; may be NULL
 * @param[out] out_outlet  owned by the caller: gz_lsl_outlet_destroy()
 * @retval GZ_ERR_NO_MEM  no memory or no thread; logged
 * @return else as gz_lsl_library_open(); logged
 */
enum gz_result gz_lsl_outlet_create(const char *path, const char *name, const struct gz_log *log,
				    struct gz_lsl_outlet **out_outlet);

/*
 * Only the thread that serves samples may call the following three. None of them waits.
 */

/** The tracker whose gaze follows. If its description is new, the stream of gaze ends, and another
 * one begins. */
void gz_lsl_outlet_set_device(struct gz_lsl_outlet *outlet, const struct gz_lsl_device *device);

/** Send the gaze of a step of the pipeline, and its events. */
void gz_lsl_outlet_step(struct gz_lsl_outlet *outlet, const struct gz_pipeline_output *step);

/** Send an annotation of a client as an event. An empty label is ignored. */
void gz_lsl_outlet_annotate(struct gz_lsl_outlet *outlet, int64_t host_ns, const char *label);

/** Samples and events that were dropped, or that the library refused, so far. Threads: any. */
uint64_t gz_lsl_outlet_lost(const struct gz_lsl_outlet *outlet);

/** Send what waits, close the streams, end the thread, free and set to NULL. Accepts a pointer to
 * NULL. Threads: any, once no other thread uses the outlet. */
void gz_lsl_outlet_destroy(struct gz_lsl_outlet **outlet);

#endif
