// Casts rays of tiles, front to back: with the samples, ends and colours of the cpu backend's kernel, which
// explains how rays are cut into segments (render/raycast/cpu/cast_kernel.h).
layout(local_size_x = GROUP_SIZE) in;

layout(location = 2) uniform uint detail; // the level that this dispatch casts

layout(std430, binding = 3) buffer Counts
{
	uint counts[];
};

#ifdef HITS
// Depth of what each ray meets, as bits, and its pixel, by the place of its tile: gz_gl_cast_set_hits().
layout(std430, binding = 5) readonly buffer Hits
{
	uvec2 hits[];
};
#define FARTHEST_HIT 1e30 // nothing is met
#endif

struct Ray {
	vec3 start, delta, inverse; // voxel coordinates; position = start + k * delta
	float first, end;           // whole segments: from k = first to k = end
	float head, head_at;        // length of the partial segment before them, and its middle
	float rest;                 // length of the partial segment after them
	float zero;                 // steps from the origin to k = 0
};

struct Light {
	vec3 colour;
	float through;
	float depth; // k, weighted as the colour is
};

// Samples that are looked up before the first of them is composited, so that their fetches overlap. A lit or
// coloured sample has enough fetches of its own.
#if defined(LIT) || defined(COLOURED)
#define BATCH 1
#else
#define BATCH 4
#endif

// Whether the condition holds for any ray of the same warp.
bool any_of_warp(bool so)
{
#ifdef GL_ARB_shader_group_vote
	return anyInvocationARB(so);
#else
	return so;
#endif
}

// gz_ray_jitter() of render/raycast/shared/ray_params.h, which explains it; without a seed the ray's phase.
float jitter_of(uvec2 pixel, float phase)
{
	if (jitter.x == 0U)
		return phase;
	uvec3 word = uvec3(pixel - jitter.yz, jitter.x) * GZ_JITTER_MULTIPLIER + GZ_JITTER_INCREMENT;
	word.x += word.y * word.z;
	word.y += word.z * word.x;
	word.z += word.x * word.y;
	word ^= word >> 16;
	word.x += word.y * word.z;
	return float(word.x >> 8) * (1.0 / 16777216.0);
}

// Leaves of a ray what the clip plane keeps. Without a plane it is crossed too far away to matter.
void cut_by_plane(vec3 origin, vec3 along, inout float from, inout float to)
{
	float across = dot(clip_plane.xyz, along);
	float at = (clip_plane.w - dot(clip_plane.xyz, origin)) / (abs(across) < 1e-12 ? 1e-12 : across);
	if (across < 0.0)
		from = max(from, at);
	else
		to = min(to, at);
}

// Cuts a ray by the whole box and by the shown part of it. Segments are counted from a jitter before the box.
#ifdef HITS
Ray set_up_ray(uvec2 at, float step_length, float phase, float hit_depth)
#else
Ray set_up_ray(uvec2 at, float step_length, float phase)
#endif
{
	vec2 pixel = vec2(at);
	vec3 origin = fma(vec3(pixel.y), origin_dy.xyz, fma(vec3(pixel.x), origin_dx.xyz, origin00.xyz));
	vec3 direction =
		fma(vec3(pixel.y), direction_dy.xyz, fma(vec3(pixel.x), direction_dx.xyz, direction00.xyz));
	vec3 raw = direction * (step_length / length(direction * world_per_voxel.xyz));
	Ray ray;
	ray.delta = mix(raw, vec3(1e-12), lessThan(abs(raw), vec3(1e-12)));
	ray.inverse = 1.0 / ray.delta;
	vec3 whole = min(-origin * ray.inverse, (box.xyz - origin) * ray.inverse);
	vec3 a = (clip_least.xyz - origin) * ray.inverse, b = (clip_greatest.xyz - origin) * ray.inverse;
	vec3 near = min(a, b), far = max(a, b);
	float box_at = max(max(whole.x, whole.y), max(whole.z, 0.0));
	float enter = max(max(near.x, near.y), max(near.z, 0.0));
	float leave = min(min(far.x, far.y), far.z);
	cut_by_plane(origin, ray.delta, enter, leave);
#ifdef HITS
	leave = min(leave, hit_depth / step_length);
#endif
	float shift = jitter_of(at, phase);
	bool hit = enter < leave;
	float from = hit ? enter - box_at + shift : 0.0, to = hit ? leave - box_at + shift : 0.0;
	ray.first = ceil(from);
	ray.end = floor(to);
	ray.head = min(ray.first, to) - from;
	ray.head_at = fma(ray.head, 0.5, from);
	// If everything lies within one segment, the head is all.
	ray.rest = ray.end < ray.first ? 0.0 : to - ray.end;
	ray.zero = box_at - shift;
	ray.start = fma(vec3(ray.zero), ray.delta, origin);
	return ray;
}

