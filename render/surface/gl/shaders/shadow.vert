// Places the vertices of meshes in the shadow map.
layout(location = 0) in vec3 position;

out float gl_ClipDistance[6];

void main()
{
	vec4 vertex = vec4(position, 1.0);
	vec3 at = vec3(dot(shadow_rows[0], vertex), dot(shadow_rows[1], vertex), dot(shadow_rows[2], vertex));
	gl_Position = vec4(2.0 * at - 1.0, 1.0);
	for (int axis = 0; axis < 3; axis++) {
		gl_ClipDistance[axis] = position[axis] - clip_least[axis];
		gl_ClipDistance[3 + axis] = clip_greatest[axis] - position[axis];
	}
}
