// The filters of the pyramid (docs/foveation.md). Colours are whole numbers and equal those of the cpu backend bit
// for bit; they are opaque, so three channels are enough
// where no depth is in the fourth. Layer k of a pyramid has spacing 2^k.
layout(location = 2) uniform uint level;

#if defined(PLANE_ID)
// Object ids do not mix: the first point, which is the nearest, stands for all.
#define VALUES uint

VALUES unpacked_point(uint point)
{
	return point;
}

uint packed_point(VALUES value)
{
	return value;
}

VALUES mean_of_2(VALUES a, VALUES b, int row)
{
	return a;
}

VALUES mean_of_4(VALUES a, VALUES b, VALUES c, VALUES d)
{
	return a;
}

VALUES cubic(VALUES a, VALUES b, VALUES c, VALUES d)
{
	return b;
}
#elif defined(PLANE_VALUE)
// If a point has no value, the nearer points count, then the first.
#define VALUES float

VALUES unpacked_point(uint point)
{
	return uintBitsToFloat(point);
}

uint packed_point(VALUES value)
{
	return floatBitsToUint(value);
}

bool is_number(float value)
{
	return !isinf(value) && !isnan(value);
}

VALUES mean_of_2(VALUES a, VALUES b, int row)
{
	float mean = 0.5 * (a + b);
	return is_number(mean) ? mean : a;
}

VALUES mean_of_4(VALUES a, VALUES b, VALUES c, VALUES d)
{
	float mean = 0.25 * (a + b + c + d);
	return is_number(mean) ? mean : a;
}

VALUES cubic(VALUES a, VALUES b, VALUES c, VALUES d)
{
	float value = (9.0 * (b + c) - (a + d)) / 16.0;
	return is_number(value) ? clamp(value, min(b, c), max(b, c)) : mean_of_2(b, c, 0);
}
#else
#ifdef PLANE_DEEP
#define VALUES ivec4

VALUES unpacked_point(uint point)
{
	return ivec4(uvec4(point, point >> 8, point >> 16, point >> 24) & 255U);
}

uint packed_point(VALUES values)
{
	return uint(values.r) | uint(values.g) << 8 | uint(values.b) << 16 | uint(values.a) << 24;
}
#else
#define VALUES ivec3

VALUES unpacked_point(uint point)
{
	return ivec3(uvec3(point, point >> 8, point >> 16) & 255U);
}

uint packed_point(VALUES values)
{
	return uint(values.r) | uint(values.g) << 8 | uint(values.b) << 16 | 0xFF000000U;
}
#endif

// Rounded up in odd rows and down in even ones.
VALUES mean_of_2(VALUES a, VALUES b, int row)
{
	return (a + b + (row & 1)) >> 1;
}

VALUES mean_of_4(VALUES a, VALUES b, VALUES c, VALUES d)
{
	return (a + b + c + d + 2) >> 2;
}

// Catmull-Rom halfway between b and c, clamped to [b, c].
VALUES cubic(VALUES a, VALUES b, VALUES c, VALUES d)
{
	VALUES m = (b + c + 1) >> 1, n = (a + d + 1) >> 1;
	VALUES value = m + ((m - n + 4 - (((b ^ c) & 1) << 2)) >> 3);
	return clamp(value, min(b, c), max(b, c));
}
#endif

// Mirrors indices up to three beyond either end of [0, count), as often as a count of two needs.
ivec4 mirrored(ivec4 i, int count)
{
	int period = 2 * (count - 1);
	i = abs(i);
	i = min(i, abs(period - i));
	i = min(i, abs(period - i));
	return min(i, count - 1);
}

VALUES point_of(uvec4 layer, int column, int row)
{
	return unpacked_point(POINT(layer.x + uint(row) * layer.y + uint(column)));
}

void set_point(uvec4 layer, ivec2 place, VALUES values)
{
	if (place.x < int(layer.y) && place.y < int(layer.z))
		points[layer.x + uint(place.y) * layer.y + uint(place.x)] = packed_point(values);
}
