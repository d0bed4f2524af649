// The surroundings, where light comes through all slices.
layout(location = 0) uniform vec3 lattice; // pixel of the first point, spacing

layout(location = 0) out vec4 share;

void main()
{
	share = vec4(see_behind(fma(floor(gl_FragCoord.xy), vec2(lattice.z), lattice.xy)), 1.0);
}
