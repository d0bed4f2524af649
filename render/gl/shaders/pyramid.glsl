// Means of points as the cpu backend takes them: a byte a channel, rounded to nearest.
uint mean_of_2(uint a, uint b)
{
	const uint even = 0x00FF00FFU;
	uint low = (a & even) + (b & even) + 0x00010001U;
	uint high = (a >> 8 & even) + (b >> 8 & even) + 0x00010001U;
	return (low >> 1 & even) | (high >> 1 & even) << 8;
}

uint mean_of_4(uint a, uint b, uint c, uint d)
{
	const uint even = 0x00FF00FFU;
	uint low = (a & even) + (b & even) + (c & even) + (d & even) + 0x00020002U;
	uint high = (a >> 8 & even) + (b >> 8 & even) + (c >> 8 & even) + (d >> 8 & even) + 0x00020002U;
	return (low >> 2 & even) | (high >> 2 & even) << 8;
}

uint point_of(uvec4 layer, uvec2 place)
{
	return points[layer.x + place.y * layer.y + place.x];
}
