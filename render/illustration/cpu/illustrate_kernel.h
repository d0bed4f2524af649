/*
 * The kernel of illustrate_cast.h, compiled once for each instruction set. Its loops run over all
 * rays of a tile and become SIMD; nothing in them is fused, so the bits are the same.
 */
#ifndef GZ_RENDER_ILLUSTRATION_CPU_ILLUSTRATE_KERNEL_H
#define GZ_RENDER_ILLUSTRATION_CPU_ILLUSTRATE_KERNEL_H

#include <float.h>
#include <math.h>
#include <stdalign.h>
#include <stdbool.h>
#include <string.h>

#include "render/illustration/cpu/illustrate_cast.h"
#include "render/illustration/shading_parameter_loops.h"

enum {
	RAYS = GZ_ILLUSTRATE_RAYS,
	PARAMETERS_MAX = 6,
	NORMAL_PARTS = 3 * GZ_SHADING_LEVELS,
};

#define NO_LOOK UINT32_MAX

/* A number for each ray. */
typedef float ray_floats[RAYS];

/* What shading reads of each ray's end. */
struct shading_lanes {
	alignas(64) ray_floats normals[GZ_SHADING_LEVELS][3];
	ray_floats viewer[3];
	ray_floats greatest, least; /* curvatures, as shares of the mesh's scale */
	unsigned looks[RAYS];       /* of each mesh; NO_LOOK: the ray has met nothing */
	bool one_look;              /* those that have met something have the same */
};

/* Means over the corners of each ray's triangle, ray by ray, and what else is read one by one. */
struct corner_means {
	alignas(64) float normals[RAYS][NORMAL_PARTS]; /* of any length, level by level */
	ray_floats greatest, least;
	const struct gz_illustrate_vertex *first[RAYS]; /* corner; NULL: the ray has met nothing */
};

/* A packet on its way. */
struct illustrate_packet {
	struct RTCRayHit16 hit;
	alignas(64) int valid[RAYS]; /* -1: cast this ray */
	ray_floats ends;             /* where rays leave the clip region */
};

/* Pixels of all rays, along one axis. */
static inline void find_pixels(float first, float spacing, const uint8_t *restrict steps,
			       float *restrict out)
{
	for (int i = 0; i < RAYS; i++)
		out[i] = first + (float)steps[i] * spacing;
}

/* One coordinate of all rays: @p at (0, 0), and by how much it grows along x and y. */
static inline void aim_along(float at, float by_x, float by_y, const float *restrict x,
			     const float *restrict y, float *restrict out)
{
	for (int i = 0; i < RAYS; i++)
		out[i] = at + x[i] * by_x + y[i] * by_y;
}

/* Make the directions as long as 1. */
static inline void settle_directions(float *restrict x, float *restrict y, float *restrict z)
{
	for (int i = 0; i < RAYS; i++) {
		const float length = sqrtf(x[i] * x[i] + y[i] * y[i] + z[i] * z[i]);
		x[i] /= length;
		y[i] /= length;
		z[i] /= length;
	}
}

/* Cut rays to where they lie between two planes across an axis. */
static inline void clip_along(float least, float greatest, const float *restrict origin,
			      const float *restrict direction, float *restrict from,
			      float *restrict to)
{
	for (int i = 0; i < RAYS; i++) {
		/* Along a face nothing divides by 0: such a ray is in or out as a whole. */
		const float along = fabsf(direction[i]) > 1e-20F ? direction[i] : 1e-20F;
		const float a = (least - origin[i]) / along, b = (greatest - origin[i]) / along;
		const float enters = a < b ? a : b, leaves = a < b ? b : a;
		from[i] = enters > from[i] ? enters : from[i];
		to[i] = leaves < to[i] ? leaves : to[i];
	}
}

