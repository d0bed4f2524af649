// The points of one lattice of a pyramid that lie in coarser tiles, from the next coarser lattice. A
// work-group a tile.
layout(local_size_x = 8, local_size_y = 8) in;

layout(location = 2) uniform uint level;

uint filled(uvec4 coarse, uvec2 place)
{
	uvec2 half_place = place / 2U, odd = place % 2U;
	uint here = point_of(coarse, half_place);
	if (odd.x + odd.y == 0U)
		return here;
	if (odd.y == 0U)
		return mean_of_2(here, point_of(coarse, half_place + uvec2(1U, 0U)));
	uint below = point_of(coarse, half_place + uvec2(0U, 1U));
	if (odd.x == 0U)
		return mean_of_2(here, below);
	return mean_of_4(here, point_of(coarse, half_place + uvec2(1U, 0U)), below,
		point_of(coarse, half_place + uvec2(1U, 1U)));
}

void main()
{
	Tile tile = unpack_tile(tiles[first_item + gl_WorkGroupID.x]);
	uvec4 fine = layers[level], coarse = layers[level + 1U];
	uvec2 edges = uvec2(GZ_TILE_EDGE << (tile.layer - level));
	edges.x *= 1U + tile.pattern; // a quincunx tile is twice as wide as high
	uvec2 first = tile.at / fine.w, end = min(first + edges, fine.yz);
	for (uint y = first.y + gl_LocalInvocationID.y; y < end.y; y += gl_WorkGroupSize.y)
		for (uint x = first.x + gl_LocalInvocationID.x; x < end.x; x += gl_WorkGroupSize.x)
			points[fine.x + y * fine.y + x] = filled(coarse, uvec2(x, y));
}
