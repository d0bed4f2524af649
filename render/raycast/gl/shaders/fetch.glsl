// From a place in voxel coordinates to the value there and its entry in the transfer function. Weights are
// full floats: those of a sampler have 8 bits, and the difference from the cpu backend would be visible.
//
// A texel has 32 bits, which every GPU fetches at its full rate: one float, or a 16-bit voxel and its neighbour
// along x, or an 8-bit voxel and its neighbours along x, y and both. So a sample takes 8, 4 or 2 fetches.
// SINGLE: one voxel of its own size, 8 fetches, if there is no room for more. BRICKS: single voxels in the rooms
// of an atlas, where a table says which brick, of this level of detail or a coarser one, holds a place.
//
// With FETCH_IMAGES the words are read as images instead of textures, which saves Mesa's software renderer the
// arithmetic of mipmaps that do not exist.
#ifdef FETCH_IMAGES
#define FETCH(from, place) imageLoad(from, place)
#if VOXEL_BITS == 32
layout(binding = 0, r32f) readonly uniform image3D voxels;
#elif defined(SINGLE) && VOXEL_BITS == 8
layout(binding = 0, r8ui) readonly uniform uimage3D voxels;
#elif defined(SINGLE)
layout(binding = 0, r16ui) readonly uniform uimage3D voxels;
#else
layout(binding = 0, r32ui) readonly uniform uimage3D voxels;
#endif
layout(binding = 1, r8ui) readonly uniform uimage3D reaches;
layout(binding = 2, rg32ui) readonly uniform uimage2D transfer;
layout(binding = 3, rg32ui) readonly uniform uimage2DArray segments;
#else
#define FETCH(from, place) texelFetch(from, place, 0)
#if VOXEL_BITS == 32
layout(binding = 0) uniform sampler3D voxels;
#else
layout(binding = 0) uniform usampler3D voxels;
#endif
layout(binding = 1) uniform usampler3D reaches;   // by macrocell
// Opacity or extinction as bits, colour; one row for each step, one of extinction, and NEXT_VISIBLE_ROW.
layout(binding = 2) uniform usampler2D transfer;
// Tables of segments, by the cells at their ends; one layer for each step.
layout(binding = 3) uniform usampler2DArray segments;
#endif

// What every sample needs of the frame, computed once for each ray: software reads a uniform block lane by lane,
// and compilers replace a mere copy by the block itself, so each of these is a computed value.
vec3 top_voxel;    // greatest index
ivec3 lower_voxel; // greatest index of the lower of two neighbours
vec3 top_cell;
vec2 entry_map;    // scale and bias from stored value to entry and a half
#ifdef FINE_TABLE
float last_entry;  // more than GZ_TRANSFER_TABLE_SIZE - 1
#endif

void read_frame()
{
	top_voxel = dims.xyz - 1.0;
	lower_voxel = max(ivec3(dims.xyz) - 2, 0);
	top_cell = cell_counts.xyz - 1.0;
#ifdef FINE_TABLE
	last_entry = transfer_map.w + 0.0;
	entry_map = transfer_map.xy * last_entry + vec2(0.0, 0.5);
#else
	entry_map = transfer_map.xy * float(GZ_TRANSFER_TABLE_SIZE - 1) + vec2(0.0, 0.5);
#endif
}

#ifdef BRICKS
layout(std430, binding = 4) readonly buffer Bricks
{
	uint bricks[]; // by number: level in the lowest bits, then the room's place along x, y and z
};

// Finds the brick over a place: its first texel, and the place in it counted from its first datum, 1/2 to 32 1/2.
// find_bricks() of render/raycast/cpu/cast_fetch.h does this for the cpu backend.
vec3 find_brick(vec3 at, out ivec3 first)
{
	vec3 brick = floor(clamp(at * (1.0 / float(BRICK_EDGE)), vec3(0.0), brick_last.xyz));
	uvec3 number = uvec3(brick);
	uint entry = bricks[brick_table.x + number.x + number.y * brick_table.y + number.z * brick_table.z];
	const uint mask = (1U << BRICK_PLACE_BITS) - 1U;
	uint room = entry >> BRICK_LEVEL_BITS;
	first = ivec3(room & mask, room >> BRICK_PLACE_BITS & mask, room >> 2 * BRICK_PLACE_BITS) *
		BRICK_STORED_EDGE;
	vec3 scale = brick_scales[entry & ((1U << BRICK_LEVEL_BITS) - 1U)].xyz;
	return at * scale - floor(brick * scale) * float(BRICK_EDGE) + 0.5;
}
#endif

#ifdef NEAREST
float sample_at(vec3 at)
{
#ifdef BRICKS
	ivec3 first;
	vec3 inside = find_brick(at, first) + 0.5;
	ivec3 place = first + ivec3(clamp(inside, vec3(0.0), vec3(BRICK_STORED_EDGE - 1)));
#else
	ivec3 place = ivec3(clamp(floor(at), vec3(0.0), top_voxel));
#endif
#if VOXEL_BITS == 32 || defined(SINGLE)
	return float(FETCH(voxels, place).r);
#else
	return float(FETCH(voxels, place).r & ((1U << VOXEL_BITS) - 1U));
#endif
}
#else
// The four voxels of a square: at (x, y), (x + 1, y), (x, y + 1), (x + 1, y + 1).
vec4 square(ivec3 low, int high_x, int high_y)
{
#if VOXEL_BITS == 32 || defined(SINGLE)
	return vec4(FETCH(voxels, low).r, FETCH(voxels, ivec3(high_x, low.y, low.z)).r,
		FETCH(voxels, ivec3(low.x, high_y, low.z)).r,
		FETCH(voxels, ivec3(high_x, high_y, low.z)).r);
#elif VOXEL_BITS == 8
	uint texel = FETCH(voxels, low).r;
	return vec4(uvec4(texel, texel >> 8, texel >> 16, texel >> 24) & 255U);
#else
	uvec2 rows = uvec2(FETCH(voxels, low).r, FETCH(voxels, ivec3(low.x, high_y, low.z)).r);
	return vec4(rows.x & 0xFFFFU, rows.x >> 16, rows.y & 0xFFFFU, rows.y >> 16);
#endif
}

