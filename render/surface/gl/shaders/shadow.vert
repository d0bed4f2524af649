// Places the vertices of meshes in the shadow map.
layout(location = 0) in vec3 position;

void main()
{
	vec4 vertex = vec4(position, 1.0);
	vec3 at = vec3(dot(shadow_rows[0], vertex), dot(shadow_rows[1], vertex), dot(shadow_rows[2], vertex));
	gl_Position = vec4(2.0 * at - 1.0, 1.0);
	clip_vertex(position);
}
