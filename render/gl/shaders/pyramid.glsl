// The filters of the pyramid, docs/foveation.md: whole numbers, a byte a channel, the cpu backend's bits.
layout(location = 2) uniform uint level;
layout(location = 3) uniform uint bilinear;

ivec4 channels(uint point)
{
	return ivec4(uvec4(point, point >> 8, point >> 16, point >> 24) & 255U);
}

uint packed_point(ivec4 values)
{
	uvec4 bits = uvec4(values) << uvec4(0U, 8U, 16U, 24U);
	return bits.x | bits.y | bits.z | bits.w;
}

// Rounded up in odd rows and down in even ones.
uint mean_of_2(uint a, uint b, int row)
{
	return packed_point((channels(a) + channels(b) + row % 2) >> 1);
}

uint mean_of_4(uint a, uint b, uint c, uint d)
{
	return packed_point((channels(a) + channels(b) + channels(c) + channels(d) + 2) >> 2);
}

// Catmull-Rom halfway between b and c, never outside of them.
uint cubic(uint a, uint b, uint c, uint d)
{
	ivec4 from = channels(b), to = channels(c);
	ivec4 m = (from + to + 1) >> 1, n = (channels(a) + channels(d) + 1) >> 1;
	ivec4 value = m + ((m - n + 4 - 4 * ((from ^ to) & 1)) >> 3);
	return packed_point(clamp(value, min(from, to), max(from, to)));
}

int mirrored(int i, int count)
{
	int period = 2 * (count - 1);
	if (period == 0)
		return 0;
	i = abs(i) % period;
	return i < count ? i : period - i;
}

// A point of a lattice, mirrored beyond its rim.
uint point_of(uvec4 layer, ivec2 place)
{
	uint column = uint(mirrored(place.x, int(layer.y))), row = uint(mirrored(place.y, int(layer.z)));
	return points[layer.x + row * layer.y + column];
}
