/**
 * @file
 * The part of the window that runs an experiment: full screen, and nothing else is drawn or has
 * keys while it does (window->alone). Internal to view/.
 */
#ifndef GZ_VIEW_WINDOW_EXPERIMENT_H
#define GZ_VIEW_WINDOW_EXPERIMENT_H

#include "base/result.h"
#include "view/window/part.h"

/** The part; without --experiment it does nothing. */
extern const struct gz_window_part gz_window_experiment_part;

/** What the experiment has come to: GZ_OK without one and once all its trials are answered,
 *  GZ_ERR_CANCELLED where it was left, else why it ended; told. */
enum gz_result gz_window_experiment_outcome(struct gz_window *window);

#endif