// Whether the macrocell at k is empty. All cells up to k = until are of its kind.
bool look_up_cell(Ray ray, float k, out float until)
{
	vec3 at = fma(vec3(k), ray.delta, ray.start);
	vec3 cell = floor(clamp(at * (1.0 / float(GZ_MACROCELL_EDGE)), vec3(0.0), top_cell));
	int away = int(FETCH(reaches, ivec3(cell)).r) - GZ_REACH_BORDER;
	float reach = float(abs(away));
	vec3 edge = mix(cell + (1.0 - reach), cell + reach, greaterThan(ray.delta, vec3(0.0)));
	vec3 leave = (edge * float(GZ_MACROCELL_EDGE) - ray.start) * ray.inverse;
	until = min(min(leave.x, leave.y), leave.z);
	return away > 0;
}

// Adds the colour of a sample at k.
void composite(Ray ray, float k, uint packed_colour, float opacity, inout Light light)
{
	vec3 colour = unpack_colour(packed_colour);
#ifdef COLOURED
	if (opacity > 0.0)
		colour = own_colour(fma(vec3(k), ray.delta, ray.start));
#endif
#ifdef LIT
	if (opacity > 0.0)
		colour = shade(colour, fma(vec3(k), ray.delta, ray.start));
#endif
	float weight = light.through * opacity;
	light.colour = fma(vec3(weight), colour, light.colour);
#ifdef DEEP
	light.depth = fma(weight, k, light.depth);
#endif
	light.through -= weight;
}

#ifdef SEGMENTS
// Segments instead of samples: render/raycast/cpu/cast_preintegrated.h explains them.
int entry_at(Ray ray, float k)
{
	return entry_of(sample_at(fma(vec3(k), ray.delta, ray.start)));
}

uint march_segments(Ray ray, int step_index, inout Light light)
{
	uint samples = 0U;
	float k = ray.first, until = -1.0;
	int front = -1; // entry at k; -1 = not known
	while (k < ray.end) {
		if (k >= until) {
			float leave;
			bool empty = look_up_cell(ray, k, leave);
			float next = empty ? max(floor(leave), k) : k;
			front = k < next ? -1 : front;
			k = next;
			until = empty ? k + 0.5 : max(leave, k + 0.5);
		}
		if (k < ray.end) {
			if (front < 0) {
				front = entry_at(ray, k);
				samples++;
			}
			k += 1.0;
			int back = entry_at(ray, k);
			samples++;
			uvec2 look = look_up_segment(front, back, step_index);
			composite(ray, k - 0.5, look.y, abs(uintBitsToFloat(look.x)), light);
			front = back;
			if (light.through <= transfer_map.z)
				return samples;
		}
	}
	return samples;
}

// A partial segment: from `from` on, `part` steps long.
uint segment_part(Ray ray, float from, float part, float voxel_lengths, inout Light light)
{
	float leave, to = from + part;
	if (part <= GZ_LAST_SEGMENT_LEAST || light.through <= transfer_map.z)
		return 0U;
	if (look_up_cell(ray, from, leave) && leave >= to)
		return 0U;
	uvec2 look = look_up_segment(entry_at(ray, from), entry_at(ray, to), GZ_PLAN_STEPS_MAX);
	float extinction = uintBitsToFloat(look.x);
	float opacity = extinction < 0.0 ? 1.0 - exp2(extinction * part * voxel_lengths) : 0.0;
	composite(ray, fma(part, 0.5, from), look.y, opacity, light);
	return 2U;
}
#else
uvec2 look_up(Ray ray, float k, int step_index)
{
	int entry = entry_of(sample_at(fma(vec3(k), ray.delta, ray.start)));
	return look_up_entry(entry, step_index);
}

// Takes up to BATCH samples from k on, and moves k past them.
void march_batch(Ray ray, int step_index, inout float k, inout Light light)
{
	float from = k;
	uvec2 looks[BATCH];
	for (int i = 0; i < BATCH; i++)
		looks[i] = look_up(ray, from + float(i), step_index);
	for (int i = 0; i < BATCH; i++) {
		bool takes = i == 0 || (k < ray.end && light.through > transfer_map.z);
		composite(ray, from + float(i), looks[i].y, takes ? uintBitsToFloat(looks[i].x) : 0.0, light);
		k += takes ? 1.0 : 0.0;
	}
}

// Takes all whole segments: advances to the next occupied cell, then takes its samples. Two loops in turn, so
// that rays that skip and rays that sample do not wait for each other at every step. A ray that has left its
// cell samples on while others of its warp are in theirs: it would have to wait for them, and empty space adds
// nothing. Loops test their condition at the end: in software the lanes of a processor are the rays, and they
// run through the rest of a loop that all have left.
uint march(Ray ray, int step_index, inout Light light)
{
	float samples = 0.0, k = ray.first + 0.5;
	while (k < ray.end && light.through > transfer_map.z) {
		float until;
		bool empty;
		do {
			empty = look_up_cell(ray, k, until);
			k += empty ? max(ceil(until - k), 1.0) : 0.0;
		} while (empty && k < ray.end);
		samples -= k;
		bool goes = !empty;
		if (goes) {
			do {
				march_batch(ray, step_index, k, light);
				goes = k < ray.end && light.through > transfer_map.z;
				goes = goes && any_of_warp(k < until);
			} while (goes);
		}
		samples += k;
	}
	return uint(samples);
}

