#include "render/scene/techniques.h"

#include <stddef.h>

#include "render/illustration/technique/illustrate_technique.h"
#include "render/raycast/raycast.h"
#include "render/slices/slices_technique.h"
#include "render/surface/isosurface_technique.h"

const struct gz_technique *const gz_techniques[] = {
	&gz_raycast_technique,
	&gz_isosurface_technique,
	&gz_slices_technique,
	&gz_illustrate_technique,
	NULL,
};

const char *const gz_technique_choices[] = { "auto",   "raycast",    "isosurface",
					     "slices", "illustrate", NULL };

const char *const gz_technique_names[] = { "raycast", "isosurface", "slices", "illustrate", NULL };
