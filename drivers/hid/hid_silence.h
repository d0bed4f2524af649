/**
 * @file
 * What a tracker that sends nothing while it sees no eye leaves unsaid. The class has no validity
 * usage and its producers leave invalid samples out, so silence is the sign of a blink; but the
 * pipeline, and a replay, live by sample times and hear nothing of silence.
 *
 * Therefore, once nothing has come for three sample periods, each missing sample is filled in with
 * one where nothing was measured, at its place in time and one period late at the earliest, so that
 * one that is merely late finds its place free. Where the link brings samples in bursts, the usual
 * gap between them is waited for as well. Fillers are samples like any other: numbered, judged,
 * recorded. Pure.
 */
#ifndef GZ_DRIVERS_HID_SILENCE_H
#define GZ_DRIVERS_HID_SILENCE_H

#include <stdbool.h>
#include <stdint.h>

/** So many periods without a sample are silence. */
#define GZ_HID_SILENCE_PERIODS 3

/** Zero-initialised is the start state: nothing is filled in before the first sample. */
struct gz_hid_silence {
	bool started;
	double nominal_ns; /**< period that the device states; 0 if it does not. Set by the owner */
	double measured_ns; /**< period from sample to sample */
	int steps;          /**< that measured_ns rests on */
	double gap_ns;      /**< longest usual time from arrival to arrival */
	int64_t host_ns;    /**< of the newest sample of the device */
	int64_t arrival_ns; /**< when it came */
	int64_t filled;     /**< fillers since then */
};

/** A sample came. */
void gz_hid_silence_sample(struct gz_hid_silence *silence, int64_t host_ns, int64_t arrival_ns);

/** When the next filler is due, host time; INT64_MAX before the first sample. */
int64_t gz_hid_silence_due_ns(const struct gz_hid_silence *silence);

/** Fill in the next one. @return its time */
int64_t gz_hid_silence_fill(struct gz_hid_silence *silence);

/** The sample period, ns: as measured; until enough is measured 1/30 s, or the stated one where
 * that is longer. */
double gz_hid_silence_period_ns(const struct gz_hid_silence *silence);

#endif
