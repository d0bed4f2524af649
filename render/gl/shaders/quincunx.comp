// The points between those of quincunx tiles, from their four neighbours in the same lattice.
layout(local_size_x = GROUP_SIZE) in;

layout(location = 2) uniform uint level;

// On the rim only some neighbours are there: opposite ones, where there are.
uint mean_around(uvec4 layer, uvec2 at)
{
	bool left = at.x > 0U, right = at.x + 1U < layer.y;
	bool above = at.y > 0U, below = at.y + 1U < layer.z;
	uint west = left ? point_of(layer, at - uvec2(1U, 0U)) : 0U;
	uint east = right ? point_of(layer, at + uvec2(1U, 0U)) : 0U;
	uint north = above ? point_of(layer, at - uvec2(0U, 1U)) : 0U;
	uint south = below ? point_of(layer, at + uvec2(0U, 1U)) : 0U;
	if (left && right && above && below)
		return mean_of_4(west, east, north, south);
	if (left && right)
		return mean_of_2(west, east);
	if (above && below)
		return mean_of_2(north, south);
	if (left || right)
		return left ? west : east;
	return above ? north : south;
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
		points[layer.x + at.y * layer.y + at.x] = mean_around(layer, at);
}
