// Fills the pixels of a plan of regions: each bilinearly from the first layer whose columns hold it, and where that
// layer fades, also from those behind it. The host has found the columns of each layer in each row.
layout(local_size_x = 8, local_size_y = 8) in;

layout(std430, binding = 2) readonly buffer Spans
{
	uvec2 spans[]; // layer after layer, row after row: from, to
};

// Division rounded down: numbers up to 2^16 by a spacing, up to 2^17 by its square. A quotient that is no whole
// number is farther from one than floats err. Floats, because software divides whole numbers one by one.
uvec2 quotient(uvec2 number, uint by)
{
	return uvec2((vec2(number) + 0.5) / float(by));
}

uvec4 quotient(uvec4 number, uint by)
{
	return uvec4((vec4(number) + 0.5) / float(by));
}

#if defined(PLANE_VALUE) || defined(PLANE_ID)
// Mixes b, with a share in [0, 1], and a. If either has no value, the nearer counts.
uint mixed(uint a, uint b, float share)
{
#ifdef PLANE_VALUE
	float value = uintBitsToFloat(a) + (uintBitsToFloat(b) - uintBitsToFloat(a)) * share;
	if (!isinf(value) && !isnan(value))
		return floatBitsToUint(value);
#endif
	return share < 0.5 ? a : b;
}

uint interpolated(uvec4 layer, uvec2 at)
{
	uvec2 place = quotient(at, layer.w), next = min(place + 1U, layer.yz - 1U);
	vec2 along = vec2(at - place * layer.w) / float(layer.w);
	uvec2 rows = layer.x + uvec2(place.y, next.y) * layer.y;
	return mixed(mixed(POINT(rows.x + place.x), POINT(rows.x + next.x), along.x),
		mixed(POINT(rows.y + place.x), POINT(rows.y + next.x), along.x), along.y);
}

uint blend(uint a, uint b, uint weight)
{
	return mixed(b, a, float(weight) / 256.0);
}
#else
uint interpolated(uvec4 layer, uvec2 at)
{
	uint spacing = layer.w, area = spacing * spacing;
	uvec2 place = quotient(at, spacing), along = at - place * spacing;
	// Beyond the last row or column the weight is 0 and there may be no point.
	uvec2 next = min(place + 1U, layer.yz - 1U);
	uvec2 rows = layer.x + uvec2(place.y, next.y) * layer.y;
	uvec4 corners = uvec4(POINT(rows.x + place.x), POINT(rows.x + next.x), POINT(rows.y + place.x),
		POINT(rows.y + next.x));
	uvec2 back = spacing - along;
	uvec4 weights = uvec4(back.x * back.y, along.x * back.y, back.x * along.y, along.x * along.y);
	uvec4 sums = uvec4(area / 2U);
	for (int i = 0; i < 4; i++)
		sums += (uvec4(corners[i]) >> uvec4(0U, 8U, 16U, 24U) & 255U) * weights[i];
	uvec4 bytes = quotient(sums, area) << uvec4(0U, 8U, 16U, 24U);
	return bytes.x | bytes.y | bytes.z | bytes.w;
}

// The mean of two pixels; `weight` of 256 is that of the first.
uint blend(uint a, uint b, uint weight)
{
	const uint channels = 0x00FF00FFU, half_level = 0x00800080U;
	uint even = (a & channels) * weight + (b & channels) * (256U - weight) + half_level;
	uint odd = (a >> 8 & channels) * weight + (b >> 8 & channels) * (256U - weight) + half_level;
	return (even >> 8 & channels) | (odd & ~channels);
}
#endif

// Share of a layer in a pixel of its columns, 256 = 1: gz_region_weight() of render/plan/plan.h.
uint weight_of(uint layer, uvec2 at)
{
	vec4 place = region_places[layer];
	vec2 fade = region_fades[layer].xy; // how fast it fades, and whether the shape is an ellipse
	vec2 away = abs(vec2(at) - place.xy) / place.zw;
	float radius = fade.y > 0.0 ? length(away) : max(away.x, away.y);
	return fade.x > 0.0 ? uint(clamp((1.0 - radius) * fade.x, 0.0, 1.0) * 256.0 + 0.5) : 256U;
}

uint pixel_of(uint layer, uvec2 at)
{
	return layers[layer].x == 0U ? POINT(at.y * plan.z + at.x) : interpolated(layers[layer], at);
}

bool is_in(uint layer, uvec2 at)
{
	uvec2 span = spans[layer * plan.w + at.y];
	return at.x >= span.x && at.x < span.y;
}

void main()
{
	uvec2 at = gl_GlobalInvocationID.xy;
	if (at.x >= plan.z || at.y >= plan.w)
		return;
	uint last = 0U; // the first layer that hides all behind it
	while (last + 1U < plan.x && !(is_in(last, at) && weight_of(last, at) == 256U))
		last++;
	uint pixel = pixel_of(last, at);
	for (uint i = last; i-- > 0U;)
		if (is_in(i, at))
			pixel = blend(pixel_of(i, at), pixel, weight_of(i, at));
	points[at.y * plan.z + at.x] = pixel;
}
