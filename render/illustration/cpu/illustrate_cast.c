#include "render/illustration/cpu/illustrate_cast.h"

#include <math.h>
#include <stdalign.h>
#include <stdbool.h>

enum { RAYS = GZ_ILLUSTRATE_RAYS, PARAMETERS_MAX = 6 };

#define NO_LOOK UINT32_MAX

/* What shading reads of each ray's end. */
struct shading_lanes {
	float normals[GZ_SHADING_LEVELS][3][RAYS];
	float viewer[3][RAYS];
	float greatest[RAYS], least[RAYS]; /* curvatures, as shares of the mesh's scale */
	float side[RAYS];                  /* -1 where the surface is seen from behind, else 1 */
	unsigned looks[RAYS];              /* of each mesh; NO_LOOK: the ray has met nothing */
};

/* A packet on its way. */
struct illustrate_packet {
	struct RTCRayHit16 hit;
	alignas(64) int valid[RAYS]; /* -1: cast this ray */
	float ends[RAYS];            /* where rays leave the clip region */
};

/* Cut a ray by the clip region. Returns whether something of it is left. */
static bool clip_ray(const struct gz_illustrate_cast *cast, struct RTCRay16 *ray, int i)
{
	const float origin[3] = { ray->org_x[i], ray->org_y[i], ray->org_z[i] };
	const float direction[3] = { ray->dir_x[i], ray->dir_y[i], ray->dir_z[i] };
	for (int axis = 0; axis < 3; axis++) {
		/* Along a face nothing divides by 0: such a ray is in or out as a whole. */
		const float along = fabsf(direction[axis]) > 1e-20F ? direction[axis] : 1e-20F;
		const float a = (cast->frame->clip_least[axis] - origin[axis]) / along;
		const float b = (cast->frame->clip_greatest[axis] - origin[axis]) / along;
		ray->tnear[i] = fmaxf(ray->tnear[i], fminf(a, b));
		ray->tfar[i] = fminf(ray->tfar[i], fmaxf(a, b));
	}
	const float *plane = cast->frame->clip_plane;
	const float beyond =
		plane[0] * origin[0] + plane[1] * origin[1] + plane[2] * origin[2] - plane[3];
	const float across =
		plane[0] * direction[0] + plane[1] * direction[1] + plane[2] * direction[2];
	const float at = -beyond / (fabsf(across) > 1e-20F ? across : 1e-20F);
	if (across < 0)
		ray->tnear[i] = fmaxf(ray->tnear[i], at);
	else
		ray->tfar[i] = fminf(ray->tfar[i], at);
	return ray->tnear[i] <= ray->tfar[i];
}

static void aim_packet(const struct gz_illustrate_cast *cast, const struct gz_illustrate_tile *tile,
		       struct illustrate_packet *packet)
{
	struct RTCRay16 *ray = &packet->hit.ray;
	float *const origins[3] = { ray->org_x, ray->org_y, ray->org_z };
	float *const directions[3] = { ray->dir_x, ray->dir_y, ray->dir_z };
	for (int i = 0; i < RAYS; i++) {
		float direction[3], length2 = 0;
		for (int axis = 0; axis < 3; axis++) {
			origins[axis][i] = cast->origin00[axis] +
					   tile->x[i] * cast->origin_dx[axis] +
					   tile->y[i] * cast->origin_dy[axis];
			direction[axis] = cast->direction00[axis] +
					  tile->x[i] * cast->direction_dx[axis] +
					  tile->y[i] * cast->direction_dy[axis];
			length2 += direction[axis] * direction[axis];
		}
		for (int axis = 0; axis < 3; axis++)
			directions[axis][i] = direction[axis] / sqrtf(length2);
		ray->tnear[i] = 0;
		ray->tfar[i] = INFINITY;
		ray->time[i] = 0;
		ray->mask[i] = UINT32_MAX;
		ray->flags[i] = 0;
		packet->hit.hit.geomID[i] = RTC_INVALID_GEOMETRY_ID;
		packet->hit.hit.instID[0][i] = RTC_INVALID_GEOMETRY_ID;
		packet->valid[i] = tile->active >> i & 1 ? -1 : 0;
		if (cast->frame->clipped && !clip_ray(cast, ray, i))
			packet->valid[i] = 0;
		packet->ends[i] = ray->tfar[i];
	}
}

/* Where a ray has met a triangle: its corners and their shares. */
struct triangle_place {
	const struct gz_illustrate_vertex *corners[3];
	float shares[3];
};

