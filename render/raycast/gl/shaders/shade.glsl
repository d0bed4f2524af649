// Light on a sample: struct gz_light of render/light/light.h has the formulas.
layout(binding = 4) uniform usampler3D occlusions; // 16 bits for each cell: struct gz_occlusion

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

float occlusion_cell(ivec3 place)
{
	return float(texelFetch(occlusions, place, 0).r);
}

// The occlusion at a place counted from the first datum, trilinear in its grid.
float occlusion_at(vec3 datum)
{
	vec3 place = clamp(fma(datum, occlusion_scale.xyz, occlusion_bias.xyz), vec3(0.0), occlusion_last.xyz);
	ivec3 low = ivec3(place), high = min(low + 1, ivec3(occlusion_last.xyz));
	vec3 share = place - vec3(low);
	vec4 left = vec4(occlusion_cell(low), occlusion_cell(ivec3(low.x, high.y, low.z)),
		occlusion_cell(ivec3(low.xy, high.z)), occlusion_cell(ivec3(low.x, high.yz)));
	vec4 right = vec4(occlusion_cell(ivec3(high.x, low.yz)), occlusion_cell(ivec3(high.xy, low.z)),
		occlusion_cell(ivec3(high.x, low.y, high.z)), occlusion_cell(high));
	vec4 rows = mix(left, right, share.x);
	vec2 planes = mix(rows.xz, rows.yw, share.y);
	return clamp(fma(mix(planes.x, planes.y, share.z), 2.0 / 65535.0, -1.0), 0.0, 1.0);
}

// Lights a colour, whose channels reach 2047, 2047 and 1023.
vec3 shade(vec3 colour, vec3 at)
{
	const vec3 full = vec3(2047.0, 2047.0, 1023.0);
	vec3 gradient = gradient_at(at);
	float length2 = dot(gradient, gradient);
	float weight = length2 / (length2 + GZ_LIGHT_GRADIENT * GZ_LIGHT_GRADIENT);
	vec3 normal = gradient * inversesqrt(max(length2, 1e-30));
	float ambient = light_terms.x;
	if (light_towards.w > 0.0)
		ambient *= 1.0 - light_towards.w * occlusion_at(at - 0.5);
	vec2 light = shine(normal, to_eye, halfway, light_towards.xyz, vec4(ambient, light_terms.yzw));
	vec3 lit = min(fma(colour, vec3(light.x), full * light.y), full);
	if (gradient_scale.w > 0.0)
		lit = full * mirror_surroundings(around, gradient_scale.w, world_place(at), normal, to_eye, lit / full);
	return fma(vec3(weight), lit - colour, colour);
}