// A partial segment at an end of a ray: `part` steps long, with its middle at k.
uint march_part(Ray ray, float k, float part, float voxel_lengths, inout Light light)
{
	float until;
	if (part <= GZ_LAST_SEGMENT_LEAST || light.through <= transfer_map.z ||
		look_up_cell(ray, k, until))
		return 0U;
	int entry = entry_of(sample_at(fma(vec3(k), ray.delta, ray.start)));
	uvec2 look = look_up_entry(entry, GZ_PLAN_STEPS_MAX);
	float extinction = uintBitsToFloat(look.x);
	float opacity = extinction < 0.0 ? 1.0 - exp2(extinction * part * voxel_lengths) : 0.0;
	composite(ray, k, look.y, opacity, light);
	return 1U;
}
#endif

uint to_pixel(Light light, uvec2 at)
{
	vec3 colour = fma(vec3(light.through), see_behind(vec2(at)),
		light.colour * vec3(1.0 / 2047.0, 1.0 / 2047.0, 1.0 / 1023.0));
	uvec3 bytes = uvec3(fma(clamp(colour, 0.0, 1.0), vec3(255.0), vec3(0.5)));
	return bytes.r | bytes.g << 8 | bytes.b << 16 | 0xFF000000U;
}

#ifdef DEEP
// Puts the mean depth of what the ray shows into the fourth byte of its pixel.
uint with_depth(Ray ray, Light light, float step_length, uint pixel)
{
	float shown = 1.0 - light.through;
	float k = light.depth / max(shown, 1.0 / 255.0);
	float share = shown > 1.0 / 255.0 ? fma((k + ray.zero) * step_length, depths.x, depths.y) : 0.5;
	return (pixel & 0x00FFFFFFU) | uint(fma(clamp(share, 0.0, 1.0), 255.0, 0.5)) << 24;
}
#endif

// Stores a pixel on its lattice and, in a pyramid, on the coarser lattices that have the point too.
void store(Tile tile, uvec2 at, uint pixel)
{
	uint end = plan.y == 1U ? plan.x : tile.layer + 1U;
	for (uint i = tile.layer; i < end; i++) {
		uvec4 layer = layers[i];
		uvec2 place = at / layer.w;
		if (place * layer.w != at)
			return;
		if (place.x < layer.y && place.y < layer.z)
			points[layer.x + place.y * layer.y + place.x] = pixel;
	}
}

void main()
{
	uint index = first_item + gl_GlobalInvocationID.x / TILE_RAYS;
	uint ray_index = gl_LocalInvocationID.x % TILE_RAYS;
	if (index >= item_end)
		return;
	Tile tile = unpack_tile(tiles[index]);
	if (tile.detail != detail || (tile.active_rays >> ray_index & 1U) == 0U)
		return;
	uvec3 point = tile_points[tile.pattern * TILE_RAYS + ray_index].xyz;
	uvec2 at = tile.at + point.xy * layers[tile.layer].w;
	read_frame();
	vec2 step_lengths = steps[tile.step].xy;
	float phase = steps[tile.step].z * float(point.z);
#ifdef HITS
	uvec2 met = hits[index * uint(TILE_RAYS) + ray_index];
	Ray ray = set_up_ray(at, step_lengths.x, phase, uintBitsToFloat(met.x));
#else
	Ray ray = set_up_ray(at, step_lengths.x, phase);
#endif
	Light light = Light(vec3(0.0), 1.0, 0.0);
#ifdef SHADED
	set_up_view(ray.delta, step_lengths.x);
#endif
#ifdef SEGMENTS
	uint samples = segment_part(ray, fma(ray.head, -0.5, ray.head_at), ray.head, step_lengths.y, light);
	samples += march_segments(ray, int(tile.step), light);
	samples += segment_part(ray, ray.end, ray.rest, step_lengths.y, light);
#else
	uint samples = march_part(ray, ray.head_at, ray.head, step_lengths.y, light);
	samples += march(ray, int(tile.step), light);
	samples += march_part(ray, fma(ray.rest, 0.5, ray.end), ray.rest, step_lengths.y, light);
#endif
#ifdef HITS
	if (uintBitsToFloat(met.x) < FARTHEST_HIT) { // it is opaque
		vec3 bytes = vec3(met.y & 255U, met.y >> 8 & 255U, met.y >> 16 & 255U);
#ifdef DEEP
		light.depth += light.through * (uintBitsToFloat(met.x) / step_lengths.x - ray.zero);
#endif
		light.colour += light.through * bytes * (vec3(2047.0, 2047.0, 1023.0) / 255.0);
		light.through = 0.0;
	}
#endif
	uint pixel = to_pixel(light, at);
#ifdef DEEP
	pixel = with_depth(ray, light, step_lengths.x, pixel);
#endif
	store(tile, at, pixel);
	if (samples > 0U)
		atomicAdd(counts[gl_WorkGroupID.x % uint(COUNT_SLOTS)], samples);
}
