#include "render/mesh/distance/mesh_distance.h"

#include <math.h>
#include <stdbool.h>

#ifdef GZ_EMBREE_4
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

#include "base/vector.h"

#define GZ_LOG_MODULE "mesh"

/* Points of a part of the work. Chosen: a part takes about a millisecond. */
enum { DISTANCE_PART = 512 };

/* All points, and where they look. */
struct distance_job {
	const struct gz_mesh *target;
	RTCScene tree;
	const float (*places)[3];
	size_t count;
	float *distances_mm;
};

/* The nearest triangle of one point so far. */
struct nearest_search {
	const struct gz_mesh *target;
	double place[3];
	double distance2; /* mm² */
};

static double squared_length(const double v[3])
{
	return gz_dot3(v, v);
}

/* Squared distance of the origin from the segment that begins at @p from and runs along @p along.
 */
static double segment_distance2(const double from[3], const double along[3])
{
	const double length2 = squared_length(along);
	const double at = length2 > 0 ? fmin(fmax(-gz_dot3(from, along) / length2, 0), 1) : 0;
	double nearest[3];
	for (int axis = 0; axis < 3; axis++)
		nearest[axis] = from[axis] + at * along[axis];
	return squared_length(nearest);
}

/* Squared distance of the origin from a triangle: from its plane if the origin lies above or below
 * it, otherwise from the nearest edge. */
static double triangle_distance2(const double corners[3][3])
{
	double edges[3][3], normal[3], least = INFINITY;
	bool within = true;
	for (int i = 0; i < 3; i++)
		for (int axis = 0; axis < 3; axis++)
			edges[i][axis] = corners[(i + 1) % 3][axis] - corners[i][axis];
	gz_cross3(edges[0], edges[1], normal);
	const double area2 = squared_length(normal);
	for (int i = 0; i < 3; i++) {
		double inwards[3];
		gz_cross3(normal, edges[i], inwards);
		within = within && gz_dot3(inwards, corners[i]) <= 0;
		least = fmin(least, segment_distance2(corners[i], edges[i]));
	}
	if (!within || !(area2 > 0))
		return least;
	const double height = gz_dot3(normal, corners[0]);
	return fmin(least, height * height / area2);
}

/* Embree asks this of each triangle that may be nearer than the query's radius. */
static bool consider_triangle(struct RTCPointQueryFunctionArguments *arguments)
{
	struct nearest_search *search = arguments->userPtr;
	const uint32_t *vertices = search->target->triangles[arguments->primID];
	double corners[3][3];
	for (int i = 0; i < 3; i++)
		for (int axis = 0; axis < 3; axis++)
			corners[i][axis] = (double)search->target->positions[vertices[i]][axis] -
					   search->place[axis];
	const double distance2 = triangle_distance2(corners);
	if (!(distance2 < search->distance2))
		return false;
	search->distance2 = distance2;
	arguments->query->radius = nextafterf((float)sqrt(distance2), INFINITY);
	return true;
}

static float distance_of(const struct distance_job *job, const float place[3])
{
	struct nearest_search search = { .target = job->target, .distance2 = INFINITY };
	struct RTCPointQuery query = {
		.x = place[0], .y = place[1], .z = place[2], .radius = INFINITY
	};
	struct RTCPointQueryContext context;
	for (int axis = 0; axis < 3; axis++)
		search.place[axis] = (double)place[axis];
	rtcInitPointQueryContext(&context);
	(void)rtcPointQuery(job->tree, &query, &context, consider_triangle, &search);
	return (float)sqrt(search.distance2);
}

static void distance_part(void *user, size_t part, int worker)
{
	const struct distance_job *job = user;
	const size_t begin = part * DISTANCE_PART, rest = job->count - begin;
	(void)worker;
	for (size_t i = begin; i < begin + (rest < DISTANCE_PART ? rest : DISTANCE_PART); i++)
		job->distances_mm[i] = distance_of(job, job->places[i]);
}

static void measure_all(struct distance_job *job, struct gz_workers *workers)
{
	const size_t parts = (job->count + DISTANCE_PART - 1) / DISTANCE_PART;
	if (workers)
		gz_workers_run(workers, distance_part, job, parts);
	for (size_t part = 0; !workers && part < parts; part++)
		distance_part(job, part, 0);
}

/* The arrays of a mesh have the padding that Embree asks for. */
static void add_triangles(RTCDevice device, RTCScene tree, const struct gz_mesh *target)
{
	RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
	if (!geometry)
		return;
	rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
				   target->positions, 0, sizeof target->positions[0],
				   target->vertex_count);
	rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
				   target->triangles, 0, sizeof target->triangles[0],
				   target->triangle_count);
	rtcCommitGeometry(geometry);
	rtcAttachGeometry(tree, geometry);
	rtcReleaseGeometry(geometry);
}

static enum gz_result measure_by(RTCDevice device, struct distance_job *job,
				 struct gz_workers *workers, const struct gz_log *log)
{
	job->tree = rtcNewScene(device);
	if (job->tree) {
		add_triangles(device, job->tree, job->target);
		rtcCommitScene(job->tree);
	}
	const enum RTCError error = rtcGetDeviceError(device);
	const bool built = job->tree && error == RTC_ERROR_NONE;
	if (built)
		measure_all(job, workers);
	else
		gz_err(log,
		       "Embree cannot build the tree of triangles (error %d); close other programs",
		       (int)error);
	if (job->tree)
		rtcReleaseScene(job->tree);
	return built ? GZ_OK : GZ_ERR_NO_MEM;
}

enum gz_result gz_mesh_distances(const struct gz_mesh *target, const float (*places)[3],
				 size_t count, struct gz_workers *workers, const struct gz_log *log,
				 float *out_distances_mm)
{
	struct distance_job job = {
		.target = target, .places = places, .count = count, .distances_mm = out_distances_mm
	};
	if (target->triangle_count == 0) {
		for (size_t i = 0; i < count; i++)
			out_distances_mm[i] = INFINITY;
		return GZ_OK;
	}
	RTCDevice device = rtcNewDevice("threads=1");
	if (!device) {
		gz_err(log, "Embree does not start (error %d)", (int)rtcGetDeviceError(NULL));
		return GZ_ERR_UNSUPPORTED;
	}
	const enum gz_result result = measure_by(device, &job, workers, log);
	rtcReleaseDevice(device);
	return result;
}
