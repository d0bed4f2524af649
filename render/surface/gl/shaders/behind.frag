// What a lattice point shows where there is no surface.
layout(location = 0) uniform vec3 lattice; // pixel of the first point, spacing

layout(location = 0) out vec4 colour;
layout(location = 1) out uint object;
layout(location = 2) out uint depth; // the bits of a float

void main()
{
	vec2 pixel = fma(floor(gl_FragCoord.xy), vec2(lattice.z), lattice.xy);
	colour = vec4(see_surroundings(around, origin_of(pixel), direction_of(pixel)), 1.0);
	object = 0U;
	depth = 0x7F800000U; // infinity
}
