// What every shader knows of a plan: struct gz_gl_plan_block of gl_plan.h, and the points of all lattices of one
// plane, one after the other. The first width * height points are the plane's picture.
layout(std140, binding = 0) uniform Plan
{
	uvec4 plan;                             // layers, 1 for a pyramid, width, height
	uvec4 layers[GZ_PLAN_LAYERS_MAX];       // first point, columns, rows, spacing
	vec4 region_places[GZ_PLAN_LAYERS_MAX]; // centre, half size, px
	vec4 region_fades[GZ_PLAN_LAYERS_MAX];  // rise of the share per radius, 0 = no band; 1 for an ellipse
	uvec4 tile_points[TILE_POINTS];
};

layout(std430, binding = 1) buffer Points
{
	uint points[]; // a colour: R, G, B, A from the lowest byte
};

// Reads a point; with FETCH_IMAGES as a texel, since Mesa's software renderer reads a storage buffer lane by
// lane.
#ifdef FETCH_IMAGES
layout(binding = IMAGE_POINTS, r32ui) readonly uniform uimageBuffer point_texels;
#define POINT(index) imageLoad(point_texels, int(index)).r
#else
#define POINT(index) points[index]
#endif

// Tiles: the position of the first ray, 16 bits of x below 16 of y; layer in 3 bits, pattern in 2, level of
// detail in 3, step in 8, and a bit for each ray that is cast.
layout(std430, binding = 0) readonly buffer Tiles
{
	uvec2 tiles[];
};

layout(location = 0) uniform uint first_item; // of this dispatch
layout(location = 1) uniform uint item_end;

const uint TILE_RAYS = uint(GZ_TILE_EDGE * GZ_TILE_EDGE);

struct Tile {
	uvec2 at;
	uint layer, pattern, detail, step, active_rays;
};

Tile unpack_tile(uvec2 word)
{
	return Tile(uvec2(word.x & 0xFFFFU, word.x >> 16), word.y & 7U, word.y >> 3 & 3U,
		word.y >> 5 & 7U, word.y >> 8 & 255U, word.y >> 16);
}
