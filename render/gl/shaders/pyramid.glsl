// The filters of the pyramid, docs/foveation.md: whole numbers, the cpu backend's bits. Points are opaque, so
// that three channels are all there is to them. Layer k of a pyramid has a spacing of 2^k.
layout(location = 2) uniform uint level;

ivec3 channels(uint point)
{
	return ivec3(uvec3(point, point >> 8, point >> 16) & 255U);
}

uint packed_point(ivec3 values)
{
	return uint(values.r) | uint(values.g) << 8 | uint(values.b) << 16 | 0xFF000000U;
}

// Rounded up in odd rows and down in even ones.
ivec3 mean_of_2(ivec3 a, ivec3 b, int row)
{
	return (a + b + (row & 1)) >> 1;
}

ivec3 mean_of_4(ivec3 a, ivec3 b, ivec3 c, ivec3 d)
{
	return (a + b + c + d + 2) >> 2;
}

// Catmull-Rom halfway between b and c, never outside of them.
ivec3 cubic(ivec3 a, ivec3 b, ivec3 c, ivec3 d)
{
	ivec3 m = (b + c + 1) >> 1, n = (a + d + 1) >> 1;
	ivec3 value = m + ((m - n + 4 - (((b ^ c) & 1) << 2)) >> 3);
	return clamp(value, min(b, c), max(b, c));
}

// Numbers up to three beyond either end of a count, mirrored about it: as often as a count of two takes.
ivec4 mirrored(ivec4 i, int count)
{
	int period = 2 * (count - 1);
	i = abs(i);
	i = min(i, abs(period - i));
	i = min(i, abs(period - i));
	return min(i, count - 1);
}

ivec3 point_of(uvec4 layer, int column, int row)
{
	return channels(POINT(layer.x + uint(row) * layer.y + uint(column)));
}

void set_point(uvec4 layer, ivec2 place, ivec3 values)
{
	if (place.x < int(layer.y) && place.y < int(layer.z))
		points[layer.x + uint(place.y) * layer.y + uint(place.x)] = packed_point(values);
}
