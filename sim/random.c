#include "sim/random.h"

#include <math.h>

#include "base/portable.h"

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
