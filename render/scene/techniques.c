#include "render/scene/techniques.h"

#include <stddef.h>

#include "render/raycast/raycast.h"

const struct gz_technique *const gz_techniques[] = { &gz_raycast_technique, NULL };

const char *const gz_technique_names[] = { "raycast", NULL };
