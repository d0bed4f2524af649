// What a lattice point shows of a surface: its colour in the light of the scene, or what glass reflects and
// refracts.
in vec3 place, normal;

layout(location = 0) uniform vec3 lattice; // pixel of the first point, spacing
layout(location = 2) uniform uint id;      // of the object
layout(location = 3) uniform vec3 own;     // its colour

layout(binding = UNIT_SHADOW) uniform sampler2DShadow shadow_map;

layout(location = 0) out vec4 colour;
layout(location = 1) out uint object;
layout(location = 2) out uint depth; // the bits of a float

// The share of the light that reaches the surface: the shadow map around its place in the map, 3 x 3 texels, each
// compared in four (Reeves, Salesin and Cook 1987). The place is lifted off the surface by as much as the surface
// rises over the texels that are read, so that it does not shade itself.
float light_share(vec3 facing, vec3 flat_normal)
{
	float cosine = clamp(abs(dot(flat_normal, light_towards.xyz)), 0.0, 1.0);
	float lift = shadow_texel.x * fma(SHADOW_LIFT, sqrt(1.0 - cosine * cosine), 0.5);
	vec4 lifted = vec4(fma(vec3(lift), facing, place), 1.0);
	vec3 at = vec3(dot(shadow_rows[0], lifted), dot(shadow_rows[1], lifted),
		dot(shadow_rows[2], lifted) - shadow_texel.z);
	float sum = 0.0;
	for (int y = -1; y <= 1; y++)
		for (int x = -1; x <= 1; x++)
			sum += texture(shadow_map, at + vec3(vec2(x, y) * shadow_texel.y, 0.0));
	return sum / 9.0;
}

// One reflection and one refraction by Schlick and Snell: render/surface/cpu/surface_glass.h has the formulas.
vec3 see_through(vec3 facing, vec3 direction)
{
	float ratio = 1.0 / glass.x, cosine = clamp(-dot(direction, facing), 0.0, 1.0);
	float beyond = sqrt(max(1.0 - ratio * ratio * (1.0 - cosine * cosine), 0.0));
	float outside = 1.0 - cosine, power2 = outside * outside;
	float share = fma((1.0 - glass.y) * power2 * power2, outside, glass.y);
	vec3 reflected = fma(vec3(2.0 * cosine), facing, direction);
	vec3 refracted = fma(vec3(fma(ratio, cosine, -beyond)), facing, ratio * direction);
	return mix(see_surroundings(around, place, refracted), see_surroundings(around, place, reflected), share);
}

void main()
{
	vec3 flat_normal = cross(dFdx(place), dFdy(place));
	flat_normal *= inversesqrt(max(dot(flat_normal, flat_normal), 1e-30));
	vec2 pixel = fma(floor(gl_FragCoord.xy), vec2(lattice.z), lattice.xy);
	vec3 direction = direction_of(pixel);
	vec3 unit = normal * inversesqrt(max(dot(normal, normal), 1e-30));
	vec3 facing = dot(unit, direction) > 0.0 ? -unit : unit;
	object = id;
	depth = floatBitsToUint(dot(place - origin_of(pixel), direction) * scale.x);
	if (are.x != 0) {
		colour = vec4(see_through(facing, direction), 1.0);
		return;
	}
	vec3 between = light_towards.xyz - direction;
	vec3 halfway = between * inversesqrt(dot(between, between) + 1e-12); // 0 where they are opposite
	vec2 light = shine(unit, -direction, halfway, light_towards.xyz, light_terms);
	if (are.y != 0 && light.x > light_terms.x)
		light = mix(vec2(light_terms.x, 0.0), light, light_share(facing, flat_normal));
	vec3 lit = fma(own, vec3(light.x), vec3(light.y));
	if (scale.y > 0.0)
		lit = mirror_surroundings(around, scale.y, place, unit, -direction, min(lit, vec3(1.0)));
	colour = vec4(lit, 1.0);
}
