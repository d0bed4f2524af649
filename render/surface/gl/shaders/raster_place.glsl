// Where a vertex lies on a lattice of points, by view_rows of a block before this.
layout(location = 0) uniform vec3 lattice; // pixel of the first point, spacing
layout(location = 1) uniform vec2 points;  // columns, rows

void place_vertex(vec3 at)
{
	vec4 vertex = vec4(at, 1.0);
	vec2 pixel = vec2(dot(view_rows[0], vertex), dot(view_rows[1], vertex)); // times w
	float w = dot(view_rows[3], vertex);
	vec2 point = (pixel - lattice.xy * w) / lattice.z + 0.5 * w;
	gl_Position = vec4(2.0 * point / points - w, dot(view_rows[2], vertex), w);
	clip_vertex(at);
}
