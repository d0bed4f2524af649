#include "sim/random.h"

#include <math.h>

static const double LN2_HIGH = 6.93147180369123816490e-01; /* ln 2 with the low 32 bits clear */
static const double LN2_LOW = 1.90821492927058770002e-10;  /* ln 2 less LN2_HIGH */
static const double PI = 3.14159265358979323846;
static const double HALF_PI_HIGH = 1.57079632673412561417; /* pi / 2 with the low 20 bits clear */
static const double HALF_PI_LOW = 6.07710050650619224932e-11;

static uint64_t splitmix64(uint64_t *state)
{
	uint64_t z = (*state += UINT64_C(0x9e3779b97f4a7c15));
	z = (z ^ (z >> 30)) * UINT64_C(0xbf58476d1ce4e5b9);
	z = (z ^ (z >> 27)) * UINT64_C(0x94d049bb133111eb);
	return z ^ (z >> 31);
}

struct gz_random gz_random_seeded(uint64_t seed, uint64_t stream)
{
	uint64_t stream_state = stream;
	uint64_t state = seed ^ splitmix64(&stream_state);
	struct gz_random random;
	for (int i = 0; i < 4; i++)
		random.state[i] = splitmix64(&state);
	return random;
}

static uint64_t rotate_left(uint64_t x, int bits)
{
	return (x << bits) | (x >> (64 - bits));
}

uint64_t gz_random_bits(struct gz_random *random)
{
	uint64_t *s = random->state;
	uint64_t result = rotate_left(s[1] * 5, 7) * 9;
	uint64_t shifted = s[1] << 17;
	s[2] ^= s[0];
	s[3] ^= s[1];
	s[1] ^= s[2];
	s[0] ^= s[3];
	s[2] ^= shifted;
	s[3] = rotate_left(s[3], 45);
	return result;
}

double gz_random_uniform(struct gz_random *random)
{
	return (double)(gz_random_bits(random) >> 11) * 0x1p-53;
}

double gz_random_between(struct gz_random *random, double low, double high)
{
	return low + (high - low) * gz_random_uniform(random);
}

double gz_random_normal(struct gz_random *random)
{
	for (;;) {
		double u = gz_random_between(random, -1, 1);
		double v = gz_random_between(random, -1, 1);
		double square = u * u + v * v;
		if (square > 0 && square < 1)
			return u * sqrt(-2 * gz_portable_log(square) / square);
	}
}

double gz_random_exponential(struct gz_random *random)
{
	return -gz_portable_log(1 - gz_random_uniform(random));
}

double gz_random_gamma(struct gz_random *random, int shape)
{
	double sum = 0;
	for (int i = 0; i < shape; i++)
		sum += gz_random_exponential(random);
	return sum / shape;
}

void gz_random_shuffle(struct gz_random *random, void *items, size_t count, size_t size)
{
	unsigned char *bytes = items;
	for (size_t i = count; i > 1; i--) {
		unsigned char *last = bytes + (i - 1) * size;
		unsigned char *chosen =
			bytes + (size_t)(gz_random_uniform(random) * (double)i) * size;
		for (size_t k = 0; k < size; k++) {
			const unsigned char kept = last[k];
			last[k] = chosen[k];
			chosen[k] = kept;
		}
	}
}

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
	for (int n = 17; n >= 1; n--)
		sum = 1 + sum * r / n;
	return ldexp(sum, (int)k);
}

/** Taylor series of sine (first = 1) or cosine (first = 0) for |r| <= pi / 4. */
static double sine_series(double r, int first)
{
	double sum = 1;
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
	double value = sine_series(r, quadrant & 1 ? 0 : 1);
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
