#include "render/mesh/label_net.h"

#include <inttypes.h>
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "base/portable.h"
#include "render/mesh/label_surfaces.h"
#include "render/mesh/mesh.h"

#define GZ_LOG_MODULE "labels"

/* Vertices that a thread takes at a time. */
enum { VERTICES_A_PART = 8192 };

/* Where a row of corners begins in the lists. */
struct net_row {
	uint64_t vertex, face;
};

struct net_job {
	const struct gz_label_index *index;
	uint64_t elements_max;
	struct gz_label_net *net;
	struct net_row *rows; /* one for each row of corners, and the ends */
	size_t width;         /* voxels of a row with the layer round it */
	size_t slice;         /* voxels of a slice, likewise */
	int corners[3];       /* along each axis: dims + 1 */
};

/* The four rows of voxels round a row of corners: of lower and upper y, by lower and upper z. A
 * corner i lies between their voxels i and i + 1. */
struct voxel_rows {
	const uint16_t *at[2][2]; /* [z][y] */
};

static struct voxel_rows rows_of(const struct net_job *job, size_t row)
{
	const size_t j = row % (size_t)job->corners[1], k = row / (size_t)job->corners[1];
	struct voxel_rows rows;
	for (size_t z = 0; z < 2; z++)
		for (size_t y = 0; y < 2; y++)
			rows.at[z][y] =
				job->index->labels + (k + z) * job->slice + (j + y) * job->width;
	return rows;
}

static bool column_same(const struct voxel_rows *rows, int x)
{
	const uint16_t first = rows->at[0][0][x];
	return rows->at[0][1][x] == first && rows->at[1][0][x] == first &&
	       rows->at[1][1][x] == first;
}

static bool has_vertex(const struct voxel_rows *rows, int i)
{
	return rows->at[0][0][i] != rows->at[0][0][i + 1] || !column_same(rows, i) ||
	       !column_same(rows, i + 1);
}

/* ---- counting ---- */

static void count_row(const struct net_job *job, size_t row)
{
	const struct voxel_rows rows = rows_of(job, row);
	const uint16_t *own = rows.at[0][0];
	struct net_row counted = { 0, 0 };
	bool before = column_same(&rows, 0);
	for (int i = 0; i < job->corners[0]; i++) {
		const bool after = column_same(&rows, i + 1);
		if (before && after && own[i] == own[i + 1])
			continue;
		before = after;
		counted.vertex++;
		counted.face += (uint64_t)(own[i] != own[i + 1]) +
				(uint64_t)(own[i] != rows.at[0][1][i]) +
				(uint64_t)(own[i] != rows.at[1][0][i]);
	}
	job->rows[row] = counted;
}

/* ---- vertices ---- */

/* The mean of the middles of the edges between the eight centres whose ends differ. */
static void place_vertex(const struct voxel_rows *rows, const int32_t corner[3], float out[3])
{
	float sum[3] = { 0, 0, 0 };
	int crossed = 0;
	for (int edge = 0; edge < 12; edge++) {
		/* Its axis, and where it lies along the two others. */
		const int axis = edge / 4, u = (axis + 1) % 3, v = (axis + 2) % 3;
		int low[3] = { 0, 0, 0 }, high[3];
		low[u] = edge & 1;
		low[v] = edge >> 1 & 1;
		memcpy(high, low, sizeof high);
		high[axis] = 1;
		if (rows->at[low[2]][low[1]][corner[0] + low[0]] ==
		    rows->at[high[2]][high[1]][corner[0] + high[0]])
			continue;
		crossed++;
		sum[u] += (float)low[u] - 0.5F;
		sum[v] += (float)low[v] - 0.5F;
	}
	for (int axis = 0; axis < 3; axis++)
		out[axis] = (float)corner[axis] + sum[axis] / (float)crossed;
}

static bool on_side(const int32_t corner[3], const int dims[3], int axis)
{
	return corner[axis] == 0 || corner[axis] == dims[axis];
}

