// The surroundings: render/light/environment.h and render/light/cube.h have the formulas, struct
// gz_seen_surroundings the numbers. All vectors are of length 1.
struct Surroundings {
	vec4 axes[3]; // of a sky: up, and two along the floor; of a cube: right, front and up
	vec4 sun;     // of a sky: towards the light
	vec4 ground;  // height of the floor; tiles of a unit of length; fading of a unit
	vec4 horizon, zenith, bright, dark; // colours; tiles are lit
	ivec4 kind;                         // enum gz_surroundings; whether there is a floor; edge of a face, texels
};

layout(binding = UNIT_CUBE) uniform sampler2DArray faces; // each with a rim of its neighbours' texels

vec3 floor_or_sky(Surroundings around, vec3 origin, vec3 direction, float rise, vec3 sky)
{
	float height = dot(origin, around.axes[0].xyz) - around.ground.x;
	if (height <= 0.0 || rise >= -GZ_FLOOR_FALL)
		return sky;
	float distance = height / -rise;
	vec3 place = fma(vec3(distance), direction, origin);
	float tiles = floor(dot(place, around.axes[1].xyz) * around.ground.y) +
		floor(dot(place, around.axes[2].xyz) * around.ground.y);
	vec3 tile = fract(tiles * 0.5) > 0.25 ? around.dark.rgb : around.bright.rgb;
	return fma(vec3(exp2(-distance * around.ground.z)), tile - around.horizon.rgb, around.horizon.rgb);
}

vec3 see_sky(Surroundings around, vec3 origin, vec3 direction)
{
	float rise = dot(direction, around.axes[0].xyz), cosine = dot(direction, around.sun.xyz);
	float height = clamp(rise, 0.0, 1.0);
	vec3 sky = fma(vec3(height * (2.0 - height)), around.zenith.rgb - around.horizon.rgb, around.horizon.rgb);
	float sun = clamp((cosine - GZ_SUN_RIM) / (GZ_SUN_DISC - GZ_SUN_RIM), 0.0, 1.0);
	vec3 seen = fma(vec3(sun * sun), 1.0 - sky, sky);
	return around.kind.y == 0 ? seen : floor_or_sky(around, origin, direction, rise, seen);
}

// The face that a direction meets, and s and t there. Faces lie in pairs: right, left, front, back, up, down.
vec3 meet_cube(Surroundings around, vec3 direction)
{
	float r = dot(direction, around.axes[0].xyz), f = dot(direction, around.axes[1].xyz);
	float u = dot(direction, around.axes[2].xyz);
	vec3 size = abs(vec3(r, f, u));
	if (size.y > size.x && size.y > size.z)
		return f < 0.0 ? vec3(3.0, vec2(-r, -u) / size.y) : vec3(2.0, vec2(r, -u) / size.y);
	if (size.z > size.x)
		return u < 0.0 ? vec3(5.0, vec2(r, -f) / size.z) : vec3(4.0, vec2(r, f) / size.z);
	return r < 0.0 ? vec3(1.0, vec2(f, -u) / size.x) : vec3(0.0, vec2(-f, -u) / size.x);
}

vec3 see_cube(Surroundings around, vec3 direction)
{
	vec3 at = meet_cube(around, direction);
	float edge = float(around.kind.z);
	vec2 place = clamp(fma(at.yz, vec2(0.5 * edge), vec2(0.5 * edge + 0.5)), 0.5, edge + 0.5);
	ivec3 first = ivec3(ivec2(place), int(at.x));
	vec2 share = fract(place);
	vec3 upper = mix(texelFetch(faces, first, 0).rgb, texelFetch(faces, first + ivec3(1, 0, 0), 0).rgb, share.x);
	vec3 lower = mix(texelFetch(faces, first + ivec3(0, 1, 0), 0).rgb,
		texelFetch(faces, first + ivec3(1, 1, 0), 0).rgb, share.x);
	return mix(upper, lower, share.y);
}

// What a ray from here sees of them.
vec3 see_surroundings(Surroundings around, vec3 origin, vec3 direction)
{
	if (around.kind.x == SURROUNDINGS_SKY)
		return see_sky(around, origin, direction);
	return around.kind.x == SURROUNDINGS_CUBE ? see_cube(around, direction) : around.horizon.rgb;
}

// A surface's colour with what it mirrors: struct gz_light has the formula. `reflection` is light.reflection.
vec3 mirror_surroundings(Surroundings around, float reflection, vec3 place, vec3 normal, vec3 to_eye, vec3 colour)
{
	float along = dot(normal, to_eye), outside = 1.0 - min(abs(along), 1.0), power2 = outside * outside;
	float share = fma((1.0 - reflection) * power2 * power2, outside, reflection);
	vec3 direction = fma(vec3(2.0 * along), normal, -to_eye);
	return mix(colour, see_surroundings(around, place, direction), share);
}
