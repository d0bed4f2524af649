// Places the vertices of meshes on a lattice of points. What shading reads of them is struct gz_illustrate_vertex.
layout(location = ATTRIBUTE_POSITION) in vec3 position;
layout(location = ATTRIBUTE_NORMALS) in vec3 vertex_normals[GZ_SHADING_LEVELS];
layout(location = ATTRIBUTE_SCALARS) in vec3 vertex_scalars;

out vec3 place, normals[GZ_SHADING_LEVELS];
out vec3 scalars; // the greatest and the least curvature, the distance to the chosen object

void main()
{
	place_vertex(position);
	place = position;
	normals = vertex_normals;
	scalars = vertex_scalars;
}
