/**
 * @file
 * Constants of illustrations, shared by C and shaders: this file is put in front of every shader
 * that needs it. It may hold only comments and #defines that mean the same in C and in GLSL 4.30:
 * whole numbers and single-precision numbers with F.
 */
#ifndef GZ_RENDER_ILLUSTRATION_SHADING_CONSTANTS_H
#define GZ_RENDER_ILLUSTRATION_SHADING_CONSTANTS_H

/** Levels of normals that meshes have (shading_vertices.h): the surface's own and five smoothed
 * ones. Chosen: the last has spread over about six edges, wider than the details of a scan. */
#define GZ_SHADING_LEVELS 6

/** Share of light from all around under a plain lamp. Chosen: shaded sides stay visible. */
#define GZ_SHADING_PLAIN_AMBIENT 0.2F

/** Squared length of light in a tangent plane up to which it counts as falling along the normal:
 *  rounding leaves about 1e-7 of its length. */
#define GZ_SHADING_GRAZES_NOT 1e-10F

/** Squared length up to which interpolated unit normals have cancelled out. Chosen: the rounding of
 *  packed ones leaves less. */
#define GZ_SHADING_NO_NORMAL 1e-8F

/** Most layers of surfaces behind each other that show. Chosen: more cannot be told apart. */
#define GZ_ILLUSTRATE_LAYERS_MAX 4

/** By how much of its depth, at least, the next layer lies behind a surface: 2^-18. Chosen: Embree
 *  finds places to some 2^-22 of it, and thinner layers cannot be seen. */
#define GZ_ILLUSTRATE_ONWARD 3.8146973e-6F
/** And at least by so much, or a ray that begins on a surface would stay there. */
#define GZ_ILLUSTRATE_ONWARD_LEAST_MM 1e-6F

#endif
