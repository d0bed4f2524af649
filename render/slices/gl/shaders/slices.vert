// Places the corners of slices (struct gz_slice_corner of slice_cut.h) on a lattice of points.
layout(location = 0) in vec4 corner; // pixel x and y times w, w, depth

layout(location = 0) uniform vec3 lattice; // pixel of the first point, spacing
layout(location = 1) uniform vec2 points;  // columns, rows

flat out float depth;

void main()
{
	vec2 point = (corner.xy - lattice.xy * corner.z) / lattice.z + 0.5 * corner.z;
	gl_Position = vec4(2.0 * point / points - corner.z, 0.0, corner.z);
	depth = corner.w;
}