static struct triangle_place place_of_hit(const struct gz_illustrate_mesh *mesh,
					  const struct RTCHit16 *hit, int i)
{
	const uint32_t *corners = mesh->triangles[hit->primID[i]];
	struct triangle_place place = {
		.shares = { 1 - hit->u[i] - hit->v[i], hit->u[i], hit->v[i] },
	};
	for (int corner = 0; corner < 3; corner++)
		place.corners[corner] = &mesh->vertices[corners[corner]];
	return place;
}

static float mean_of(const float shares[3], float a, float b, float c)
{
	return shares[0] * a + shares[1] * b + shares[2] * c;
}

/* -1 where the surface is seen from behind, otherwise 1. The triangle's plane decides, because
 * interpolated normals turn away a little before the surface does. */
static float side_of_hit(const struct RTCHit16 *hit, const struct RTCRay16 *ray, int i,
			 const float normal[3])
{
	const float outwards =
		hit->Ng_x[i] * normal[0] + hit->Ng_y[i] * normal[1] + hit->Ng_z[i] * normal[2];
	const float away = hit->Ng_x[i] * ray->dir_x[i] + hit->Ng_y[i] * ray->dir_y[i] +
			   hit->Ng_z[i] * ray->dir_z[i];
	return outwards * away > 0 ? -1 : 1;
}

static void fill_empty_lane(int i, struct shading_lanes *lanes)
{
	for (int axis = 0; axis < 3; axis++) {
		for (int level = 0; level < GZ_SHADING_LEVELS; level++)
			lanes->normals[level][axis][i] = axis == 2;
		lanes->viewer[axis][i] = axis == 2;
	}
	lanes->greatest[i] = lanes->least[i] = 0;
	lanes->side[i] = 1;
	lanes->looks[i] = NO_LOOK;
}

/* Means of the corners' normals, of any length. Opposite normals can leave nothing: the first one's
 * then. */
static void interpolate_normals(const struct triangle_place *place,
				float normals[GZ_SHADING_LEVELS][3])
{
	const struct gz_illustrate_vertex *a = place->corners[0], *b = place->corners[1];
	const struct gz_illustrate_vertex *c = place->corners[2];
	float *all = &normals[0][0];
	for (int k = 0; k < 3 * GZ_SHADING_LEVELS; k++)
		all[k] = mean_of(place->shares, (&a->normals[0][0])[k], (&b->normals[0][0])[k],
				 (&c->normals[0][0])[k]);
	for (int level = 0; level < GZ_SHADING_LEVELS; level++) {
		const float *normal = normals[level];
		const float square =
			normal[0] * normal[0] + normal[1] * normal[1] + normal[2] * normal[2];
		const float steps = GZ_ILLUSTRATE_NORMAL_STEPS;
		for (int axis = 0; axis < 3 && !(square > GZ_SHADING_NO_NORMAL * steps * steps);
		     axis++)
			normals[level][axis] = a->normals[level][axis];
	}
}

static void fill_lane(const struct triangle_place *place, const struct RTCRayHit16 *hit, int i,
		      struct shading_lanes *lanes)
{
	const struct gz_illustrate_vertex *const *corners = place->corners;
	float normals[GZ_SHADING_LEVELS][3];
	interpolate_normals(place, normals);
	for (int level = 0; level < GZ_SHADING_LEVELS; level++)
		for (int axis = 0; axis < 3; axis++)
			lanes->normals[level][axis][i] = normals[level][axis];
	const float side = side_of_hit(&hit->hit, &hit->ray, i, normals[0]);
	const float greatest = mean_of(place->shares, corners[0]->greatest, corners[1]->greatest,
				       corners[2]->greatest);
	const float least =
		mean_of(place->shares, corners[0]->least, corners[1]->least, corners[2]->least);
	lanes->side[i] = side;
	lanes->greatest[i] = side * (side > 0 ? greatest : least);
	lanes->least[i] = side * (side > 0 ? least : greatest);
	lanes->viewer[0][i] = -hit->ray.dir_x[i];
	lanes->viewer[1][i] = -hit->ray.dir_y[i];
	lanes->viewer[2][i] = -hit->ray.dir_z[i];
}

/* Make the normals of all lanes as long as 1, and turn them towards the viewer. */
static void settle_normals(struct shading_lanes *lanes)
{
	for (int level = 0; level < GZ_SHADING_LEVELS; level++) {
		float *x = lanes->normals[level][0], *y = lanes->normals[level][1];
		float *z = lanes->normals[level][2];
		for (int i = 0; i < RAYS; i++) {
			const float scale =
				lanes->side[i] / sqrtf(x[i] * x[i] + y[i] * y[i] + z[i] * z[i]);
			x[i] *= scale;
			y[i] *= scale;
			z[i] *= scale;
		}
	}
}

/* Fetch what shading reads into the caches: for all rays at once, it takes one wait for the
 * triangles and one for the vertices. Always inlined: gcc 12 takes a function that only fetches for
 * one without effect, and leaves calls of it out. */
