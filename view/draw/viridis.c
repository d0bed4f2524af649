#include "view/draw/viridis.h"

#include <math.h>

void gz_viridis(double share, uint8_t out_rgb[3])
{
	static const uint8_t places[][3] = {
		{ 68, 1, 84 },    { 72, 40, 120 },  { 62, 74, 137 },  { 49, 104, 142 },
		{ 38, 130, 142 }, { 31, 158, 137 }, { 53, 183, 121 }, { 109, 205, 89 },
		{ 180, 222, 44 }, { 253, 231, 37 },
	};
	const int last = (int)(sizeof places / sizeof places[0]) - 1;
	const double at = last * fmin(1, fmax(0, share));
	const int from = at < last ? (int)at : last - 1;
	for (int i = 0; i < 3; i++)
		out_rgb[i] = (uint8_t)lround(places[from][i] +
					     (at - from) * (places[from + 1][i] - places[from][i]));
}
