/** @file
 * Gradient noise for volumes made by a formula: + - * / alone, the same bits on every machine.
 */
#pragma once

/** Perlin's gradient noise at a point, about -1 to 1; coordinates within ±2³⁰. Perlin, "Improving
 * noise", SIGGRAPH 2002. */
double gz_noise(const double p[3]);
