#include "render/illustration/stipple_points.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "render/illustration/stipple_project.h"
#include "render/illustration/stipple_tiles.h"
#include "render/illustration/stipple_tone.h"

enum {
	CLUSTER_POINTS = 256, /* chosen: culling costs little, and few of a cluster are in vain */
	PART_CLUSTERS = 16,
	KEY_BITS = 10, /* of each axis */
	DIGIT_BITS = 10,
};

#define PI_F 3.14159265F

/* Discs never grow further for want of points. Chosen: what is larger is no stipple. */
#define GROWTH_MAX 8.0F

/* Spreads the lowest ten bits three apart, for numbers along a Z-order curve (Morton 1966). */
static uint32_t spread_bits(uint32_t x)
{
	x = (x | x << 16) & 0x030000ffU;
	x = (x | x << 8) & 0x0300f00fU;
	x = (x | x << 4) & 0x030c30c3U;
	return (x | x << 2) & 0x09249249U;
}

static void make_keys(const float (*places)[3], size_t count, uint32_t *keys)
{
	float least[3], greatest[3], widest = 0;
	memcpy(least, places[0], sizeof least);
	memcpy(greatest, places[0], sizeof greatest);
	for (size_t i = 1; i < count; i++)
		for (int axis = 0; axis < 3; axis++) {
			least[axis] = fminf(least[axis], places[i][axis]);
			greatest[axis] = fmaxf(greatest[axis], places[i][axis]);
		}
	for (int axis = 0; axis < 3; axis++)
		widest = fmaxf(widest, greatest[axis] - least[axis]);
	const float scale = widest > 0 ? (float)((1 << KEY_BITS) - 1) / widest : 0;
	for (size_t i = 0; i < count; i++) {
		uint32_t key = 0;
		for (int axis = 0; axis < 3; axis++)
			key |= spread_bits((uint32_t)((places[i][axis] - least[axis]) * scale))
			       << axis;
		keys[i] = key;
	}
}

/* One pass of a radix sort: order[] by a digit of their keys, which keeps equal ones in order. */
static void sort_by_digit(const uint32_t *keys, int digit, size_t count, const uint32_t *order,
			  uint32_t *out_order)
{
	size_t ends[1 << DIGIT_BITS] = { 0 }, sum = 0;
	const uint32_t mask = (1U << DIGIT_BITS) - 1;
	for (size_t i = 0; i < count; i++)
		ends[keys[i] >> (DIGIT_BITS * digit) & mask]++;
	for (size_t value = 0; value <= mask; value++) {
		const size_t own = ends[value];
		ends[value] = sum;
		sum += own;
	}
	for (size_t i = 0; i < count; i++)
		out_order[ends[keys[order[i]] >> (DIGIT_BITS * digit) & mask]++] = order[i];
}

/* The number of each point in the order of clusters: neighbours together, and by rank within a
 * cluster. @param spare  as large as keys */
static void number_points(const float (*places)[3], size_t count, uint32_t *keys, uint32_t *order,
			  uint32_t *spare)
{
	make_keys(places, count, keys);
	for (size_t i = 0; i < count; i++)
		order[i] = (uint32_t)i;
	sort_by_digit(keys, 0, count, order, spare);
	sort_by_digit(keys, 1, count, spare, order);
	sort_by_digit(keys, 2, count, order, spare);
	for (size_t i = 0; i < count; i++)
		keys[spare[i]] = (uint32_t)(i / CLUSTER_POINTS); /* from now on, of a point */
	for (size_t i = 0; i < count; i += CLUSTER_POINTS)
		spare[i / CLUSTER_POINTS] = (uint32_t)i;
	for (size_t rank = 0; rank < count; rank++)
		order[rank] = spare[keys[rank]]++;
}

static void normal_of_triangle(const struct gz_mesh *mesh, uint32_t triangle, float out[3])
{
	const uint32_t *corners = mesh->triangles[triangle];
	double side[2][3];
	for (int axis = 0; axis < 3; axis++)
		for (int i = 0; i < 2; i++)
			side[i][axis] = (double)mesh->positions[corners[i + 1]][axis] -
					(double)mesh->positions[corners[0]][axis];
	double normal[3] = { side[0][1] * side[1][2] - side[0][2] * side[1][1],
			     side[0][2] * side[1][0] - side[0][0] * side[1][2],
			     side[0][0] * side[1][1] - side[0][1] * side[1][0] };
	const double length =
		sqrt(normal[0] * normal[0] + normal[1] * normal[1] + normal[2] * normal[2]);
	for (int axis = 0; axis < 3; axis++)
		out[axis] = length > 0 ? (float)(normal[axis] / length) : 0;
}