static void write_vertices(const struct net_job *job, size_t row)
{
	const struct voxel_rows rows = rows_of(job, row);
	struct gz_label_net *net = job->net;
	size_t vertex = job->rows[row].vertex;
	const size_t end = job->rows[row + 1].vertex;
	for (int i = 0; vertex < end; i++) {
		if (!has_vertex(&rows, i))
			continue;
		int32_t *corner = net->corners[vertex];
		float *place = net->places[vertex++];
		corner[0] = i;
		corner[1] = (int32_t)(row % (size_t)job->corners[1]);
		corner[2] = (int32_t)(row / (size_t)job->corners[1]);
		place_vertex(&rows, corner, place);
		for (int axis = 0; axis < 3; axis++)
			if (on_side(corner, job->index->dims, axis))
				place[axis] = (float)corner[axis];
	}
}

/* ---- neighbours and faces ---- */

/* A walk along a row of vertices, beside another row. */
struct walk {
	size_t at, end;
};

static struct walk walk_along(const struct net_job *job, size_t row, bool there)
{
	return there ? (struct walk) { job->rows[row].vertex, job->rows[row + 1].vertex }
		     : (struct walk) { 0, 0 };
}

/* The vertex of the row at x, or the one before it; there must be one if it is used. */
static uint32_t vertex_at(const struct net_job *job, struct walk *walk, int32_t x)
{
	while (walk->at < walk->end && job->net->corners[walk->at][0] < x)
		walk->at++;
	return walk->at < walk->end && job->net->corners[walk->at][0] == x ? (uint32_t)walk->at
									   : GZ_LABEL_NO_VERTEX;
}

/* How many labels meet at an edge of the grid, by the four voxels round it: 1, 2, or 3 for more. */
static int labels_at_edge(uint16_t a, uint16_t b, uint16_t c, uint16_t d)
{
	const uint16_t other = a != b ? b : a != c ? c : d;
	if (other == a)
		return 1;
	return (b == a || b == other) && (c == a || c == other) && (d == a || d == other) ? 2 : 3;
}

/* Which edges lead to neighbours. On a border, a curve along which three or more labels meet, they
 * are those of the border alone: the sheets that meet there do not pull it to and fro, and it
 * becomes as smooth as they are. */
static void choose_edges(const int labels[6], bool out_edges[6])
{
	int border = 0;
	for (int side = 0; side < 6; side++)
		border += labels[side] > 2;
	for (int side = 0; side < 6; side++)
		out_edges[side] = labels[side] > (border >= 2 ? 2 : 1);
}

/* Rows beside a row of vertices: of lower and upper y, of lower and upper z, of both lower. */
struct walks {
	struct walk low_y, high_y, low_z, high_z, low_both;
};

static void write_neighbours(const struct net_job *job, const struct voxel_rows *rows,
			     size_t vertex, struct walks *walks)
{
	const struct gz_label_net *net = job->net;
	const int32_t i = net->corners[vertex][0];
	const uint16_t *const *low = rows->at[0], *const *high = rows->at[1];
	const int labels[6] = {
		labels_at_edge(low[0][i], low[1][i], high[0][i], high[1][i]),
		labels_at_edge(low[0][i + 1], low[1][i + 1], high[0][i + 1], high[1][i + 1]),
		labels_at_edge(low[0][i], low[0][i + 1], high[0][i], high[0][i + 1]),
		labels_at_edge(low[1][i], low[1][i + 1], high[1][i], high[1][i + 1]),
		labels_at_edge(low[0][i], low[0][i + 1], low[1][i], low[1][i + 1]),
		labels_at_edge(high[0][i], high[0][i + 1], high[1][i], high[1][i + 1]),
	};
	const uint32_t beside[6] = {
		(uint32_t)vertex - 1,
		(uint32_t)vertex + 1,
		vertex_at(job, &walks->low_y, i),
		vertex_at(job, &walks->high_y, i),
		vertex_at(job, &walks->low_z, i),
		vertex_at(job, &walks->high_z, i),
	};
	bool edges[6];
	choose_edges(labels, edges);
	for (int side = 0; side < 6; side++)
		net->neighbours[vertex][side] = edges[side] ? beside[side] : GZ_LABEL_NO_VERTEX;
}