__attribute__((always_inline)) static inline void fetch_hits(const struct gz_illustrate_cast *cast,
							     const struct RTCHit16 *hit)
{
	for (int i = 0; i < RAYS; i++)
		if (hit->geomID[i] < cast->mesh_count)
			__builtin_prefetch(cast->meshes[hit->geomID[i]].triangles[hit->primID[i]]);
	for (int i = 0; i < RAYS; i++) {
		if (hit->geomID[i] >= cast->mesh_count)
			continue;
		const struct gz_illustrate_mesh *mesh = &cast->meshes[hit->geomID[i]];
		for (int corner = 0; corner < 3; corner++) {
			const struct gz_illustrate_vertex *vertex =
				&mesh->vertices[mesh->triangles[hit->primID[i]][corner]];
			__builtin_prefetch(vertex);
			__builtin_prefetch((const char *)(vertex + 1) - 1);
		}
	}
}

static void read_hits(const struct gz_illustrate_cast *cast, const struct RTCRayHit16 *hit,
		      struct shading_lanes *lanes, struct gz_illustrate_hits *hits)
{
	fetch_hits(cast, &hit->hit);
	for (int i = 0; i < RAYS; i++) {
		const unsigned number = hit->hit.geomID[i];
		const bool met = number < cast->mesh_count;
		hits->ids[i] = met ? cast->meshes[number].id : 0;
		hits->depth_mm[i] = met ? hit->ray.tfar[i] : INFINITY;
		hits->distance_mm[i] = INFINITY;
		if (!met) {
			fill_empty_lane(i, lanes);
			continue;
		}
		const struct triangle_place place =
			place_of_hit(&cast->meshes[number], &hit->hit, i);
		fill_lane(&place, hit, i, lanes);
		lanes->looks[i] = cast->meshes[number].look;
		const float distance_mm =
			mean_of(place.shares, place.corners[0]->distance_mm,
				place.corners[1]->distance_mm, place.corners[2]->distance_mm);
		if (isfinite(distance_mm))
			hits->distance_mm[i] = distance_mm;
	}
	settle_normals(lanes);
}

/* Mean of the parameters that have a weight. */
static void shade_lanes(const struct gz_illustrate_cast *cast,
			const struct gz_illustrate_look *look, const struct shading_lanes *lanes,
			float *out_tone)
{
	const struct gz_illustrate_weights *weights = &look->weights;
	float values[PARAMETERS_MAX][RAYS] = { { 0 } };
	struct gz_weighted_parameter parameters[PARAMETERS_MAX];
	struct gz_shading_vectors normals[GZ_SHADING_LEVELS];
	const struct gz_shading_vectors viewer = { lanes->viewer[0], lanes->viewer[1],
						   lanes->viewer[2] };
	const float all[PARAMETERS_MAX] = { weights->main_light,    weights->plateau_light,
					    weights->grazing_light, weights->surface_shape,
					    weights->curvature,     weights->plain_light };
	float sum = 0;
	for (int i = 0; i < PARAMETERS_MAX; i++) {
		parameters[i] = (struct gz_weighted_parameter) { values[i], all[i] };
		sum += all[i];
	}
	for (int level = 0; level < GZ_SHADING_LEVELS; level++)
		normals[level] = (struct gz_shading_vectors) { lanes->normals[level][0],
							       lanes->normals[level][1],
							       lanes->normals[level][2] };
	if (weights->main_light > 0)
		gz_shading_main_light(&normals[look->main_level], RAYS, look->grazing.light,
				      values[0]);
	if (weights->plateau_light > 0)
		gz_shading_plateau_light(&normals[0], &viewer, RAYS, values[1]);
	if (weights->grazing_light > 0)
		gz_shading_grazing_light(normals, RAYS, &look->grazing, values[2]);
	if (weights->surface_shape > 0)
		gz_shading_surface_shape(lanes->greatest, lanes->least, RAYS, 1, values[3]);
	if (weights->curvature > 0)
		gz_shading_curvature_magnitude(lanes->greatest, lanes->least, RAYS, 1, values[4]);
	if (weights->plain_light > 0)
		gz_shading_plain_light(&normals[0], RAYS, cast->frame->lamp, values[5]);
	gz_shading_mean(parameters, PARAMETERS_MAX, RAYS, out_tone);
	for (int i = 0; i < RAYS && !(sum > 0); i++)
		out_tone[i] = weights->flat;
}

static bool any_is_met(const struct RTCRayHit16 *hit)
{
	bool any = false;
	for (int i = 0; i < RAYS; i++)
		any |= hit->hit.geomID[i] != RTC_INVALID_GEOMETRY_ID;
	return any;
}

