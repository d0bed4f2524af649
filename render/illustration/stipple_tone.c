#include "render/illustration/stipple_tone.h"

#include <math.h>
#include <stddef.h>

enum { RADII = 4, FACINGS = 5, TONES = 17 };

/* Ascending. Between rows of the table, radii are interpolated by their inverse. */
static const float radii[RADII] = { 0.5F, 1, 2.5F, 5 };
static const float facings[FACINGS] = { 0.1F, 0.2F, 0.4F, 0.7F, 1 };

/* For each radius and facing, the densities of ink 0, 1/16, ... 16/16 of GZ_STIPPLE_DARKEST. */
static const float densities[RADII][FACINGS][TONES] = {
	{
		/* radius 0.5 px */
		{ 0.000F, 0.061F, 0.123F, 0.184F, 0.246F, 0.310F, 0.375F, 0.442F, 0.513F, 0.586F,
		  0.666F, 0.752F, 0.847F, 0.964F, 1.104F, 1.300F, 1.699F },
		{ 0.000F, 0.061F, 0.122F, 0.184F, 0.245F, 0.307F, 0.370F, 0.434F, 0.500F, 0.569F,
		  0.641F, 0.719F, 0.803F, 0.896F, 1.015F, 1.171F, 1.485F },
		{ 0.000F, 0.061F, 0.122F, 0.184F, 0.245F, 0.306F, 0.367F, 0.429F, 0.492F, 0.555F,
		  0.620F, 0.689F, 0.762F, 0.844F, 0.940F, 1.072F, 1.328F },
		{ 0.000F, 0.061F, 0.122F, 0.184F, 0.245F, 0.306F, 0.367F, 0.428F, 0.490F, 0.552F,
		  0.615F, 0.681F, 0.751F, 0.829F, 0.922F, 1.044F, 1.281F },
		{ 0.000F, 0.061F, 0.122F, 0.184F, 0.245F, 0.306F, 0.367F, 0.428F, 0.490F, 0.551F,
		  0.614F, 0.680F, 0.750F, 0.828F, 0.921F, 1.041F, 1.282F },
	},
	{
		/* radius 1 px */
		{ 0.000F, 0.061F, 0.124F, 0.187F, 0.253F, 0.322F, 0.394F, 0.471F, 0.552F, 0.639F,
		  0.736F, 0.842F, 0.965F, 1.111F, 1.293F, 1.556F, 2.114F },
		{ 0.000F, 0.061F, 0.123F, 0.185F, 0.248F, 0.314F, 0.382F, 0.454F, 0.529F, 0.609F,
		  0.695F, 0.790F, 0.897F, 1.020F, 1.173F, 1.385F, 1.814F },
		{ 0.000F, 0.061F, 0.122F, 0.184F, 0.245F, 0.308F, 0.372F, 0.437F, 0.505F, 0.577F,
		  0.652F, 0.733F, 0.823F, 0.925F, 1.049F, 1.219F, 1.563F },
		{ 0.000F, 0.061F, 0.122F, 0.184F, 0.245F, 0.306F, 0.368F, 0.430F, 0.493F, 0.559F,
		  0.627F, 0.700F, 0.781F, 0.873F, 0.984F, 1.137F, 1.441F },
		{ 0.000F, 0.061F, 0.122F, 0.184F, 0.245F, 0.306F, 0.367F, 0.429F, 0.491F, 0.555F,
		  0.622F, 0.693F, 0.773F, 0.863F, 0.973F, 1.123F, 1.419F },
	},
	{
		/* radius 2.5 px */
		{ 0.000F, 0.061F, 0.124F, 0.189F, 0.257F, 0.329F, 0.406F, 0.488F, 0.577F, 0.675F,
		  0.783F, 0.907F, 1.051F, 1.226F, 1.451F, 1.782F, 2.500F },
		{ 0.000F, 0.061F, 0.123F, 0.185F, 0.250F, 0.318F, 0.390F, 0.466F, 0.547F, 0.635F,
		  0.732F, 0.840F, 0.965F, 1.113F, 1.300F, 1.567F, 2.129F },
		{ 0.000F, 0.061F, 0.123F, 0.184F, 0.246F, 0.309F, 0.374F, 0.442F, 0.514F, 0.590F,
		  0.673F, 0.764F, 0.867F, 0.986F, 1.135F, 1.345F, 1.784F },
		{ 0.000F, 0.061F, 0.123F, 0.184F, 0.245F, 0.306F, 0.368F, 0.431F, 0.496F, 0.564F,
		  0.636F, 0.715F, 0.803F, 0.907F, 1.036F, 1.218F, 1.589F },
		{ 0.000F, 0.061F, 0.123F, 0.184F, 0.245F, 0.306F, 0.367F, 0.429F, 0.492F, 0.558F,
		  0.628F, 0.704F, 0.790F, 0.890F, 1.016F, 1.189F, 1.541F },
	},
	{
		/* radius 5 px */
		{ 0.000F, 0.061F, 0.124F, 0.189F, 0.257F, 0.330F, 0.407F, 0.491F, 0.581F, 0.681F,
		  0.792F, 0.919F, 1.068F, 1.250F, 1.486F, 1.835F, 2.611F },
		{ 0.000F, 0.061F, 0.123F, 0.185F, 0.250F, 0.319F, 0.391F, 0.468F, 0.550F, 0.640F,
		  0.738F, 0.850F, 0.978F, 1.132F, 1.329F, 1.612F, 2.217F },
		{ 0.000F, 0.061F, 0.123F, 0.184F, 0.246F, 0.309F, 0.375F, 0.443F, 0.515F, 0.593F,
		  0.677F, 0.770F, 0.875F, 0.998F, 1.154F, 1.375F, 1.845F },
		{ 0.000F, 0.061F, 0.123F, 0.184F, 0.245F, 0.306F, 0.368F, 0.431F, 0.496F, 0.564F,
		  0.637F, 0.718F, 0.808F, 0.914F, 1.047F, 1.236F, 1.632F },
		{ 0.000F, 0.061F, 0.123F, 0.184F, 0.245F, 0.306F, 0.367F, 0.429F, 0.492F, 0.558F,
		  0.629F, 0.707F, 0.794F, 0.897F, 1.026F, 1.207F, 1.579F },
	},
};

