// Fills the points of one lattice of a pyramid that lie in coarser tiles, from the next coarser lattice: each of
// its points gives four. One work-group for each tile.
layout(local_size_x = 8, local_size_y = 4) in;

const ivec4 reach = ivec4(-1, 0, 1, 2); // of the filters, points

#ifdef BILINEAR
void fill(uvec4 fine, uvec4 coarse, ivec2 place)
{
	ivec4 columns = mirrored(place.x + reach, int(coarse.y)), rows = mirrored(place.y + reach, int(coarse.z));
	VALUES here = point_of(coarse, columns[1], rows[1]), right = point_of(coarse, columns[2], rows[1]);
	VALUES below = point_of(coarse, columns[1], rows[2]), across = point_of(coarse, columns[2], rows[2]);
	ivec2 at = 2 * place;
	set_point(fine, at, here);
	set_point(fine, at + ivec2(1, 0), mean_of_2(here, right, 0));
	set_point(fine, at + ivec2(0, 1), mean_of_2(here, below, 1));
	set_point(fine, at + ivec2(1, 1), mean_of_4(here, right, below, across));
}
#else
void fill(uvec4 fine, uvec4 coarse, ivec2 place)
{
	ivec4 columns = mirrored(place.x + reach, int(coarse.y)), rows = mirrored(place.y + reach, int(coarse.z));
	VALUES here[4], below[4]; // points of a row, and of the row halfway to the next
	for (int i = 0; i < 4; i++) {
		here[i] = point_of(coarse, columns[i], rows[1]);
		below[i] = cubic(point_of(coarse, columns[i], rows[0]), here[i],
			point_of(coarse, columns[i], rows[2]), point_of(coarse, columns[i], rows[3]));
	}
	ivec2 at = 2 * place;
	set_point(fine, at, here[1]);
	set_point(fine, at + ivec2(1, 0), cubic(here[0], here[1], here[2], here[3]));
	set_point(fine, at + ivec2(0, 1), below[1]);
	set_point(fine, at + ivec2(1, 1), cubic(below[0], below[1], below[2], below[3]));
}
#endif

void main()
{
	Tile tile = unpack_tile(tiles[first_item + gl_WorkGroupID.x]);
	uvec4 fine = layers[level], coarse = layers[level + 1U];
	uvec2 edges = uvec2(GZ_TILE_EDGE << (tile.layer - level - 1U));
	edges.x *= 1U + tile.pattern; // a quincunx tile is twice as wide as high
	uvec2 first = tile.at >> (level + 1U), end = min(first + edges, coarse.yz);
	for (uint y = first.y + gl_LocalInvocationID.y; y < end.y; y += gl_WorkGroupSize.y)
		for (uint x = first.x + gl_LocalInvocationID.x; x < end.x; x += gl_WorkGroupSize.x)
			fill(fine, coarse, ivec2(x, y));
}
