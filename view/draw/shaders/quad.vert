// One triangle that covers the window; no buffer is needed. Row 0 of the picture is the top.
out vec2 place;

void main()
{
	vec2 corner = vec2(float((gl_VertexID << 1) & 2), float(gl_VertexID & 2));
	place = vec2(corner.x, 1.0 - corner.y);
	gl_Position = vec4(2.0 * corner - 1.0, 0.0, 1.0);
}
