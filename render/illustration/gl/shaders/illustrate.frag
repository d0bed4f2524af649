// What a lattice point shows of a surface: its tone before equalisation, its place and its object. The formulas are
// those of render/illustration/shading_parameters.h, the order of steps that of render/illustration/cpu/.
in vec3 place, normals[GZ_SHADING_LEVELS];
in vec3 scalars; // the greatest and the least curvature, the distance to the chosen object

layout(location = 0) uniform vec3 lattice;   // pixel of the first point, spacing
layout(location = OBJECT) uniform ivec3 object; // its number, its look, 1 if it is transparent
layout(location = BEHIND) uniform int behind;   // 1: show what lies behind the layer before

layout(binding = UNIT_BEFORE) uniform sampler2D before; // the layer before, if there is one

// struct gz_illustrate_shader_look: weights are shares of 1
struct Look {
	vec4 lights; // weights of main, plateau, grazing and plain light
	vec4 shape;  // weights of shape and curvature; the tone without weights; exaggeration
	vec4 light;  // unit vector towards the light; the level of normals under the main light
	float levels[GZ_SHADING_LEVELS]; // weights of the levels of grazing light
};

layout(std430, binding = STORAGE_LOOKS) readonly buffer Looks
{
	Look looks[];
};

// enum gz_illustrate_vector of illustrate_points.h
layout(location = TARGET_FOUND) out vec4 found;

// Where what an opaque surface hides ends, and what is as near as the layer before.
bool is_hidden(float depth)
{
	vec4 nearer = texelFetch(before, ivec2(gl_FragCoord.xy), 0);
	return nearer.z >= 0.0 ||
		depth <= fma(nearer.y, 1.0 + GZ_ILLUSTRATE_ONWARD, GZ_ILLUSTRATE_ONWARD_LEAST_MM);
}

// The light in the tangent plane of the smoother normal falls on the normal: w (1/2 + 1/2 clamp(a l'.n)).
float grazing_light(vec3 units[GZ_SHADING_LEVELS], Look look)
{
	float sum = 0.0;
	for (int level = 0; level + 1 < GZ_SHADING_LEVELS; level++) {
		vec3 smoother = units[level + 1];
		vec3 projected = look.light.xyz - smoother * dot(look.light.xyz, smoother);
		float length2 = dot(projected, projected);
		float cosine = length2 > GZ_SHADING_GRAZES_NOT
			? dot(projected, units[level]) * inversesqrt(length2) : 0.0;
		sum += look.levels[level] * fma(0.5, clamp(look.shape.w * cosine, -1.0, 1.0), 0.5);
	}
	return sum;
}

// The weighted mean of the surface parameters. Curvatures are shares of the mesh's scale.
float tone_of(vec3 units[GZ_SHADING_LEVELS], vec2 bend, vec3 viewer, Look look)
{
	float sum = look.shape.z;
	if (look.lights.x > 0.0)
		sum += look.lights.x * fma(0.5, dot(look.light.xyz, units[int(look.light.w)]), 0.5);
	if (look.lights.y > 0.0)
		sum += look.lights.y * max(dot(viewer, units[0]), 0.0);
	if (look.lights.z > 0.0)
		sum += look.lights.z * grazing_light(units, look);
	if (look.lights.w > 0.0)
		sum += look.lights.w * mix(max(dot(lamp.xyz, units[0]), 0.0), 1.0, GZ_SHADING_PLAIN_AMBIENT);
	if (look.shape.x > 0.0)
		sum += look.shape.x * fma(0.5, (bend.x + bend.y) / (abs(bend.x) + abs(bend.y) + 1.0), 0.5);
	if (look.shape.y > 0.0)
		sum += look.shape.y / (sqrt(0.5 * dot(bend, bend)) + 1.0);
	return sum;
}

void main()
{
	// The triangle's plane says whether the surface is seen from behind, because interpolated normals turn away
	// a little before the surface does. Which way it faces here does not matter, since it counts twice.
	vec3 across = cross(dFdx(place), dFdy(place));
	vec2 pixel = fma(floor(gl_FragCoord.xy), vec2(lattice.z), lattice.xy);
	vec3 direction = direction_of(pixel);
	float depth = dot(place - origin_of(pixel), direction);
	if (behind != 0 && is_hidden(depth))
		discard;
	float side = dot(across, normals[0]) * dot(across, direction) > 0.0 ? -1.0 : 1.0;
	vec3 units[GZ_SHADING_LEVELS];
	for (int level = 0; level < GZ_SHADING_LEVELS; level++) {
		float square = dot(normals[level], normals[level]);
		units[level] = square > GZ_SHADING_NO_NORMAL ? side * inversesqrt(square) * normals[level]
							      : -direction;
	}
	vec2 bend = side > 0.0 ? scalars.xy : -scalars.yx;
	int number = object.z != 0 ? -object.x : object.x;
	found = vec4(tone_of(units, bend, -direction, looks[object.y]), depth, float(number), scalars.z);
}
