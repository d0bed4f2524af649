// What a slice shows at a lattice point: the sample of the ray caster, at the place where the point's ray meets
// the slice, with the opacity of the ray's way from the middle between this slice and the previous one to the
// middle between this one and the next. Colours are multiplied by opacity.
layout(location = 0) uniform vec3 lattice;  // pixel of the first point, spacing
layout(location = 2) uniform vec2 gap;      // between slices: in depth, and in voxel lengths for a direction of length 1

flat in float depth;

layout(location = 0) out vec4 share;

int cell_reach(vec3 cell)
{
	return int(FETCH(reaches, ivec3(cell)).r) - GZ_REACH_BORDER;
}

vec3 cell_of(vec3 at)
{
	return floor(clamp(at * (1.0 / float(GZ_MACROCELL_EDGE)), vec3(0.0), top_cell));
}

// Whether nothing shows between two places: the cells between are empty.
bool is_empty(vec3 from, vec3 to)
{
	vec3 cell = cell_of(from), away = abs(cell_of(to) - cell);
	return cell_reach(cell) > int(max(max(away.x, away.y), away.z));
}

void main()
{
	read_frame();
	vec2 pixel = fma(floor(gl_FragCoord.xy), vec2(lattice.z), lattice.xy);
	vec3 direction =
		fma(vec3(pixel.y), direction_dy.xyz, fma(vec3(pixel.x), direction_dx.xyz, direction00.xyz));
	vec3 origin = fma(vec3(pixel.y), origin_dy.xyz, fma(vec3(pixel.x), origin_dx.xyz, origin00.xyz));
	vec3 at = fma(vec3(depth), direction, origin);
	float stretch = length(direction * world_per_voxel.xyz);
#ifdef SEGMENTS
	vec3 half_way = direction * (0.5 * gap.x);
	if (is_empty(at - half_way, at + half_way))
		discard;
	uvec2 look = look_up_segment(entry_of(sample_at(at - half_way)), entry_of(sample_at(at + half_way)),
		GZ_PLAN_STEPS_MAX);
#else
	if (is_empty(at, at))
		discard;
	uvec2 look = look_up_entry(entry_of(sample_at(at)), GZ_PLAN_STEPS_MAX);
#endif
	float extinction = uintBitsToFloat(look.x);
	share = vec4(0.0);
	if (extinction < 0.0) {
		vec3 colour = unpack_colour(look.y);
#ifdef COLOURED
		colour = own_colour(at);
#endif
#ifdef SHADED
		set_up_view(direction, stretch);
#endif
#ifdef LIT
		colour = shade(colour, at);
#endif
		float opacity = 1.0 - exp2(extinction * gap.y * stretch);
		share = vec4(colour * vec3(1.0 / 2047.0, 1.0 / 2047.0, 1.0 / 1023.0), 1.0) * opacity;
	}
}
