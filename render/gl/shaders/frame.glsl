// What every shader knows of the frame: struct gz_gl_frame_block of frame_block.h, and the points of all
// lattices, one after the other. The picture is the first width * height of them.
layout(std140, binding = 0) uniform Frame
{
	vec4 origin00, origin_dx, origin_dy;
	vec4 direction00, direction_dx, direction_dy;
	vec4 world_per_voxel;
	vec4 dims; // voxels
	vec4 box;  // its far corner: dims, but for a coarser level of an odd size
	vec4 clip_least, clip_greatest;
	vec4 cell_counts;
	vec4 background;
	vec4 transfer_map; // scale and bias from stored value to share of the table; light with which a ray ends
	vec4 light_towards; // unit vector in world directions; share of the ambient light that can be kept away
	vec4 light_terms;   // ambient, diffuse, specular, shininess
	vec4 gradient_scale;
	vec4 occlusion_scale, occlusion_bias, occlusion_last; // to places among its cells; greatest index
	uvec4 jitter; // seed, 0 = none; where the picture begins in the plan, px
	uvec4 plan; // layers, 1 for a pyramid, width, height
	vec4 steps[GZ_PLAN_STEPS_MAX];
	uvec4 layers[GZ_PLAN_LAYERS_MAX]; // first point, columns, rows, spacing
	vec4 region_places[GZ_PLAN_LAYERS_MAX]; // centre, half size, px
	vec4 region_fades[GZ_PLAN_LAYERS_MAX];  // by how much per radius, 0 = not; 1 for an ellipse
	uvec4 tile_points[TILE_POINTS];
	uvec4 brick_table; // number of the level's first brick; from one to the next along y, z
	vec4 brick_last;   // greatest number of a brick
	vec4 brick_scales[BRICK_LEVELS]; // voxels of another level along an edge of one of this
};

layout(std430, binding = 1) buffer Points
{
	uint points[]; // R, G, B, A from the lowest byte
};

// The same to read, as texels by FETCH_IMAGES: Mesa's processor reads a storage buffer lane by lane.
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
