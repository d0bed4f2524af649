/**
 * @file
 * Random numbers that give the same bits on every machine. They use only integer arithmetic, + - *
 * / and sqrt, and functions made of these (base/portable.h).
 */
#ifndef GZ_SIM_RANDOM_H
#define GZ_SIM_RANDOM_H

#include <stddef.h>
#include <stdint.h>

/** State of the generator xoshiro256**: Blackman and Vigna, "Scrambled linear pseudorandom number
 * generators", ACM Transactions on Mathematical Software 47(4), 2021, section 4.
 */
struct gz_random {
	uint64_t state[4];
};

/** A generator seeded by splitmix64 (Steele, Lea and Flood, OOPSLA 2014), as the authors of xoshiro
 * recommend. The streams of a seed are independent of each other. */
struct gz_random gz_random_seeded(uint64_t seed, uint64_t stream);

/** The next 64 random bits. */
uint64_t gz_random_bits(struct gz_random *random);

/** Uniform in [0, 1), a multiple of 2^-53. */
double gz_random_uniform(struct gz_random *random);

/** Uniform in [low, high). */
double gz_random_between(struct gz_random *random, double low, double high);

/** Normal with mean 0 and standard deviation 1, by Marsaglia's polar method (Marsaglia and Bray,
 * SIAM Review 6, 1964). */
double gz_random_normal(struct gz_random *random);

/** Exponential with mean 1. */
double gz_random_exponential(struct gz_random *random);

/** Gamma with mean 1 and the given shape, 1 or more: a sum of exponentials (Erlang). */
double gz_random_gamma(struct gz_random *random, int shape);

/** Shuffle @p count items of @p size bytes. All orders are equally likely (Fisher and Yates;
 * Durstenfeld, Communications of the ACM 7, 1964). */
void gz_random_shuffle(struct gz_random *random, void *items, size_t count, size_t size);

#endif
