// Joins layers into the picture: each pixel is mixed from the coarsest layer to the finest, by the share of each.
layout(location = BACKGROUND) uniform vec3 background;

layout(binding = UNIT_LAYERS) uniform sampler2D layers[GZ_PLAN_LAYERS_MAX];

// Between the four points around a pixel.
vec4 interpolated(int layer, ivec2 pixel)
{
	ivec2 offset = pixel - lattices[layer].xy, place = offset / lattices[layer].z;
	ivec2 next = min(place + 1, points[layer] - 1);
	vec2 along = vec2(offset - place * lattices[layer].z) / float(lattices[layer].z);
	vec4 upper = mix(texelFetch(layers[layer], place, 0),
		texelFetch(layers[layer], ivec2(next.x, place.y), 0), along.x);
	vec4 lower = mix(texelFetch(layers[layer], ivec2(place.x, next.y), 0),
		texelFetch(layers[layer], next, 0), along.x);
	return mix(upper, lower, along.y);
}

void main()
{
	ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
	if (pixel.x >= picture.y || pixel.y >= picture.z)
		return;
	vec4 sum = vec4(0.0);
	for (int layer = 0; layer < picture.x; layer++) {
		float share = share_of(layer, pixel);
		if (share > 0.0)
			sum = share < 1.0 ? mix(sum, interpolated(layer, pixel), share) : interpolated(layer, pixel);
	}
	vec3 colour = fma(vec3(1.0 - sum.a), background, sum.rgb);
	uvec3 bytes = uvec3(fma(clamp(colour, 0.0, 1.0), vec3(255.0), vec3(0.5)));
	pixels[pixel.y * picture.y + pixel.x] = bytes.r | bytes.g << 8 | bytes.b << 16 | 0xFF000000U;
}