/* Cut rays to what lies before a plane (struct gz_clip_bounds). */
static inline void clip_by_plane(const float plane[4], const struct RTCRay16 *restrict ray,
				 float *restrict from, float *restrict to)
{
	const float a = plane[0], b = plane[1], c = plane[2], d = plane[3];
	for (int i = 0; i < RAYS; i++) {
		const float beyond = a * ray->org_x[i] + b * ray->org_y[i] + c * ray->org_z[i] - d;
		const float across = a * ray->dir_x[i] + b * ray->dir_y[i] + c * ray->dir_z[i];
		const float at = -beyond / (fabsf(across) > 1e-20F ? across : 1e-20F);
		const float enters = across < 0 ? at : from[i];
		const float leaves = across < 0 ? to[i] : at;
		from[i] = enters > from[i] ? enters : from[i];
		to[i] = leaves < to[i] ? leaves : to[i];
	}
}

/* Set up what rays and hits hold before they are cast. */
static inline void clear_packet(const struct gz_illustrate_tile *restrict tile,
				struct illustrate_packet *restrict packet)
{
	for (int i = 0; i < RAYS; i++) {
		packet->hit.ray.tnear[i] = 0;
		packet->hit.ray.tfar[i] = INFINITY;
		packet->hit.ray.time[i] = 0;
		packet->hit.ray.mask[i] = UINT32_MAX;
		packet->hit.ray.flags[i] = 0;
		packet->hit.hit.geomID[i] = RTC_INVALID_GEOMETRY_ID;
		packet->hit.hit.instID[0][i] = RTC_INVALID_GEOMETRY_ID;
		packet->valid[i] = tile->active >> i & 1 ? -1 : 0;
	}
	/* Loops over all lanes read it where rays meet nothing, too. */
	memset(packet->hit.hit.Ng_x, 0, sizeof packet->hit.hit.Ng_x);
	memset(packet->hit.hit.Ng_y, 0, sizeof packet->hit.hit.Ng_y);
	memset(packet->hit.hit.Ng_z, 0, sizeof packet->hit.hit.Ng_z);
}

/* Set up the rays of a tile, cut to the clip region. */
static inline void aim_packet(const struct gz_illustrate_cast *cast,
			      const struct gz_illustrate_tile *tile,
			      struct illustrate_packet *packet)
{
	struct RTCRay16 *ray = &packet->hit.ray;
	float *const origins[3] = { ray->org_x, ray->org_y, ray->org_z };
	float *const directions[3] = { ray->dir_x, ray->dir_y, ray->dir_z };
	ray_floats x, y;
	clear_packet(tile, packet);
	find_pixels(tile->x, tile->spacing, tile->columns, x);
	find_pixels(tile->y, tile->spacing, tile->rows, y);
	for (int axis = 0; axis < 3; axis++) {
		aim_along(cast->origin00[axis], cast->origin_dx[axis], cast->origin_dy[axis], x, y,
			  origins[axis]);
		aim_along(cast->direction00[axis], cast->direction_dx[axis],
			  cast->direction_dy[axis], x, y, directions[axis]);
	}
	settle_directions(ray->dir_x, ray->dir_y, ray->dir_z);
	for (int axis = 0; axis < 3 && cast->frame->clipped; axis++)
		clip_along(cast->frame->clip_least[axis], cast->frame->clip_greatest[axis],
			   origins[axis], directions[axis], ray->tnear, ray->tfar);
	if (cast->frame->clipped) {
		ray_floats from, to;
		memcpy(from, ray->tnear, sizeof from);
		memcpy(to, ray->tfar, sizeof to);
		clip_by_plane(cast->frame->clip_plane, ray, from, to);
		memcpy(ray->tnear, from, sizeof from);
		memcpy(ray->tfar, to, sizeof to);
	}
	for (int i = 0; i < RAYS; i++) {
		packet->valid[i] = ray->tnear[i] <= ray->tfar[i] ? packet->valid[i] : 0;
		packet->ends[i] = ray->tfar[i];
	}
}

/* A mean by shares that add up to 1. */
static inline float mean_of(const float shares[3], float a, float b, float c)
{
	return shares[0] * a + shares[1] * b + shares[2] * c;
}

/* Where a ray has met nothing: a normal that can be made as long as 1. */
static inline void fill_empty_lane(int i, struct corner_means *means)
{
	for (int part = 0; part < NORMAL_PARTS; part++)
		means->normals[i][part] = part % 3 == 2 ? GZ_ILLUSTRATE_NORMAL_STEPS : 0;
	means->greatest[i] = means->least[i] = 0;
	means->first[i] = NULL;
}