static struct gz_stipple_cluster bound_cluster(const struct gz_stipple_points *points, size_t first)
{
	const size_t left = points->count - first;
	struct gz_stipple_cluster cluster = { .first = (uint32_t)first, .spread = 1 };
	cluster.count = (uint32_t)(left < CLUSTER_POINTS ? left : CLUSTER_POINTS);
	float least[3] = { INFINITY, INFINITY, INFINITY };
	float greatest[3] = { -INFINITY, -INFINITY, -INFINITY };
	for (size_t i = first; i < first + cluster.count; i++)
		for (int axis = 0; axis < 3; axis++) {
			least[axis] = fminf(least[axis], points->places[i][axis]);
			greatest[axis] = fmaxf(greatest[axis], points->places[i][axis]);
			cluster.axis[axis] += points->normals[i][axis];
		}
	const float length = sqrtf(gz_stipple_dot(cluster.axis, cluster.axis));
	for (int axis = 0; axis < 3; axis++) {
		cluster.centre[axis] = least[axis] + (greatest[axis] - least[axis]) / 2;
		cluster.axis[axis] = length > 0 ? cluster.axis[axis] / length : 0;
	}
	for (size_t i = first; i < first + cluster.count; i++) {
		float away[3];
		for (int axis = 0; axis < 3; axis++)
			away[axis] = points->places[i][axis] - cluster.centre[axis];
		cluster.reach = fmaxf(cluster.reach, sqrtf(gz_stipple_dot(away, away)));
		cluster.spread =
			fminf(cluster.spread, gz_stipple_dot(points->normals[i], cluster.axis));
	}
	return cluster;
}

/* A ball around the balls of all clusters. */
static void bound_points(struct gz_stipple_points *points)
{
	float least[3] = { INFINITY, INFINITY, INFINITY };
	float greatest[3] = { -INFINITY, -INFINITY, -INFINITY };
	for (size_t i = 0; i < points->cluster_count; i++)
		for (int axis = 0; axis < 3; axis++) {
			const struct gz_stipple_cluster *cluster = &points->clusters[i];
			least[axis] = fminf(least[axis], cluster->centre[axis] - cluster->reach);
			greatest[axis] =
				fmaxf(greatest[axis], cluster->centre[axis] + cluster->reach);
		}
	float half[3];
	for (int axis = 0; axis < 3; axis++) {
		half[axis] = (greatest[axis] - least[axis]) / 2;
		points->centre[axis] = least[axis] + half[axis];
	}
	points->reach = sqrtf(gz_stipple_dot(half, half));
}

static void fill_points(const struct gz_mesh *mesh, const struct gz_mesh_points *from,
			const float (*places)[3], const uint32_t *numbers,
			struct gz_stipple_points *points)
{
	for (size_t rank = 0; rank < from->count; rank++) {
		const size_t number = numbers[rank];
		memcpy(points->places[number], places[rank], sizeof places[rank]);
		normal_of_triangle(mesh, from->points[rank].triangle, points->normals[number]);
		points->ranks[number] = (uint32_t)rank;
	}
	for (size_t i = 0; i < points->cluster_count; i++)
		points->clusters[i] = bound_cluster(points, i * CLUSTER_POINTS);
	bound_points(points);
}

static bool allocate_points(size_t count, struct gz_stipple_points *points)
{
	points->count = count;
	points->cluster_count = (count + CLUSTER_POINTS - 1) / CLUSTER_POINTS;
	points->places = malloc(count * sizeof *points->places);
	points->normals = malloc(count * sizeof *points->normals);
	points->ranks = malloc(count * sizeof *points->ranks);
	points->clusters = malloc(points->cluster_count * sizeof *points->clusters);
	return points->places && points->normals && points->ranks && points->clusters;
}

enum gz_result gz_stipple_points_make(const struct gz_mesh *mesh, const struct gz_mesh_points *from,
				      struct gz_stipple_points *out_points)
{
	struct gz_stipple_points points = { .area_mm2 = from->area_mm2 };
	if (from->count == 0) {
		*out_points = points;
		return GZ_OK;
	}
	const size_t count = from->count;
	float(*places)[3] = malloc(count * sizeof *places);
	uint32_t *numbers = calloc(3 * count, sizeof *numbers);
	const bool complete = places && numbers && allocate_points(count, &points);
	if (complete) {
		for (size_t i = 0; i < count; i++)
			gz_mesh_point_place(mesh, &from->points[i], places[i]);
		number_points((const float(*)[3])places, count, numbers + count, numbers,
			      numbers + 2 * count);
		fill_points(mesh, from, (const float(*)[3])places, numbers, &points);
		*out_points = points;
	} else {
		gz_stipple_points_free(&points);
	}
	free(places);
	free(numbers);
	return complete ? GZ_OK : GZ_ERR_NO_MEM;
}

