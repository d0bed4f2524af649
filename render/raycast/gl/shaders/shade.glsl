// Light on a sample: struct gz_light of render/light/light.h has the formulas. SHADED: surfaces are lit. SHADOWED:
// the volume keeps light back.
#if defined(SHADED) || defined(SHADOWED)
#define LIT
#endif

// Grids of cells of 16 bits.
layout(binding = 4) uniform usampler3D occlusions; // struct gz_occlusion
layout(binding = 7) uniform usampler3D arrivals;   // struct gz_light_grid

vec3 to_eye, halfway; // of this ray: unit vectors in world directions

void set_up_view(vec3 delta, float step_length)
{
	to_eye = -delta * world_per_voxel.xyz / step_length;
	vec3 between = to_eye + light_towards.xyz;
	halfway = between * inversesqrt(dot(between, between) + 1e-12); // 0 where they are opposite
}

vec3 gradient_at(vec3 at)
{
	const vec3 x = vec3(1.0, 0.0, 0.0), y = vec3(0.0, 1.0, 0.0), z = vec3(0.0, 0.0, 1.0);
	vec3 high = vec3(sample_at(at + x), sample_at(at + y), sample_at(at + z));
	vec3 low = vec3(sample_at(at - x), sample_at(at - y), sample_at(at - z));
	return (high - low) * gradient_scale.xyz;
}

// What a grid's cells say at a place among them, trilinear.
float in_cells(usampler3D cells, vec3 at, vec3 last)
{
	vec3 place = clamp(at, vec3(0.0), last);
	ivec3 low = ivec3(place), high = min(low + 1, ivec3(last));
	vec3 share = place - vec3(low);
	vec4 left = vec4(texelFetch(cells, low, 0).r, texelFetch(cells, ivec3(low.x, high.y, low.z), 0).r,
		texelFetch(cells, ivec3(low.xy, high.z), 0).r, texelFetch(cells, ivec3(low.x, high.yz), 0).r);
	vec4 right = vec4(texelFetch(cells, ivec3(high.x, low.yz), 0).r,
		texelFetch(cells, ivec3(high.xy, low.z), 0).r,
		texelFetch(cells, ivec3(high.x, low.y, high.z), 0).r, texelFetch(cells, high, 0).r);
	vec4 rows = mix(left, right, share.x);
	vec2 planes = mix(rows.xz, rows.yw, share.y);
	return mix(planes.x, planes.y, share.z);
}

// The occlusion at a place counted from the first datum.
float occlusion_at(vec3 datum)
{
	float filled = in_cells(occlusions, fma(datum, occlusion_scale.xyz, occlusion_bias.xyz), occlusion_last.xyz);
	return clamp(fma(filled, 2.0 / 65535.0, -1.0), 0.0, 1.0);
}

// The share of the light that arrives at a place counted from the first datum.
float arriving_at(vec3 datum)
{
	return in_cells(arrivals, fma(datum, arriving_scale.xyz, arriving_bias.xyz), arriving_last.xyz) *
		(1.0 / 65535.0);
}

// Lights a colour, whose channels reach 2047, 2047 and 1023.
vec3 shade(vec3 colour, vec3 at)
{
	float ambient = light_terms.x;
	vec3 even = colour; // without regard to surfaces
#ifdef SHADOWED
	float arriving = arriving_at(at - 0.5);
	even *= fma(arriving, 1.0 - ambient, ambient);
#endif
#ifdef SHADED
	const vec3 full = vec3(2047.0, 2047.0, 1023.0);
	vec3 gradient = gradient_at(at);
	float length2 = dot(gradient, gradient);
	float weight = length2 / (length2 + GZ_LIGHT_GRADIENT * GZ_LIGHT_GRADIENT);
	vec3 normal = gradient * inversesqrt(max(length2, 1e-30));
	if (light_towards.w > 0.0)
		ambient *= 1.0 - light_towards.w * occlusion_at(at - 0.5);
	vec2 light = shine(normal, to_eye, halfway, light_towards.xyz, vec4(ambient, light_terms.yzw));
#ifdef SHADOWED
	light = vec2(fma(arriving, light.x - ambient, ambient), arriving * light.y);
#endif
	vec3 lit = min(fma(colour, vec3(light.x), full * light.y), full);
	if (gradient_scale.w > 0.0)
		lit = full * mirror_surroundings(around, gradient_scale.w, world_place(at), normal, to_eye, lit / full);
	return fma(vec3(weight), lit - even, even);
#else
	return even;
#endif
}
