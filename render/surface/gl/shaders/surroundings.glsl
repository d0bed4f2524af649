// The surroundings: render/light/environment.h and render/light/cube.h have the formulas.
layout(binding = UNIT_CUBE) uniform sampler2DArray faces; // each with a rim of its neighbours' texels

// The ray of a pixel.
vec3 origin_of(vec2 pixel)
{
	return fma(vec3(pixel.y), origin_dy.xyz, fma(vec3(pixel.x), origin_dx.xyz, origin00.xyz));
}

vec3 direction_of(vec2 pixel)
{
	return normalize(
		fma(vec3(pixel.y), direction_dy.xyz, fma(vec3(pixel.x), direction_dx.xyz, direction00.xyz)));
}

vec3 floor_or_sky(vec3 origin, vec3 direction, float rise, vec3 sky)
{
	float height = dot(origin, axes[0].xyz) - ground.x;
	if (height <= 0.0 || rise >= -GZ_FLOOR_FALL)
		return sky;
	float distance = height / -rise;
	vec3 place = fma(vec3(distance), direction, origin);
	float tiles = floor(dot(place, axes[1].xyz) * ground.y) + floor(dot(place, axes[2].xyz) * ground.y);
	vec3 tile = fract(tiles * 0.5) > 0.25 ? dark.rgb : bright.rgb;
	return fma(vec3(exp2(-distance * ground.z)), tile - horizon.rgb, horizon.rgb);
}

vec3 see_sky(vec3 origin, vec3 direction)
{
	float rise = dot(direction, axes[0].xyz), cosine = dot(direction, light_towards.xyz);
	float height = clamp(rise, 0.0, 1.0);
	vec3 sky = fma(vec3(height * (2.0 - height)), zenith.rgb - horizon.rgb, horizon.rgb);
	float sun = clamp((cosine - GZ_SUN_RIM) / (GZ_SUN_DISC - GZ_SUN_RIM), 0.0, 1.0);
	vec3 seen = fma(vec3(sun * sun), 1.0 - sky, sky);
	return are.y == 0 ? seen : floor_or_sky(origin, direction, rise, seen);
}

// The face that a direction meets, and s and t there. Faces lie in pairs: right, left, front, back, up, down.
vec3 meet_cube(vec3 direction)
{
	float r = dot(direction, axes[0].xyz), f = dot(direction, axes[1].xyz), u = dot(direction, axes[2].xyz);
	vec3 size = abs(vec3(r, f, u));
	if (size.y > size.x && size.y > size.z)
		return f < 0.0 ? vec3(3.0, vec2(-r, -u) / size.y) : vec3(2.0, vec2(r, -u) / size.y);
	if (size.z > size.x)
		return u < 0.0 ? vec3(5.0, vec2(r, -f) / size.z) : vec3(4.0, vec2(r, f) / size.z);
	return r < 0.0 ? vec3(1.0, vec2(f, -u) / size.x) : vec3(0.0, vec2(-f, -u) / size.x);
}

vec3 see_cube(vec3 direction)
{
	vec3 at = meet_cube(direction);
	float edge = float(cube.x);
	vec2 place = clamp(fma(at.yz, vec2(0.5 * edge), vec2(0.5 * edge + 0.5)), 0.5, edge + 0.5);
	ivec3 first = ivec3(ivec2(place), int(at.x));
	vec2 share = fract(place);
	vec3 upper = mix(texelFetch(faces, first, 0).rgb, texelFetch(faces, first + ivec3(1, 0, 0), 0).rgb, share.x);
	vec3 lower = mix(texelFetch(faces, first + ivec3(0, 1, 0), 0).rgb,
		texelFetch(faces, first + ivec3(1, 1, 0), 0).rgb, share.x);
	return mix(upper, lower, share.y);
}

// What a ray from here sees of them.
vec3 see_surroundings(vec3 origin, vec3 direction)
{
	if (are.x == SURROUNDINGS_SKY)
		return see_sky(origin, direction);
	return are.x == SURROUNDINGS_CUBE ? see_cube(direction) : horizon.rgb;
}