/* Choosing the points of a picture. */
struct stipple_choice {
	const struct gz_stipple_points *points;
	struct gz_stipple_projector projector;
	float radius;                  /* of discs at the gaze, px */
	float area_mm2;                /* of the mesh */
	struct gz_stipple_disc *discs; /* a place for each point */
	uint32_t *counts;              /* of discs, by cluster */
	struct gz_stipple_tiles tiles; /* of the picture */
};

/* The disc of a point, if it shows. */
static bool disc_of_point(const struct stipple_choice *choice, size_t number,
			  struct gz_stipple_disc *out_disc)
{
	const struct gz_stipple_points *points = choice->points;
	const struct gz_stipple_projector *projector = &choice->projector;
	struct gz_stipple_spot spot;
	if (!gz_stipple_project(projector, points->places[number], points->normals[number],
				&spot) ||
	    !gz_stipple_spot_near(projector, &spot))
		return false;
	const float radius =
		choice->radius * gz_stipple_scale_at(projector->view->scale, spot.x, spot.y);
	const float ink = gz_stipple_ink_at(projector, &spot);
	const float density = gz_stipple_density(ink, spot.facing, radius);
	const float limit =
		density / (PI_F * radius * radius) * spot.px2_per_mm2 * choice->area_mm2;
	if (!((float)points->ranks[number] + 0.5F < limit) ||
	    !gz_stipple_spot_seen(projector, points->normals[number], &spot))
		return false;
	const float wanting = limit / (float)points->count;
	const float growth = wanting > 1 ? fminf(sqrtf(wanting), GROWTH_MAX) : 1;
	*out_disc = (struct gz_stipple_disc) { spot.x, spot.y, radius * growth };
	return true;
}

/* The greatest cosine between a normal of a cluster and the way to the eye; 0 or less if all of it
 * is seen from behind. Its normals are within an angle of its axis. */
static float facing_of_cluster(const struct gz_stipple_projector *projector,
			       const struct gz_stipple_cluster *cluster, const float from[3])
{
	const bool flat = projector->orthographic;
	const float *way = flat ? projector->direction : from;
	const float length = sqrtf(gz_stipple_dot(way, way));
	const float along = -gz_stipple_dot(cluster->axis, way) / length;
	const float margin = 1e-4F; /* well above rounding errors */
	/* the way to the eye turns by this much within the cluster, or less */
	const float turn = flat ? 0 : cluster->reach / (length - cluster->reach);
	if (projector->fronts <= 0 || !(turn >= 0) || along >= cluster->spread)
		return 1;
	const float across = sqrtf(fmaxf(0, 1 - along * along));
	const float spread = sqrtf(fmaxf(0, 1 - cluster->spread * cluster->spread));
	return fminf(along * cluster->spread + across * spread + turn + margin, 1);
}

/* The largest px² per mm² of a cluster, seen straight on; 0 behind the eye. */
static float largest_in_cluster(const struct gz_stipple_projector *projector, const float from[3],
				float reach)
{
	if (projector->orthographic)
		return projector->spread * projector->direction_scale;
	const float *row = projector->rows[2];
	const float depth = gz_stipple_dot(row, from);
	const float margin = reach * sqrtf(gz_stipple_dot(row, row));
	const float nearest = depth - margin;
	if (depth + margin <= 0)
		return 0;
	if (nearest <= 0)
		return INFINITY;
	const float distance = sqrtf(gz_stipple_dot(from, from)) + reach;
	return projector->spread * distance / (nearest * nearest * nearest);
}

/* The rank from which on no point of a cluster can show. */
static float limit_of_cluster(const struct stipple_choice *choice,
			      const struct gz_stipple_cluster *cluster)
{
	const struct gz_stipple_projector *projector = &choice->projector;
	struct gz_stipple_ball ball = { .reach = 1.0001F * cluster->reach };
	struct gz_stipple_bound bound;
	for (int axis = 0; axis < 3; axis++)
		ball.from[axis] = cluster->centre[axis] - projector->origin[axis];
	const float facing = facing_of_cluster(projector, cluster, ball.from);
	if (!(facing > 0) || !gz_stipple_tiles_bound(&choice->tiles, &ball, &bound))
		return 0;
	const float radius = choice->radius * bound.scale;
	return 1.001F * gz_stipple_density_most(bound.ink, facing) / (PI_F * radius * radius) *
	       largest_in_cluster(projector, ball.from, ball.reach) * choice->area_mm2;
}

