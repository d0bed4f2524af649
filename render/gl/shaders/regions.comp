// Pixels of a plan of regions: each from the first layer whose columns hold it, bilinearly, and where that one
// fades, from those behind it. Which columns a layer has in a row, the cpu has found.
layout(local_size_x = 8, local_size_y = 8) in;

layout(std430, binding = 3) readonly buffer Spans
{
	uvec2 spans[]; // layer after layer, row after row: from, to
};

uint interpolated(uvec4 layer, uvec2 at)
{
	uint spacing = layer.w, area = spacing * spacing;
	uvec2 place = at / spacing, along = at % spacing;
	// On the last row or column the next has no weight and may not exist.
	uvec2 next = min(place + 1U, layer.yz - 1U);
	uvec4 corners = uvec4(points[layer.x + place.y * layer.y + place.x],
		points[layer.x + place.y * layer.y + next.x], points[layer.x + next.y * layer.y + place.x],
		points[layer.x + next.y * layer.y + next.x]);
	uvec2 back = spacing - along;
	uvec4 weights = uvec4(back.x * back.y, along.x * back.y, back.x * along.y, along.x * along.y);
	uint pixel = 0U;
	for (int shift = 0; shift < 32; shift += 8) {
		uvec4 channel = (corners >> shift & 255U) * weights;
		uint sum = channel.x + channel.y + channel.z + channel.w;
		pixel |= (sum + area / 2U) / area << shift;
	}
	return pixel;
}

// Share of a layer in a pixel of its columns, of 256: gz_region_weight() of render/plan/plan.h.
uint weight_of(uint layer, uvec2 at)
{
	vec4 place = region_places[layer];
	vec2 fade = region_fades[layer].xy; // how fast it fades, and whether the shape is an ellipse
	vec2 away = abs(vec2(at) - place.xy) / place.zw;
	float radius = fade.y > 0.0 ? length(away) : max(away.x, away.y);
	return fade.x > 0.0 ? uint(clamp((1.0 - radius) * fade.x, 0.0, 1.0) * 256.0 + 0.5) : 256U;
}

// Mean of two pixels, the first with `weight` of 256.
uint blend(uint a, uint b, uint weight)
{
	const uint channels = 0x00FF00FFU, half_level = 0x00800080U;
	uint even = (a & channels) * weight + (b & channels) * (256U - weight) + half_level;
	uint odd = (a >> 8 & channels) * weight + (b >> 8 & channels) * (256U - weight) + half_level;
	return (even >> 8 & channels) | (odd & ~channels);
}

uint pixel_of(uint layer, uvec2 at)
{
	return layers[layer].x == 0U ? points[at.y * plan.z + at.x] : interpolated(layers[layer], at);
}

void main()
{
	uvec2 at = gl_GlobalInvocationID.xy;
	if (at.x >= plan.z || at.y >= plan.w)
		return;
	uint pixels[GZ_PLAN_LAYERS_MAX], weights[GZ_PLAN_LAYERS_MAX], count = 0U;
	for (uint i = 0U; i < plan.x; i++) {
		uvec2 span = spans[i * plan.w + at.y];
		if (at.x < span.x || at.x >= span.y)
			continue;
		pixels[count] = pixel_of(i, at);
		weights[count] = weight_of(i, at);
		count++;
		if (weights[count - 1U] == 256U)
			break;
	}
	uint pixel = pixels[count - 1U];
	for (uint i = count - 1U; i > 0U; i--)
		pixel = blend(pixels[i - 1U], pixel, weights[i - 1U]);
	points[at.y * plan.z + at.x] = pixel;
}
