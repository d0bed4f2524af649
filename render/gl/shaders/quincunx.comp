// The points between those of quincunx tiles, from points 1 and 3 away along both axes of the same
// lattice.
layout(local_size_x = GROUP_SIZE) in;

uint along(uvec4 layer, ivec2 at, ivec2 axis)
{
	uint before = point_of(layer, at - axis), behind = point_of(layer, at + axis);
	if (bilinear != 0U)
		return mean_of_2(before, behind, 1);
	return cubic(point_of(layer, at - 3 * axis), before, behind, point_of(layer, at + 3 * axis));
}

uint between(uvec4 layer, ivec2 at)
{
	const ivec2 x = ivec2(1, 0), y = ivec2(0, 1);
	if (layer.y == 1U) // no neighbours along that axis
		return along(layer, at, y);
	if (layer.z == 1U)
		return along(layer, at, x);
	if (bilinear != 0U)
		return mean_of_4(point_of(layer, at - x), point_of(layer, at + x),
			point_of(layer, at - y), point_of(layer, at + y));
	return mean_of_2(along(layer, at, x), along(layer, at, y), at.y);
}

void main()
{
	uint index = first_item + gl_GlobalInvocationID.x / TILE_RAYS;
	if (index >= item_end)
		return;
	Tile tile = unpack_tile(tiles[index]);
	uvec4 layer = layers[level];
	uint ray = gl_LocalInvocationID.x % TILE_RAYS;
	uvec2 at = tile.at / layer.w + uvec2(0U, ray / uint(GZ_TILE_EDGE));
	at.x += 2U * (ray % uint(GZ_TILE_EDGE)) + (at.y % 2U == 0U ? 1U : 0U);
	if (at.x < layer.y && at.y < layer.z)
		points[layer.x + at.y * layer.y + at.x] = between(layer, ivec2(at));
}
