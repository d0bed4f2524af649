// Places the vertices of meshes on a lattice of points.
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 vertex_normal;

out vec3 place, normal;

void main()
{
	place_vertex(position);
	place = position;
	normal = vertex_normal;
}