float sample_at(vec3 at)
{
#ifdef BRICKS
	ivec3 first;
	vec3 place = max(find_brick(at, first), vec3(0.0));
	ivec3 low = min(ivec3(place), ivec3(BRICK_STORED_EDGE - 2));
	vec3 share = min(place - vec3(low), vec3(1.0));
	low += first;
	ivec3 high = low + 1;
#else
	vec3 place = clamp(at - 0.5, vec3(0.0), top_voxel);
	ivec3 low = min(ivec3(place), lower_voxel);
	ivec3 high = min(low + 1, ivec3(top_voxel));
	vec3 share = place - vec3(low);
#endif
	vec4 near = square(low, high.x, high.y);
	vec4 far = square(ivec3(low.xy, high.z), high.x, high.y);
	vec4 plane = fma(vec4(share.z), far - near, near);
	vec2 row = fma(vec2(share.y), plane.zw - plane.xy, plane.xy);
	return fma(share.x, row.y - row.x, row.x);
}
#endif

#ifdef COLOURED
layout(binding = 5) uniform usampler3D colours; // gz_colour_pack() of render/data/voxel_colour.h

// Red, green and blue of a voxel by its weight, and the weight, times a share.
vec4 weighted_colour(ivec3 place, float share)
{
	uint word = texelFetch(colours, place, 0).r;
	float weight = share * (float(word >> 24) + 1.0 / float(COLOUR_WEIGHT_SHARE));
	return weight * vec4(uvec3(word, word >> 8, word >> 16) & 255U, 1.0);
}

// The colour of the voxels at a place, in the units of unpack_colour().
vec3 own_colour(vec3 at)
{
#ifdef NEAREST
	vec4 sum = weighted_colour(ivec3(clamp(floor(at), vec3(0.0), top_voxel)), 1.0);
#else
	vec3 place = clamp(at - 0.5, vec3(0.0), top_voxel);
	ivec3 low = min(ivec3(place), lower_voxel);
	ivec3 high = min(low + 1, ivec3(top_voxel));
	vec3 share = place - vec3(low);
	vec4 sum = vec4(0.0);
	for (int corner = 0; corner < 8; corner++) {
		bvec3 upper = bvec3(corner & 1, corner & 2, corner & 4);
		vec3 shares = mix(1.0 - share, share, upper);
		sum += weighted_colour(ivec3(upper.x ? high.x : low.x, upper.y ? high.y : low.y,
			upper.z ? high.z : low.z), shares.x * shares.y * shares.z);
	}
#endif
	return sum.rgb / sum.a * (vec3(2047.0, 2047.0, 1023.0) / 255.0);
}
#endif

// The transfer function's entry for a stored value.
int entry_of(float stored)
{
	float entry = fma(stored, entry_map.x, entry_map.y);
#ifdef FINE_TABLE
	return int(clamp(entry, 0.5, last_entry + 0.5));
#else
	return int(clamp(entry, 0.5, float(GZ_TRANSFER_TABLE_SIZE) - 0.5));
#endif
}

// What a table of samples says of an entry. A finer table takes several rows for each step.
uvec2 look_up_entry(int entry, int step_index)
{
#ifdef FINE_TABLE
	int rows = int(last_entry) / GZ_TRANSFER_TABLE_SIZE + 1;
	return FETCH(transfer, ivec2(entry % GZ_TRANSFER_TABLE_SIZE,
		step_index * rows + entry / GZ_TRANSFER_TABLE_SIZE)).rg;
#else
	return FETCH(transfer, ivec2(entry, step_index)).rg;
#endif
}

#ifdef SEGMENTS
// A segment between two entries, from the table of a step's segments, or from that of its samples.
uvec2 segment_entry(int front, int back, int step_index)
{
#ifdef FINE_TABLE
	if (float(abs(back - front)) < GZ_CLOSE_ENTRIES)
		return look_up_entry((front + back) / 2, step_index);
	int stride = (int(last_entry) + 1) / GZ_PREINTEGRATED_SIZE;
#else
	const int stride = GZ_TRANSFER_TABLE_SIZE / GZ_PREINTEGRATED_SIZE;
#endif
	return FETCH(segments, ivec3(back / stride, front / stride, step_index)).rg;
}

// Whether an entry between two, or either of them, shows something.
bool segment_has_visible(int front, int back)
{
	uint next = look_up_entry(min(front, back), NEXT_VISIBLE_ROW).g;
	return int(next) <= max(front, back);
}

// A segment between two entries. The table cannot say whether one of negative opacity shows anything (struct
// gz_preintegration), nor does an extinction say so: either is 0 here if nothing shows.
uvec2 look_up_segment(int front, int back, int step_index)
{
	uvec2 look = segment_entry(front, back, step_index);
	if (uintBitsToFloat(look.x) < 0.0 && !segment_has_visible(front, back))
		look.x = 0U;
	return look;
}
#endif

vec3 unpack_colour(uint colour)
{
	return vec3(float(colour >> 21), float(colour >> 10 & 2047U), float(colour & 1023U));
}
