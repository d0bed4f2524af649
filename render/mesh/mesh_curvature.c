#include "render/mesh/mesh_curvature.h"

#include <math.h>
#include <stdlib.h>

#include "base/vector.h"

/* Three unit vectors at right angles: two along a surface, and its normal. */
struct surface_frame {
	double u[3], v[3], normal[3];
};

/* A second fundamental form: of the change of the normal along (a, b), uu a + uv b is the part
 * along u, and uv a + vv b that along v. */
struct bending {
	double uu, uv, vv;
};

/* What the triangles of a vertex add up to. */
struct vertex_sum {
	struct bending bending;
	double area;
};

/* A triangle: its corners and its edges; edge i lies opposite to corner i. */
struct triangle_shape {
	const uint32_t *corners;
	double edges[3][3];
	double corner_areas[3]; /* what is nearest to each corner */
};

/* A frame around a normal. Which way it is turned does not matter, but it is the same each time. */
static struct surface_frame frame_of_normal(const float normal[3])
{
	struct surface_frame frame = { .normal = { (double)normal[0], (double)normal[1],
						   (double)normal[2] } };
	double axis[3] = { 0 };
	int least = 0;
	for (int i = 1; i < 3; i++)
		least = fabs(frame.normal[i]) < fabs(frame.normal[least]) ? i : least;
	axis[least] = 1;
	gz_cross3(frame.normal, axis, frame.u);
	(void)gz_normalise3(frame.u);
	gz_cross3(frame.normal, frame.u, frame.v);
	return frame;
}

/* Voronoi areas of the corners; where an angle is obtuse, the areas that the midpoints of the edges
 * cut off, as Rusinkiewicz 2004 has them. Returns false for a triangle without an area. */
static bool share_area(struct triangle_shape *shape)
{
	double normal[3], squares[3], weights[3];
	gz_cross3(shape->edges[0], shape->edges[1], normal);
	const double area = gz_length3(normal) / 2;
	if (!(area > 0) || !isfinite(area))
		return false;
	for (int i = 0; i < 3; i++)
		squares[i] = gz_dot3(shape->edges[i], shape->edges[i]);
	for (int i = 0; i < 3; i++) {
		const int j = (i + 1) % 3, k = (i + 2) % 3;
		weights[i] = squares[i] * (squares[j] + squares[k] - squares[i]);
	}
	for (int i = 0; i < 3; i++) {
		const int j = (i + 1) % 3, k = (i + 2) % 3;
		if (weights[i] > 0)
			continue;
		/* Each other corner keeps a right triangle over half of the edge to this one. */
		shape->corner_areas[j] =
			-0.25 * squares[k] * area / gz_dot3(shape->edges[i], shape->edges[k]);
		shape->corner_areas[k] =
			-0.25 * squares[j] * area / gz_dot3(shape->edges[i], shape->edges[j]);
		shape->corner_areas[i] = area - shape->corner_areas[j] - shape->corner_areas[k];
		return true;
	}
	const double scale = 0.5 * area / (weights[0] + weights[1] + weights[2]);
	for (int i = 0; i < 3; i++)
		shape->corner_areas[i] = scale * (weights[(i + 1) % 3] + weights[(i + 2) % 3]);
	return true;
}

static bool take_shape(const struct gz_mesh *mesh, size_t triangle, struct triangle_shape *shape)
{
	shape->corners = mesh->triangles[triangle];
	for (int i = 0; i < 3; i++)
		for (int axis = 0; axis < 3; axis++)
			shape->edges[i][axis] =
				(double)mesh->positions[shape->corners[(i + 2) % 3]][axis] -
				(double)mesh->positions[shape->corners[(i + 1) % 3]][axis];
	return share_area(shape);
}

/* The frame of a triangle's plane, on the side of its vertices' normals, whichever way round its
 * corners are listed. */
static struct surface_frame frame_of_triangle(const struct gz_mesh *mesh,
					      const struct triangle_shape *shape)
{
	struct surface_frame frame;
	double outwards = 0;
	gz_cross3(shape->edges[0], shape->edges[1], frame.normal);
	(void)gz_normalise3(frame.normal);
	for (int axis = 0; axis < 3; axis++) {
		frame.u[axis] = shape->edges[0][axis];
		for (int i = 0; i < 3; i++)
			outwards +=
				frame.normal[axis] * (double)mesh->normals[shape->corners[i]][axis];
	}
	for (int axis = 0; outwards < 0 && axis < 3; axis++)
		frame.normal[axis] = -frame.normal[axis];
	(void)gz_normalise3(frame.u);
	gz_cross3(frame.normal, frame.u, frame.v);
	return frame;
}

/* Solve a x = b for a symmetric, tridiagonal matrix. Returns false if it has no single solution. */
static bool solve_bending(const double diagonal[3], const double beside[2], const double b[3],
			  struct bending *out)
{
	const double low = beside[0] / diagonal[0];
	const double middle = diagonal[1] - low * beside[0];
	const double lower = beside[1] / middle;
	const double last = diagonal[2] - lower * beside[1];
	const double least = 1e-12 * diagonal[0];
	if (!(diagonal[0] > 0) || !(middle > least) || !(last > least))
		return false;
	const double second = b[1] - low * b[0], third = b[2] - lower * second;
	out->vv = third / last;
	out->uv = (second - beside[1] * out->vv) / middle;
	out->uu = (b[0] - beside[0] * out->uv) / diagonal[0];
	return true;
}

