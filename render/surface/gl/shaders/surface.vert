// Places the vertices of meshes on a lattice of points.
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 vertex_normal;

layout(location = 0) uniform vec3 lattice; // pixel of the first point, spacing
layout(location = 1) uniform vec2 points;  // columns, rows

out vec3 place, normal;
out float gl_ClipDistance[6];

void main()
{
	vec4 vertex = vec4(position, 1.0);
	vec2 pixel = vec2(dot(view_rows[0], vertex), dot(view_rows[1], vertex)); // times w
	float w = dot(view_rows[3], vertex);
	vec2 point = (pixel - lattice.xy * w) / lattice.z + 0.5 * w;
	gl_Position = vec4(2.0 * point / points - w, dot(view_rows[2], vertex), w);
	place = position;
	normal = vertex_normal;
	for (int axis = 0; axis < 3; axis++) {
		gl_ClipDistance[axis] = position[axis] - clip_least[axis];
		gl_ClipDistance[3 + axis] = clip_greatest[axis] - position[axis];
	}
}
