// Clips a vertex to the clip region, by clip_least, clip_greatest and clip_plane of a block before this.
out float gl_ClipDistance[7];

void clip_vertex(vec3 at)
{
	for (int axis = 0; axis < 3; axis++) {
		gl_ClipDistance[axis] = at[axis] - clip_least[axis];
		gl_ClipDistance[3 + axis] = clip_greatest[axis] - at[axis];
	}
	gl_ClipDistance[6] = clip_plane.w - dot(clip_plane.xyz, at);
}