/* Find the form that fits best to how the normal changes along the three edges. */
static bool bend_triangle(const struct gz_mesh *mesh, const struct triangle_shape *shape,
			  const struct surface_frame *frame, struct bending *out)
{
	double uu = 0, uv = 0, vv = 0, b[3] = { 0 };
	for (int i = 0; i < 3; i++) {
		const float *from = mesh->normals[shape->corners[(i + 1) % 3]];
		const float *to = mesh->normals[shape->corners[(i + 2) % 3]];
		double change[3];
		for (int axis = 0; axis < 3; axis++)
			change[axis] = (double)to[axis] - (double)from[axis];
		const double u = gz_dot3(shape->edges[i], frame->u);
		const double v = gz_dot3(shape->edges[i], frame->v);
		const double along_u = gz_dot3(change, frame->u);
		const double along_v = gz_dot3(change, frame->v);
		uu += u * u;
		uv += u * v;
		vv += v * v;
		b[0] += along_u * u;
		b[1] += along_u * v + along_v * u;
		b[2] += along_v * v;
	}
	return solve_bending((double[3]) { uu, uu + vv, vv }, (double[2]) { uv, uv }, b, out);
}

/* Turn a frame so that its normal becomes another. */
static void turn_frame(struct surface_frame *frame, const double normal[3])
{
	const double cosine = gz_dot3(frame->normal, normal);
	double *const along[2] = { frame->u, frame->v };
	for (int k = 0; k < 2; k++) {
		const double lifted = gz_dot3(along[k], normal);
		for (int axis = 0; axis < 3; axis++)
			along[k][axis] -=
				lifted * (frame->normal[axis] + normal[axis]) / (1 + cosine);
	}
}

/* The form of a triangle, seen in the frame of one of its vertices. */
static struct bending project_bending(struct bending bending, struct surface_frame from,
				      const struct surface_frame *to)
{
	if (gz_dot3(from.normal, to->normal) <=
	    -1 + 1e-9) { /* folded over: only the sides change */
		for (int axis = 0; axis < 3; axis++) {
			from.u[axis] = -from.u[axis];
			from.v[axis] = -from.v[axis];
		}
	} else {
		turn_frame(&from, to->normal);
	}
	const double u1 = gz_dot3(to->u, from.u), v1 = gz_dot3(to->u, from.v);
	const double u2 = gz_dot3(to->v, from.u), v2 = gz_dot3(to->v, from.v);
	return (struct bending) {
		.uu = bending.uu * u1 * u1 + 2 * bending.uv * u1 * v1 + bending.vv * v1 * v1,
		.uv = bending.uu * u1 * u2 + bending.uv * (u1 * v2 + u2 * v1) +
		      bending.vv * v1 * v2,
		.vv = bending.uu * u2 * u2 + 2 * bending.uv * u2 * v2 + bending.vv * v2 * v2,
	};
}

static void add_triangle(const struct gz_mesh *mesh, size_t triangle, struct vertex_sum *sums)
{
	struct triangle_shape shape;
	struct bending bending;
	if (!take_shape(mesh, triangle, &shape))
		return;
	const struct surface_frame frame = frame_of_triangle(mesh, &shape);
	if (!bend_triangle(mesh, &shape, &frame, &bending))
		return;
	for (int i = 0; i < 3; i++) {
		const uint32_t vertex = shape.corners[i];
		const struct surface_frame around = frame_of_normal(mesh->normals[vertex]);
		const struct bending part = project_bending(bending, frame, &around);
		const double area = shape.corner_areas[i];
		sums[vertex].bending.uu += area * part.uu;
		sums[vertex].bending.uv += area * part.uv;
		sums[vertex].bending.vv += area * part.vv;
		sums[vertex].area += area;
	}
}

/* The principal curvatures: a symmetric form of two rows turned until it is diagonal. */
static struct gz_curvature principal_of(const struct vertex_sum *sum, const float normal[3])
{
	const struct surface_frame frame = frame_of_normal(normal);
	const double scale = sum->area > 0 ? 1 / sum->area : 0;
	const double uu = sum->bending.uu * scale, uv = sum->bending.uv * scale,
		     vv = sum->bending.vv * scale;
	const double mean = (uu + vv) / 2, half = (uu - vv) / 2;
	const double spread = sqrt(half * half + uv * uv);
	/* Half of the angle of (half, uv), by the formulas of half angles. */
	const double turn = spread > 0 ? half / spread : 1;
	const double cosine = sqrt(fmax(0, (1 + turn) / 2));
	const double sine = copysign(sqrt(fmax(0, (1 - turn) / 2)), uv);
	struct gz_curvature curvature = { .greatest = (float)(mean + spread),
					  .least = (float)(mean - spread) };
	for (int axis = 0; axis < 3; axis++)
		curvature.along[axis] = (float)(cosine * frame.u[axis] + sine * frame.v[axis]);
	return curvature;
}

enum gz_result gz_mesh_curvatures(const struct gz_mesh *mesh, struct gz_curvature *out_curvatures)
{
	struct vertex_sum *sums = calloc(mesh->vertex_count + 1, sizeof *sums);
	if (!sums)
		return GZ_ERR_NO_MEM;
	for (size_t i = 0; i < mesh->triangle_count; i++)
		add_triangle(mesh, i, sums);
	for (size_t i = 0; i < mesh->vertex_count; i++)
		out_curvatures[i] = principal_of(&sums[i], mesh->normals[i]);
	free(sums);
	return GZ_OK;
}
