/**
 * @file
 * Elementary functions that give the same bits on every machine. They use only + - * / and sqrt,
 * because the last bit of log or sin depends on the C library.
 */
#ifndef GZ_BASE_PORTABLE_H
#define GZ_BASE_PORTABLE_H

/** Natural logarithm of x > 0; relative error below 1e-14. */
double gz_portable_log(double x);

/** e to the power of x for |x| <= 700; relative error below 1e-14. */
double gz_portable_exp(double x);

/** Sine and cosine of an angle, radians, up to 1e6 either way; error below 1e-10. */
double gz_portable_sin(double angle);
double gz_portable_cos(double angle);

/** Angle of (x, y) from the x axis, radians, -pi to pi; error below 1e-12. 0 for (0, 0). */
double gz_portable_atan2(double y, double x);

#endif