/* Means over the corners of the triangle that a ray has met. @return that of the distances */
static inline float fill_lane(const struct gz_illustrate_mesh *mesh, const struct RTCHit16 *hit,
			      int i, struct corner_means *restrict means)
{
	const uint32_t *corners = mesh->triangles[hit->primID[i]];
	const float shares[3] = { 1 - hit->u[i] - hit->v[i], hit->u[i], hit->v[i] };
	const struct gz_illustrate_vertex *a = &mesh->vertices[corners[0]];
	const struct gz_illustrate_vertex *b = &mesh->vertices[corners[1]];
	const struct gz_illustrate_vertex *c = &mesh->vertices[corners[2]];
	for (int part = 0; part < NORMAL_PARTS; part++)
		means->normals[i][part] =
			mean_of(shares, (&a->normals[0][0])[part], (&b->normals[0][0])[part],
				(&c->normals[0][0])[part]);
	means->greatest[i] = mean_of(shares, a->greatest, b->greatest, c->greatest);
	means->least[i] = mean_of(shares, a->least, b->least, c->least);
	means->first[i] = a;
	return mean_of(shares, a->distance_mm, b->distance_mm, c->distance_mm);
}

/* From normals ray by ray to arrays of one component each. */
static inline void turn_normals(const float (*restrict rows)[NORMAL_PARTS],
				float (*restrict out_parts)[RAYS])
{
	for (int part = 0; part < NORMAL_PARTS; part++)
		for (int i = 0; i < RAYS; i++)
			out_parts[part][i] = rows[i][part];
}

/* Opposite normals can cancel out: those of the first corner then. */
static inline void mend_normals(const struct corner_means *means, struct shading_lanes *lanes)
{
	const float steps = GZ_ILLUSTRATE_NORMAL_STEPS;
	const float least = GZ_SHADING_NO_NORMAL * steps * steps;
	for (int level = 0; level < GZ_SHADING_LEVELS; level++) {
		float *x = lanes->normals[level][0], *y = lanes->normals[level][1];
		float *z = lanes->normals[level][2];
		int lost = 0;
		for (int i = 0; i < RAYS; i++)
			lost |= x[i] * x[i] + y[i] * y[i] + z[i] * z[i] > least ? 0 : 1;
		for (int i = 0; i < RAYS && lost; i++) {
			if (!means->first[i] || x[i] * x[i] + y[i] * y[i] + z[i] * z[i] > least)
				continue;
			x[i] = means->first[i]->normals[level][0];
			y[i] = means->first[i]->normals[level][1];
			z[i] = means->first[i]->normals[level][2];
		}
	}
}

/* -1 where surfaces are seen from behind, otherwise 1. The triangles' planes decide, because
 * interpolated normals turn away a little before the surface does. @p x, y, z: normals */
static inline void find_sides(const struct RTCRayHit16 *hit, const float *restrict x,
			      const float *restrict y, const float *restrict z,
			      float *restrict out_sides)
{
	for (int i = 0; i < RAYS; i++) {
		const float outwards =
			hit->hit.Ng_x[i] * x[i] + hit->hit.Ng_y[i] * y[i] + hit->hit.Ng_z[i] * z[i];
		const float away = hit->hit.Ng_x[i] * hit->ray.dir_x[i] +
				   hit->hit.Ng_y[i] * hit->ray.dir_y[i] +
				   hit->hit.Ng_z[i] * hit->ray.dir_z[i];
		out_sides[i] = outwards * away > 0 ? -1.0F : 1.0F;
	}
}

/* Make the normals of all lanes as long as 1, and turn them towards the viewer. */
static inline void settle_normals(const float *restrict sides, float *restrict x, float *restrict y,
				  float *restrict z)
{
	for (int i = 0; i < RAYS; i++) {
		const float scale = sides[i] / sqrtf(x[i] * x[i] + y[i] * y[i] + z[i] * z[i]);
		x[i] *= scale;
		y[i] *= scale;
		z[i] *= scale;
	}
}

