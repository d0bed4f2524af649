/**
 * @file
 * How surfaces look and which one a volume has: section [isosurface] of a scene.
 */
#ifndef GZ_RENDER_LIGHT_SURFACE_LOOK_H
#define GZ_RENDER_LIGHT_SURFACE_LOOK_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/option.h"

/** Greatest magnitude of an isovalue. Chosen: data in single precision lie below 3.5e38. */
#define GZ_ISOVALUE_MAX 1e30

/** Most voxels of a volume for GZ_SURFACE_VOXELS: rays read them by 31 bits. */
#define GZ_SURFACE_VOXELS_MAX ((size_t)INT32_MAX)

/** How rays meet the surface of a volume. */
enum gz_surface_source {
	GZ_SURFACE_TRIANGLES, /**< a mesh, made when the isovalue changes */
	GZ_SURFACE_VOXELS,    /**< each ray finds the surface in the data */
};

/** What surfaces are made of. */
enum gz_material {
	GZ_MATERIAL_MATTE, /**< opaque, lit as struct gz_light says */
	GZ_MATERIAL_GLASS, /**< reflects and refracts the surroundings: struct gz_environment */
};

/** The surface of a volume, and how surfaces look. The light is that of struct gz_light. */
struct gz_surface_look {
	double isovalue;  /**< data value of a volume's surface: slope and intercept applied */
	int source;       /**< enum gz_surface_source */
	double colour[3]; /**< [0, 1] each; of all surfaces. Of glass: what is left of white light
			     after one world unit */
	int material;     /**< enum gz_material */
	double refractive_index; /**< of glass; 1.333 is water */
	int bounces;             /**< surfaces of glass that a ray meets at most */
	bool shadows;            /**< what does not see the light has ambient light only */
};

/** How many of the table's first rows say which surface a volume has; the others how it looks. */
#define GZ_ISOVALUE_OPTIONS 1

/** Table over struct gz_surface_look: "isosurface.…". */
extern const struct gz_option gz_surface_look_options[];
extern const size_t gz_surface_look_option_count;

#endif