static void choose_in_clusters(void *user, size_t part, int worker)
{
	(void)worker;
	const struct stipple_choice *choice = user;
	const struct gz_stipple_points *points = choice->points;
	const size_t begin = part * PART_CLUSTERS;
	const size_t end = begin + PART_CLUSTERS < points->cluster_count ? begin + PART_CLUSTERS
									 : points->cluster_count;
	for (size_t i = begin; i < end; i++) {
		const struct gz_stipple_cluster *cluster = &points->clusters[i];
		const float limit = limit_of_cluster(choice, cluster);
		struct gz_stipple_disc *discs = choice->discs + cluster->first;
		uint32_t count = 0;
		for (size_t k = cluster->first; k < cluster->first + cluster->count; k++) {
			if (!((float)points->ranks[k] < limit))
				break;
			count += disc_of_point(choice, k, &discs[count]);
		}
		choice->counts[i] = count;
	}
}

static bool choice_make(const struct gz_stipple_points *points, const struct gz_stipple_view *view,
			struct stipple_choice *out_choice)
{
	struct stipple_choice choice = { .points = points,
					 .radius = (float)view->size_px,
					 .area_mm2 = (float)points->area_mm2 };
	if (!gz_stipple_view_valid(view) || !gz_stipple_projector_make(view, &choice.projector))
		return false;
	*out_choice = choice;
	return true;
}

static enum gz_result reserve_discs(struct gz_stipple_discs *discs, size_t more)
{
	const size_t wanted = discs->count + more;
	if (wanted <= discs->capacity)
		return GZ_OK;
	struct gz_stipple_disc *grown = realloc(discs->discs, wanted * sizeof *grown);
	if (!grown)
		return GZ_ERR_NO_MEM;
	discs->discs = grown;
	discs->capacity = wanted;
	return GZ_OK;
}

/* Moves the discs of all clusters together. */
static void gather_discs(const struct stipple_choice *choice, struct gz_stipple_discs *discs)
{
	const struct gz_stipple_points *points = choice->points;
	for (size_t i = 0; i < points->cluster_count; i++) {
		memmove(discs->discs + discs->count, choice->discs + points->clusters[i].first,
			choice->counts[i] * sizeof *discs->discs);
		discs->count += choice->counts[i];
	}
}

/* The bounds of the tiles that all points cover. */
static enum gz_result make_tiles(struct stipple_choice *choice, struct gz_workers *workers)
{
	struct gz_stipple_ball ball = { .reach = 1.0001F * choice->points->reach };
	for (int axis = 0; axis < 3; axis++)
		ball.from[axis] = choice->points->centre[axis] - choice->projector.origin[axis];
	return gz_stipple_tiles_make(&choice->projector, &ball, workers, &choice->tiles);
}

enum gz_result gz_stipple_choose(const struct gz_stipple_points *points,
				 const struct gz_stipple_view *view, struct gz_workers *workers,
				 struct gz_stipple_discs *discs)
{
	struct stipple_choice choice;
	if (!choice_make(points, view, &choice))
		return GZ_ERR_INVAL;
	if (points->count == 0)
		return GZ_OK;
	choice.counts = calloc(points->cluster_count, sizeof *choice.counts);
	if (!choice.counts || reserve_discs(discs, points->count) != GZ_OK ||
	    make_tiles(&choice, workers) != GZ_OK) {
		free(choice.counts);
		return GZ_ERR_NO_MEM;
	}
	choice.discs = discs->discs + discs->count;
	const size_t parts = (points->cluster_count + PART_CLUSTERS - 1) / PART_CLUSTERS;
	if (workers)
		gz_workers_run(workers, choose_in_clusters, &choice, parts);
	else
		for (size_t part = 0; part < parts; part++)
			choose_in_clusters(&choice, part, 0);
	gather_discs(&choice, discs);
	gz_stipple_tiles_free(&choice.tiles);
	free(choice.counts);
	return GZ_OK;
}

bool gz_stipple_shows(const struct gz_stipple_points *points, const struct gz_stipple_view *view,
		      size_t number)
{
	struct stipple_choice choice;
	struct gz_stipple_disc disc;
	return choice_make(points, view, &choice) && disc_of_point(&choice, number, &disc);
}

void gz_stipple_points_free(struct gz_stipple_points *points)
{
	free(points->places);
	free(points->normals);
	free(points->ranks);
	free(points->clusters);
	*points = (struct gz_stipple_points) { 0 };
}

void gz_stipple_discs_free(struct gz_stipple_discs *discs)
{
	free(discs->discs);
	*discs = (struct gz_stipple_discs) { 0 };
}
