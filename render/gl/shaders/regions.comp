// Pixels of a plan of regions: each from the first layer whose columns hold it, bilinearly in whole numbers
// as the cpu backend does. Which columns a layer has in a row, the cpu has found.
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

void main()
{
	uvec2 at = gl_GlobalInvocationID.xy + uvec2(0U, first_item);
	if (at.x >= plan.z || at.y >= plan.w)
		return;
	for (uint i = 0U; i < plan.x; i++) {
		uvec2 span = spans[i * plan.w + at.y];
		if (at.x < span.x || at.x >= span.y)
			continue;
		if (layers[i].x != 0U) // else it lies in the picture
			points[at.y * plan.z + at.x] = interpolated(layers[i], at);
		return;
	}
}