/* A place between two entries of a table. */
struct table_place {
	size_t low;
	float share; /* of the next entry, [0, 1] */
};

static struct table_place place_of_ink(float ink)
{
	const float at = ink * ((TONES - 1) / GZ_STIPPLE_DARKEST);
	if (!(at > 0))
		return (struct table_place) { 0, 0 };
	if (at >= TONES - 1)
		return (struct table_place) { TONES - 2, 1 };
	return (struct table_place) { (size_t)at, at - (float)(size_t)at };
}

static struct table_place place_of_facing(float facing)
{
	size_t low = 0;
	while (low < FACINGS - 2 && facing > facings[low + 1])
		low++;
	const float share = (facing - facings[low]) / (facings[low + 1] - facings[low]);
	return (struct table_place) { low, share < 0 ? 0 : share > 1 ? 1 : share };
}

static struct table_place place_of_radius(float radius)
{
	size_t low = 0;
	while (low < RADII - 2 && radius > radii[low + 1])
		low++;
	const float share = (1 / radii[low] - 1 / radius) / (1 / radii[low] - 1 / radii[low + 1]);
	return (struct table_place) { low, share < 0 ? 0 : share > 1 ? 1 : share };
}

static float mix_of(float a, float b, float share)
{
	return a + share * (b - a);
}

static float density_of_facing(const float rows[FACINGS][TONES], struct table_place facing,
			       struct table_place ink)
{
	const float *below = rows[facing.low], *above = rows[facing.low + 1];
	return mix_of(mix_of(below[ink.low], below[ink.low + 1], ink.share),
		      mix_of(above[ink.low], above[ink.low + 1], ink.share), facing.share);
}

float gz_stipple_density(float ink, float facing, float radius)
{
	const struct table_place at_ink = place_of_ink(ink), at_facing = place_of_facing(facing);
	const struct table_place at_radius = place_of_radius(radius);
	return mix_of(density_of_facing(densities[at_radius.low], at_facing, at_ink),
		      density_of_facing(densities[at_radius.low + 1], at_facing, at_ink),
		      at_radius.share);
}

float gz_stipple_density_most(float ink, float facing)
{
	const struct table_place at = place_of_ink(ink);
	float most = 0;
	/* between two rows it is at most the denser one's at the upper end */
	for (int i = 0; i + 1 < FACINGS && (i == 0 || facings[i] < facing); i++) {
		float density = 0;
		for (int k = 0; k < 2 * RADII; k++) {
			const float *row = densities[k / 2][i + k % 2];
			density = fmaxf(density, mix_of(row[at.low], row[at.low + 1], at.share));
		}
		most = fmaxf(most, density * fminf(facings[i + 1], facing));
	}
	return most;
}