/* Curvatures and the way to the viewer; what is seen from behind bends the other way. */
static inline void settle_curvatures(const struct corner_means *restrict means,
				     const struct RTCRay16 *restrict ray,
				     const float *restrict sides,
				     struct shading_lanes *restrict lanes)
{
	for (int i = 0; i < RAYS; i++) {
		const float greatest = means->greatest[i], least = means->least[i];
		lanes->greatest[i] = sides[i] > 0 ? greatest : -least;
		lanes->least[i] = sides[i] > 0 ? least : -greatest;
		lanes->viewer[0][i] = -ray->dir_x[i];
		lanes->viewer[1][i] = -ray->dir_y[i];
		lanes->viewer[2][i] = -ray->dir_z[i];
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

/* Read what each ray has met. @return the look of the last one that has met something */
static inline unsigned read_corners(const struct gz_illustrate_cast *cast,
				    const struct RTCRayHit16 *hit, struct corner_means *means,
				    struct shading_lanes *lanes, struct gz_illustrate_hits *hits)
{
	unsigned look = NO_LOOK;
	lanes->one_look = true;
	for (int i = 0; i < RAYS; i++) {
		const unsigned number = hit->hit.geomID[i];
		const bool met = number < cast->mesh_count;
		const struct gz_illustrate_mesh *mesh = met ? &cast->meshes[number] : NULL;
		hits->ids[i] = met ? mesh->id : 0;
		hits->depth_mm[i] = met ? hit->ray.tfar[i] : INFINITY;
		hits->distance_mm[i] = INFINITY;
		lanes->looks[i] = met ? mesh->look : NO_LOOK;
		if (!met) {
			fill_empty_lane(i, means);
			continue;
		}
		const float distance_mm = fill_lane(mesh, &hit->hit, i, means);
		if (fabsf(distance_mm) <= FLT_MAX)
			hits->distance_mm[i] = distance_mm;
		lanes->one_look = lanes->one_look && (look == NO_LOOK || look == mesh->look);
		look = mesh->look;
	}
	return look;
}

/* @return the look of the last ray that has met something */
static inline unsigned read_hits(const struct gz_illustrate_cast *cast,
				 const struct RTCRayHit16 *hit, struct shading_lanes *lanes,
				 struct gz_illustrate_hits *hits)
{
	struct corner_means means;
	ray_floats sides;
	fetch_hits(cast, &hit->hit);
	const unsigned look = read_corners(cast, hit, &means, lanes, hits);
	turn_normals(means.normals, &lanes->normals[0][0]);
	mend_normals(&means, lanes);
	find_sides(hit, lanes->normals[0][0], lanes->normals[0][1], lanes->normals[0][2], sides);
	for (int level = 0; level < GZ_SHADING_LEVELS; level++)
		settle_normals(sides, lanes->normals[level][0], lanes->normals[level][1],
			       lanes->normals[level][2]);
	settle_curvatures(&means, &hit->ray, sides, lanes);
	return look;
}

/* Mean of the parameters that have a weight. */
static inline void shade_lanes(const struct gz_illustrate_cast *cast,
			       const struct gz_illustrate_look *look,
			       const struct shading_lanes *lanes, float *out_tone)
{
	const struct gz_illustrate_weights *weights = &look->weights;
	ray_floats values[PARAMETERS_MAX];
	struct gz_weighted_parameter parameters[PARAMETERS_MAX];
	struct gz_shading_vectors normals[GZ_SHADING_LEVELS];
	const struct gz_shading_vectors viewer = { lanes->viewer[0], lanes->viewer[1],
						   lanes->viewer[2] };
	const float all[PARAMETERS_MAX] = { weights->main_light,    weights->plateau_light,
					    weights->grazing_light, weights->surface_shape,
					    weights->curvature,     weights->plain_light };
	float sum = 0;
	for (int i = 0; i < PARAMETERS_MAX; i++) {
		parameters[i] = (struct gz_weighted_parameter) { &values[i][0], all[i] };
		sum += all[i];
	}
	for (int level = 0; level < GZ_SHADING_LEVELS; level++)
		normals[level] = (struct gz_shading_vectors) { lanes->normals[level][0],
							       lanes->normals[level][1],
							       lanes->normals[level][2] };
	if (weights->main_light > 0)
		main_light_loop(&normals[look->main_level], RAYS, look->grazing.light, values[0]);
	if (weights->plateau_light > 0)
		plateau_light_loop(&normals[0], &viewer, RAYS, values[1]);
	if (weights->grazing_light > 0)
		grazing_light_loop(normals, RAYS, &look->grazing, values[2]);
	if (weights->surface_shape > 0)
		surface_shape_loop(lanes->greatest, lanes->least, RAYS, 1, values[3]);
	if (weights->curvature > 0)
		curvature_magnitude_loop(lanes->greatest, lanes->least, RAYS, 1, values[4]);
	if (weights->plain_light > 0)
		plain_light_loop(&normals[0], RAYS, cast->frame->lamp, values[5]);
	mean_loop(parameters, PARAMETERS_MAX, RAYS, out_tone);
	for (int i = 0; i < RAYS && !(sum > 0); i++)
		out_tone[i] = weights->flat;
}

/* Whether any ray has met something. */
static inline bool any_is_met(const struct RTCRayHit16 *hit)
{
	bool any = false;
	for (int i = 0; i < RAYS; i++)
		any |= hit->hit.geomID[i] != RTC_INVALID_GEOMETRY_ID;
	return any;
}

/* What rays find that meet nothing. */
static inline void fill_empty_hits(struct gz_illustrate_hits *hits)
{
	for (int i = 0; i < RAYS; i++) {
		hits->tone[i] = hits->depth_mm[i] = hits->distance_mm[i] = INFINITY;
		hits->ids[i] = 0;
	}
}

/* Write tones to the lanes of a look. */
static inline void take_tones(const struct shading_lanes *restrict lanes, unsigned look,
			      const float *restrict tones, float *restrict out_tones)
{
	for (int i = 0; i < RAYS; i++)
		out_tones[i] = lanes->looks[i] == look ? tones[i] : out_tones[i];
}

/* Whether an earlier lane has the look of this one. */
static inline bool is_known_look(const struct shading_lanes *lanes, int lane)
{
	for (int i = 0; i < lane; i++)
		if (lanes->looks[i] == lanes->looks[lane])
			return true;
	return false;
}

/* The tone of each ray by the look of what it has met; INFINITY where that is nothing.
 * @param last  the look of the last ray that has met something */
static inline void shade_by_looks(const struct gz_illustrate_cast *cast,
				  const struct shading_lanes *lanes, unsigned last,
				  float out_tones[RAYS])
{
	ray_floats tones;
	for (int i = 0; i < RAYS; i++)
		out_tones[i] = INFINITY;
	for (int lane = 0; lane < RAYS; lane++) {
		const unsigned look = lanes->one_look ? last : lanes->looks[lane];
		if (look == NO_LOOK || (!lanes->one_look && is_known_look(lanes, lane)))
			continue;
		shade_lanes(cast, &cast->frame->looks[look], lanes, tones);
		take_tones(lanes, look, tones, out_tones);
		if (lanes->one_look)
			return;
	}
}

/* Whether a ray has met something that others show through. */
static inline bool met_transparent(const struct gz_illustrate_cast *cast,
				   const struct RTCRayHit16 *hit, int i)
{
	const unsigned number = hit->hit.geomID[i];
	return number < cast->mesh_count && cast->meshes[number].transparent;
}

/* Let the rays that have met transparent surfaces go on; the others are done. Returns whether there
 * are any. */
static inline bool go_on(const struct gz_illustrate_cast *cast, struct illustrate_packet *packet)
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
static inline void find_opaque(const struct gz_illustrate_cast *cast, struct gz_embree_query *query,
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

/* gz_illustrate_tile_cast() */
static void cast_illustrate_tile(const struct gz_illustrate_cast *cast,
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
		const unsigned look = read_hits(cast, &packet.hit, &lanes, &out_hits[layer]);
		shade_by_looks(cast, &lanes, look, out_hits[layer].tone);
	}
}

#endif
