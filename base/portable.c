#include "base/portable.h"

#include <math.h>
#include <stdint.h>

static const double LN2_HIGH = 6.93147180369123816490e-01; /* ln 2 with the low 32 bits clear */
static const double LN2_LOW = 1.90821492927058770002e-10;  /* ln 2 less LN2_HIGH */
static const double PI = 3.14159265358979323846;
static const double HALF_PI_HIGH = 1.57079632673412561417; /* pi / 2 with the low 20 bits clear */
static const double HALF_PI_LOW = 6.07710050650619224932e-11;

double gz_portable_log(double x)
{
	/* x = m 2^e with m near 1; log m = 2 artanh((m - 1) / (m + 1)), a series in odd powers. */
	int exponent;
	double m = frexp(x, &exponent);
	if (m < 0.70710678118654752440) {
		m *= 2;
		exponent--;
	}
	double s = (m - 1) / (m + 1);
	double square = s * s, sum = 0;
	/* Unrolled, the factors of the series are constants. */
#pragma GCC unroll 14
	for (int k = 27; k >= 1; k -= 2)
		sum = sum * square + 1.0 / k;
	return exponent * LN2_HIGH + (exponent * LN2_LOW + 2 * s * sum);
}

double gz_portable_exp(double x)
{
	/* x = k ln 2 + r; e^r by its Taylor series. */
	double k = floor(x / (LN2_HIGH + LN2_LOW) + 0.5);
	double r = (x - k * LN2_HIGH) - k * LN2_LOW;
	double sum = 1;
#pragma GCC unroll 17
	for (int n = 17; n >= 1; n--)
		sum = 1 + sum * r / n;
	return ldexp(sum, (int)k);
}

/** Taylor series of sine (first = 1) or cosine (first = 0) for |r| <= pi / 4. */
static inline double sine_series(double r, int first)
{
	double sum = 1;
#pragma GCC unroll 9
	for (int n = 18 + first; n > first; n -= 2)
		sum = 1 - sum * r * r / ((double)n * (n - 1));
	return first ? sum * r : sum;
}

/** Sine of angle + quarter_turns * pi / 2. */
static double sine_shifted(double angle, int quarter_turns)
{
	double k = floor(angle / (HALF_PI_HIGH + HALF_PI_LOW) + 0.5);
	double r = (angle - k * HALF_PI_HIGH) - k * HALF_PI_LOW;
	int quadrant = (int)((int64_t)k + quarter_turns) & 3;
	double value = quadrant & 1 ? sine_series(r, 0) : sine_series(r, 1);
	return quadrant & 2 ? -value : value;
}

double gz_portable_sin(double angle)
{
	return sine_shifted(angle, 0);
}

double gz_portable_cos(double angle)
{
	return sine_shifted(angle, 1);
}

/** Arc tangent of 0 <= t <= 1: the half-angle rule twice, then the series. */
static double arc_tangent(double t)
{
	for (int i = 0; i < 2; i++)
		t /= 1 + sqrt(1 + t * t);
	double square = t * t, sum = 0;
#pragma GCC unroll 14
	for (int k = 27; k >= 1; k -= 2)
		sum = 1.0 / k - sum * square;
	return 4 * t * sum;
}

double gz_portable_atan2(double y, double x)
{
	double ax = fabs(x), ay = fabs(y);
	if (ax == 0 && ay == 0)
		return 0;
	double angle = ay <= ax ? arc_tangent(ay / ax) : PI / 2 - arc_tangent(ax / ay);
	if (x < 0)
		angle = PI - angle;
	return y < 0 ? -angle : angle;
}