static struct gz_label_face *put_face(struct gz_label_face *face, uint16_t lower, uint16_t upper,
				      const uint32_t corners[4])
{
	memcpy(face->corners, corners, sizeof face->corners);
	face->labels[0] = lower;
	face->labels[1] = upper;
	return face + 1;
}

/* The faces of voxel (i, j, k) of which the vertex is the last corner: towards +x, +y and +z. Where
 * a face is, all four of its corners have vertices; those at i - 1 are next to those at i. */
static struct gz_label_face *write_vertex_faces(const struct voxel_rows *rows, int32_t i,
						uint32_t vertex, const struct walks *walks,
						struct gz_label_face *face)
{
	const uint16_t own = rows->at[0][0][i], x = rows->at[0][0][i + 1];
	const uint16_t y = rows->at[0][1][i], z = rows->at[1][0][i];
	const uint32_t low_y = (uint32_t)walks->low_y.at, low_z = (uint32_t)walks->low_z.at;
	if (own != x)
		face = put_face(
			face, own, x,
			(const uint32_t[]) { (uint32_t)walks->low_both.at, low_z, vertex, low_y });
	if (own != y)
		face = put_face(face, own, y,
				(const uint32_t[]) { low_z - 1, vertex - 1, vertex, low_z });
	if (own != z)
		face = put_face(face, own, z,
				(const uint32_t[]) { low_y - 1, low_y, vertex, vertex - 1 });
	return face;
}

static void write_faces(const struct net_job *job, size_t row)
{
	const struct voxel_rows rows = rows_of(job, row);
	const size_t height = (size_t)job->corners[1], j = row % height, k = row / height;
	const size_t last = (size_t)job->corners[2] - 1;
	struct gz_label_face *face = job->net->faces + job->rows[row].face;
	struct walks walks = {
		.low_y = walk_along(job, row - 1, j > 0),
		.high_y = walk_along(job, row + 1, j + 1 < height),
		.low_z = walk_along(job, row - height, k > 0),
		.high_z = walk_along(job, row + height, k < last),
		.low_both = walk_along(job, row - height - 1, j > 0 && k > 0),
	};
	for (size_t vertex = job->rows[row].vertex; vertex < job->rows[row + 1].vertex; vertex++) {
		const int32_t i = job->net->corners[vertex][0];
		write_neighbours(job, &rows, vertex, &walks);
		(void)vertex_at(job, &walks.low_both, i);
		face = write_vertex_faces(&rows, i, (uint32_t)vertex, &walks, face);
	}
}

/* ---- all rows ---- */

/* What is done to a row. */
typedef void net_step(const struct net_job *job, size_t row);

struct step {
	const struct net_job *job;
	net_step *step;
};

static void do_slice(void *user, size_t part, int worker)
{
	const struct step *step = user;
	const size_t height = (size_t)step->job->corners[1];
	(void)worker;
	for (size_t j = 0; j < height; j++)
		step->step(step->job, part * height + j);
}

static void do_rows(const struct net_job *job, struct gz_workers *workers, net_step *what)
{
	struct step step = { job, what };
	gz_label_run(workers, do_slice, &step, (size_t)job->corners[2]);
}

/* Turn the counts of rows into the places of their first elements. */
static enum gz_result sum_net_rows(struct net_job *job, size_t rows, const struct gz_log *log)
{
	struct net_row sum = { 0, 0 };
	for (size_t row = 0; row <= rows; row++) {
		const struct net_row more = job->rows[row];
		job->rows[row] = sum;
		sum.vertex += more.vertex;
		sum.face += more.face;
	}
	job->net->vertex_count = sum.vertex;
	job->net->face_count = sum.face;
	if (sum.vertex <= job->elements_max && sum.face <= job->elements_max)
		return GZ_OK;
	gz_err(log,
	       "the surfaces of labels have %" PRIu64 " vertices and %" PRIu64
	       " faces, more than %" PRIu64 "; use a smaller volume",
	       sum.vertex, sum.face, job->elements_max);
	return GZ_ERR_FULL;
}

