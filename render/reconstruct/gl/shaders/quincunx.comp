// Fills the points that quincunx tiles lack, from points 1 and 3 away along both axes of the same lattice.
layout(local_size_x = GROUP_SIZE) in;

const ivec4 reach = ivec4(-3, -1, 1, 3); // of the filters, points

VALUES between(uvec4 layer, ivec2 at)
{
	ivec4 columns = mirrored(at.x + reach, int(layer.y)), rows = mirrored(at.y + reach, int(layer.z));
	VALUES left = point_of(layer, columns[1], at.y), right = point_of(layer, columns[2], at.y);
	VALUES above = point_of(layer, at.x, rows[1]), below = point_of(layer, at.x, rows[2]);
#ifdef BILINEAR
	VALUES along_x = mean_of_2(left, right, 1), along_y = mean_of_2(above, below, 1);
	VALUES both = mean_of_4(left, right, above, below);
#else
	VALUES along_x = cubic(point_of(layer, columns[0], at.y), left, right, point_of(layer, columns[3], at.y));
	VALUES along_y = cubic(point_of(layer, at.x, rows[0]), above, below, point_of(layer, at.x, rows[3]));
	VALUES both = mean_of_2(along_x, along_y, at.y);
#endif
	// Along an axis of one point there are no neighbours.
	return layer.y == 1U ? along_y : layer.z == 1U ? along_x : both;
}

void main()
{
	uint index = first_item + gl_GlobalInvocationID.x / TILE_RAYS;
	if (index >= item_end)
		return;
	Tile tile = unpack_tile(tiles[index]);
	uvec4 layer = layers[level];
	uint ray = gl_LocalInvocationID.x % TILE_RAYS;
	uvec2 at = (tile.at >> level) + uvec2(0U, ray / uint(GZ_TILE_EDGE));
	at.x += 2U * (ray % uint(GZ_TILE_EDGE)) + (at.y % 2U == 0U ? 1U : 0U);
	if (at.x < layer.y && at.y < layer.z)
		set_point(layer, ivec2(at), between(layer, ivec2(at)));
}
