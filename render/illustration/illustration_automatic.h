/**
 * @file
 * Combined settings that follow what each view shows, by little and without jumps: what Pfisterer
 * 2007 (section 3.3.6) asks of an automatic setting and leaves open. As that section proposes, what
 * is set stands for the aim and changes only within limits, and each frame begins with the values
 * of the last. Instead of a search for the best picture, which would make many of them, each
 * setting follows a measure of the picture that it governs:
 *
 *  - detail amplitude: more where tones hardly differ, less where they differ from place to place
 *    more than over wide forms, as on scans with steps;
 *  - detail frequency: to fine forms where only wide ones show, to wide ones where only fine ones
 * do;
 *  - edge emphasis: more where there are few outlines, less where there are so many that lines
 * would fill the surface;
 *  - spatial effect: more where what is seen reaches through much of the scene's depth;
 *  - foreground: up to the median of the depth that is seen, so that haze takes the farther half.
 *
 * Steps over a state, as those of render/attention/attention.h: the caller passes the time.
 */
#ifndef GZ_RENDER_ILLUSTRATION_ILLUSTRATION_AUTOMATIC_H
#define GZ_RENDER_ILLUSTRATION_ILLUSTRATION_AUTOMATIC_H

#include <stdbool.h>
#include <stdint.h>

#include "render/illustration/illustration_look.h"
#include "render/illustration/shading_measures.h"

/* Line width and the smoothing of main light change by whole steps, which would be seen as jumps:
 * the settings that they follow stay within one step of what is set. */

/** How far a setting goes from what is set, at most. Chosen: from medium to nearly an end. */
#define GZ_AUTOMATIC_MOST 0.4

/** How fast a setting moves at most, by second. Chosen: half of its range takes a second, which
 *  looks like a light that is turned up. */
#define GZ_AUTOMATIC_SPEED 0.5

/** What is added to the combined settings, each from -GZ_AUTOMATIC_MOST to GZ_AUTOMATIC_MOST.
 *  Zero-initialised: nothing. */
struct gz_illustration_change {
	double edge_emphasis, detail_amplitude, detail_frequency, spatial_effect, foreground;
};

/** The state; plain data. Zero-initialised is the start: nothing is changed. */
struct gz_illustration_automatic {
	struct gz_illustration_change change;
	int64_t now_ns; /**< of the newest step */
	bool started;   /**< there was a step */
	bool moving;    /**< the next step would change something by what is known now */
};

/** Whether both change the settings alike. */
bool gz_illustration_change_same(const struct gz_illustration_change *a,
				 const struct gz_illustration_change *b);

/** Whether each part of a change is within its limits. */
bool gz_illustration_change_valid(const struct gz_illustration_change *change);

/** Whether a look lets settings follow: it asks for it, shows the whole map, and combined settings
 *  count. */
bool gz_illustration_is_automatic(const struct gz_illustration_look *look);

/**
 * Advance by one frame.
 *
 * @param look      what is set; without gz_illustration_is_automatic() the state begins again
 * @param measures  of the last frame, which was made with the state's change; NULL: not known,
 *                  nothing changes
 * @param now_ns    any origin; a time before the last one counts as the last. Of a longer pause a
 *                  tenth of a second counts
 */
struct gz_illustration_automatic gz_illustration_automatic_step(
	struct gz_illustration_automatic state, const struct gz_illustration_look *look,
	const struct gz_shading_measures *measures, int64_t now_ns);

/** Change the combined settings of a look, with what its template replaces in their place. Objects'
 * own templates still count. Nothing happens without gz_illustration_is_automatic(). */
void gz_illustration_adapt(const struct gz_illustration_change *change,
			   struct gz_illustration_look *look);

#endif