static void fill_empty_hits(struct gz_illustrate_hits *hits)
{
	for (int i = 0; i < RAYS; i++) {
		hits->tone[i] = hits->depth_mm[i] = hits->distance_mm[i] = INFINITY;
		hits->ids[i] = 0;
	}
}

/* The tone of each ray by the look of what it has met; INFINITY where that is nothing. */
static void shade_by_looks(const struct gz_illustrate_cast *cast, const struct shading_lanes *lanes,
			   float out_tone[RAYS])
{
	bool done[RAYS];
	for (int i = 0; i < RAYS; i++) {
		done[i] = lanes->looks[i] == NO_LOOK;
		out_tone[i] = INFINITY;
	}
	for (int first = 0; first < RAYS; first++) {
		float tone[RAYS];
		const unsigned look = lanes->looks[first];
		if (done[first])
			continue;
		shade_lanes(cast, &cast->frame->looks[look], lanes, tone);
		for (int i = first; i < RAYS; i++)
			if (lanes->looks[i] == look) {
				out_tone[i] = tone[i];
				done[i] = true;
			}
	}
}

/* Whether a ray has met something that others show through. */
static bool met_transparent(const struct gz_illustrate_cast *cast, const struct RTCRayHit16 *hit,
			    int i)
{
	const unsigned number = hit->hit.geomID[i];
	return number < cast->mesh_count && cast->meshes[number].transparent;
}

/* Let the rays that have met transparent surfaces go on; the others are done. Returns whether there
 * are any. */
static bool go_on(const struct gz_illustrate_cast *cast, struct illustrate_packet *packet)
{
	bool any = false;
	for (int i = 0; i < RAYS; i++) {
		struct RTCRay16 *ray = &packet->hit.ray;
		const bool through = packet->valid[i] && met_transparent(cast, &packet->hit, i);
		packet->valid[i] = through ? -1 : 0;
		any = any || through;
		if (through)
			ray->tnear[i] = ray->tfar[i] * (1 + GZ_ILLUSTRATE_ONWARD) +
					GZ_ILLUSTRATE_ONWARD_LEAST_MM;
		/* An empty ray, too: where meshes have filters, Embree follows some that are not
		 * valid. */
		ray->tfar[i] = through ? packet->ends[i] : -INFINITY;
		packet->hit.hit.geomID[i] = RTC_INVALID_GEOMETRY_ID;
	}
	return any;
}

/* Find the next surface of each ray that is opaque. */
static void find_opaque(const struct gz_illustrate_cast *cast, struct gz_embree_query *query,
			struct illustrate_packet *packet)
{
	struct RTCHit16 found = packet->hit.hit;
	struct RTCRay16 rays = packet->hit.ray;
	for (bool any = true; any; any = go_on(cast, packet)) {
		gz_embree_intersect16(packet->valid, cast->tree, query, &packet->hit);
		for (int i = 0; i < RAYS; i++) {
			if (!packet->valid[i] || met_transparent(cast, &packet->hit, i))
				continue;
			rays.tfar[i] = packet->hit.ray.tfar[i];
			found.Ng_x[i] = packet->hit.hit.Ng_x[i];
			found.Ng_y[i] = packet->hit.hit.Ng_y[i];
			found.Ng_z[i] = packet->hit.hit.Ng_z[i];
			found.u[i] = packet->hit.hit.u[i];
			found.v[i] = packet->hit.hit.v[i];
			found.primID[i] = packet->hit.hit.primID[i];
			found.geomID[i] = packet->hit.hit.geomID[i];
		}
	}
	packet->hit.hit = found;
	packet->hit.ray = rays;
}

void gz_illustrate_tile_cast(const struct gz_illustrate_cast *cast,
			     const struct gz_illustrate_tile *tile,
			     struct gz_illustrate_hits out_hits[GZ_ILLUSTRATE_LAYERS_MAX])
{
	struct illustrate_packet packet;
	struct shading_lanes lanes;
	struct gz_embree_query query;
	bool any = true;
	aim_packet(cast, tile, &packet);
	gz_embree_query_make(true, &query);
	for (int layer = 0; layer < cast->layers; layer++) {
		any = layer == 0 || (any && go_on(cast, &packet));
		if (any && layer > 0 && layer + 1 == cast->layers)
			find_opaque(cast, &query, &packet);
		else if (any)
			gz_embree_intersect16(packet.valid, cast->tree, &query, &packet.hit);
		any = any && any_is_met(&packet.hit);
		if (!any) {
			fill_empty_hits(&out_hits[layer]);
			continue;
		}
		read_hits(cast, &packet.hit, &lanes, &out_hits[layer]);
		shade_by_looks(cast, &lanes, out_hits[layer].tone);
	}
}
