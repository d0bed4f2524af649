// The points of one lattice of a pyramid that lie in coarser tiles, from the next coarser lattice. A
// work-group a tile.
layout(local_size_x = 8, local_size_y = 8) in;

uint filled_bilinear(uvec4 coarse, ivec2 place)
{
	ivec2 half_place = place / 2, odd = place % 2;
	uint here = point_of(coarse, half_place);
	if (odd.x + odd.y == 0)
		return here;
	uint across = point_of(coarse, half_place + odd);
	if (odd.x + odd.y == 1)
		return mean_of_2(here, across, odd.y);
	return mean_of_4(here, point_of(coarse, half_place + ivec2(1, 0)),
		point_of(coarse, half_place + ivec2(0, 1)), across);
}

// Below a place of a coarse row: halfway to the next.
uint between_rows(uvec4 coarse, ivec2 place)
{
	return cubic(point_of(coarse, place - ivec2(0, 1)), point_of(coarse, place),
		point_of(coarse, place + ivec2(0, 1)), point_of(coarse, place + ivec2(0, 2)));
}

uint filled_cubic(uvec4 coarse, ivec2 place)
{
	ivec2 half_place = place / 2, odd = place % 2;
	uint row[4];
	for (int i = odd.x == 0 ? 1 : 0; i < (odd.x == 0 ? 2 : 4); i++) {
		ivec2 at = half_place + ivec2(i - 1, 0);
		row[i] = odd.y == 0 ? point_of(coarse, at) : between_rows(coarse, at);
	}
	return odd.x == 0 ? row[1] : cubic(row[0], row[1], row[2], row[3]);
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
			points[fine.x + y * fine.y + x] = bilinear != 0U
				? filled_bilinear(coarse, ivec2(x, y))
				: filled_cubic(coarse, ivec2(x, y));
}