static bool allocate_net(struct gz_label_net *net)
{
	const size_t vertices = net->vertex_count + 1, faces = net->face_count + 1;
	const size_t vertex_bytes =
		sizeof *net->corners + sizeof *net->places + sizeof *net->neighbours;
	if (!gz_memory_fits_machine(vertices * vertex_bytes + faces * sizeof *net->faces))
		return false;
	net->corners = malloc(vertices * sizeof *net->corners);
	net->places = malloc(vertices * sizeof *net->places);
	net->neighbours = malloc(vertices * sizeof *net->neighbours);
	net->faces = malloc(faces * sizeof *net->faces);
	return net->corners && net->places && net->neighbours && net->faces;
}

enum gz_result gz_label_net_make(const struct gz_label_index *index, uint64_t elements_max,
				 struct gz_workers *workers, const struct gz_log *log,
				 struct gz_label_net *out_net)
{
	struct gz_label_net net = { 0 };
	struct net_job job = { .index = index, .elements_max = elements_max, .net = &net };
	for (int axis = 0; axis < 3; axis++)
		job.corners[axis] = index->dims[axis] + 1;
	job.width = (size_t)index->dims[0] + 2;
	job.slice = job.width * ((size_t)index->dims[1] + 2);
	const size_t rows = (size_t)job.corners[1] * (size_t)job.corners[2];
	job.rows = calloc(rows + 1, sizeof *job.rows);
	if (!job.rows)
		return GZ_ERR_NO_MEM;
	do_rows(&job, workers, count_row);
	enum gz_result result = sum_net_rows(&job, rows, log);
	if (result == GZ_OK && !allocate_net(&net))
		result = GZ_ERR_NO_MEM;
	if (result == GZ_OK) {
		do_rows(&job, workers, write_vertices);
		do_rows(&job, workers, write_faces);
		*out_net = net;
	} else {
		gz_label_net_free(&net);
	}
	free(job.rows);
	return result;
}

void gz_label_net_free(struct gz_label_net *net)
{
	free(net->corners);
	free(net->places);
	free(net->neighbours);
	free(net->faces);
	*net = (struct gz_label_net) { 0 };
}

/* ---- smoothing ---- */

/* The filter is a sum of Chebyshev polynomials T_n of 1 - K/2, where K takes from each vertex the
 * mean of its neighbours: Taubin, Zhang and Golub, "Optimal surface smoothing as filter design",
 * ECCV 1996. A wave for which K is k = 2 - 2 cos(a) is multiplied by the sum of weights cos(n a):
 * 1 below an angle, 0 above it, smoothed by a window. */
enum { DEGREE_MAX = 2 * GZ_LABEL_SMOOTHING_MAX };

/* Half the width of the step that Blackman's window makes is 6 pi by 2 degree + 1 (Harris, "On the
 * use of windows for harmonic analysis with the discrete Fourier transform", 1978). The step lies
 * so far from 0, and by KEPT_ANGLE more: the angle of a ball of 36 voxels, which keeps its size. */
#define WINDOW_HALF_WIDTH (6 * PI)
#define KEPT_ANGLE        0.04
#define PI                3.14159265358979323846

struct label_filter {
	int degree;
	double weights[DEGREE_MAX + 1];
};

static struct label_filter make_filter(int pairs)
{
	struct label_filter filter = { .degree = 2 * pairs };
	double *const weights = filter.weights;
	double sum = 0;
	const double step = fmin(PI, WINDOW_HALF_WIDTH / (2 * filter.degree + 1) + KEPT_ANGLE);
	for (int n = 0; n <= filter.degree; n++) {
		const double turn = n * PI / (filter.degree + 1);
		const double window =
			0.42 + 0.5 * gz_portable_cos(turn) + 0.08 * gz_portable_cos(2 * turn);
		weights[n] =
			window * (n == 0 ? step / PI : 2 * gz_portable_sin(n * step) / (n * PI));
		sum += weights[n];
	}
	for (int n = 0; n <= filter.degree; n++)
		weights[n] /= sum;
	return filter;
}

/* One step: the next polynomial of all places from the two before it. In doubles, as the terms of
 * the sum are large and cancel. */
