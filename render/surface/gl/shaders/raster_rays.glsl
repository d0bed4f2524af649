// The rays of pixels, by the vectors of a block before this.
vec3 origin_of(vec2 pixel)
{
	return fma(vec3(pixel.y), origin_dy.xyz, fma(vec3(pixel.x), origin_dx.xyz, origin00.xyz));
}

vec3 direction_of(vec2 pixel)
{
	return normalize(
		fma(vec3(pixel.y), direction_dy.xyz, fma(vec3(pixel.x), direction_dx.xyz, direction00.xyz)));
}
