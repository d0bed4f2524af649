/**
 * @file
 * How dense discs must lie so that the drawing is as dark as wanted.
 *
 * A density is the discs' area for each area of the picture, overlaps counted twice. Discs at
 * random places would cover 1 - exp(-density) of the paper (the Boolean model; Serra, "Image
 * analysis and mathematical morphology", 1982). Those of mesh_points.h keep apart and cover more:
 * the density itself up to about 0.5. Where a surface is seen at an angle, its points move together
 * along one direction and cover less; discs of few pixels have soft rims, which add up to more. The
 * table of densities was measured over all three, on a square of 20000 points
 * (bench/probes/illustration_drawing.c).
 */
#ifndef GZ_RENDER_ILLUSTRATION_STIPPLE_TONE_H
#define GZ_RENDER_ILLUSTRATION_STIPPLE_TONE_H

/** Darkest mean of a drawing: a share of ink. Chosen: the last 2 % would take half as many discs
 *  again. */
#define GZ_STIPPLE_DARKEST 0.98F

/**
 * The density of discs that covers a share of the paper.
 *
 * @param ink     the share, [0, 1]; more than GZ_STIPPLE_DARKEST counts as that
 * @param facing  cosine of the angle between the surface's normal and the view, [0, 1]
 * @param radius  of the discs, px, above 0; rims are soft below 5
 * @return 0 or more; rises with @p ink
 */
float gz_stipple_density(float ink, float facing, float radius);

/** No less than gz_stipple_density() times the cosine, for any radius and for all inks and cosines
 * up to these. */
float gz_stipple_density_most(float ink, float facing);

#endif