struct smoothing {
	const struct gz_label_net *net;
	const int *dims;
	const double (*from)[3]; /* the polynomial before */
	double (*to)[3];         /* the one before that, which the next one replaces */
	double (*sum)[3];
	double weight; /* of the next one in the sum */
	bool first;    /* the next one is T_1 */
};

/* How far the mean of a vertex's neighbours lies from it. On a side of the box it stays there. */
static void mean_apart(const struct smoothing *smoothing, size_t vertex, double out[3])
{
	const struct gz_label_net *net = smoothing->net;
	double sum[3] = { 0, 0, 0 };
	int count = 0;
	for (int side = 0; side < 6; side++) {
		const uint32_t other = net->neighbours[vertex][side];
		if (other == GZ_LABEL_NO_VERTEX)
			continue;
		count++;
		for (int axis = 0; axis < 3; axis++)
			sum[axis] += smoothing->from[other][axis];
	}
	for (int axis = 0; axis < 3; axis++)
		out[axis] = on_side(net->corners[vertex], smoothing->dims, axis)
				    ? 0
				    : sum[axis] / count - smoothing->from[vertex][axis];
}

static void smooth_part(void *user, size_t part, int worker)
{
	const struct smoothing *smoothing = user;
	const size_t first = part * VERTICES_A_PART, end = first + VERTICES_A_PART;
	(void)worker;
	for (size_t i = first; i < end && i < smoothing->net->vertex_count; i++) {
		double apart[3];
		mean_apart(smoothing, i, apart);
		for (int axis = 0; axis < 3; axis++) {
			const double old = smoothing->from[i][axis];
			const double next =
				smoothing->first ? old + 0.5 * apart[axis]
						 : 2 * old + apart[axis] - smoothing->to[i][axis];
			smoothing->to[i][axis] = next;
			smoothing->sum[i][axis] += smoothing->weight * next;
		}
	}
}

static double kept_within(double value, double least, double greatest)
{
	return value < least ? least : value > greatest ? greatest : value;
}

/* The smoothed places, but none farther from its corner than the reach. */
static void take_places(struct gz_label_net *net, const int dims[3], const double (*sum)[3],
			double reach)
{
	for (size_t i = 0; i < net->vertex_count; i++)
		for (int axis = 0; axis < 3; axis++) {
			const double corner = net->corners[i][axis];
			net->places[i][axis] =
				on_side(net->corners[i], dims, axis)
					? (float)corner
					: (float)kept_within(sum[i][axis], corner - reach,
							     corner + reach);
		}
}

static void apply_filter(struct gz_label_net *net, const int dims[3],
			 const struct label_filter *filter, struct gz_workers *workers,
			 double (*places[3])[3])
{
	const size_t parts = (net->vertex_count + VERTICES_A_PART - 1) / VERTICES_A_PART;
	double(*now)[3] = places[0], (*before)[3] = places[1], (*sum)[3] = places[2];
	for (size_t i = 0; i < net->vertex_count; i++)
		for (int axis = 0; axis < 3; axis++) {
			now[i][axis] = (double)net->places[i][axis];
			sum[i][axis] = filter->weights[0] * now[i][axis];
		}
	for (int n = 1; n <= filter->degree; n++) {
		struct smoothing smoothing = {
			.net = net,
			.dims = dims,
			.from = (const double(*)[3])now,
			.to = before,
			.sum = sum,
			.weight = filter->weights[n],
			.first = n == 1,
		};
		gz_label_run(workers, smooth_part, &smoothing, parts);
		double(*const made)[3] = before;
		before = now;
		now = made;
	}
}

enum gz_result gz_label_net_smooth(struct gz_label_net *net, const int dims[3],
				   const struct gz_label_look *look, struct gz_workers *workers)
{
	if (look->smoothing == 0)
		return GZ_OK;
	const size_t count = net->vertex_count + 1;
	double(*room)[3] = malloc(3 * count * sizeof *room);
	if (!room)
		return GZ_ERR_NO_MEM;
	double(*places[3])[3] = { room, room + count, room + 2 * count };
	const struct label_filter filter = make_filter(look->smoothing);
	apply_filter(net, dims, &filter, workers, places);
	take_places(net, dims, (const double(*)[3])places[2], look->reach);
	free(room);
	return GZ_OK;
}
