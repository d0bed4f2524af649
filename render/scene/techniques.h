/**
 * @file
 * The table of techniques, in the order in which options name them. A new technique is one row
 * here.
 */
#ifndef GZ_RENDER_SCENE_TECHNIQUES_H
#define GZ_RENDER_SCENE_TECHNIQUES_H

#include "render/technique/technique.h"

/** All techniques, NULL-terminated; the first is the default. */
extern const struct gz_technique *const gz_techniques[];

/** The techniques' names in the same order, NULL-terminated. */
extern const char *const gz_technique_names[];

/** "auto", then the names. */
extern const char *const gz_technique_choices[];

#endif
