/*
 * Surfaces of glass and water: each ray goes on through them, and what it leaves sees the
 * surroundings (render/light/environment.h). A part of the kernel: see surface_kernel.h.
 *
 * Where a ray meets a surface, it is split by Schlick's approximation ("An Inexpensive BRDF Model
 * for Physically-based Rendering", Eurographics 1994): with n the refractive index, c the cosine
 * between normal and the ray outside of the glass,
 *
 *   R0 = ((n - 1) / (n + 1))^2,  R = R0 + (1 - R0) (1 - c)^5, or 1 beyond the critical angle
 *
 * R of the light is reflected and 1 - R refracted by Snell's law. The greater part goes on as a
 * ray; the other part sees the surroundings as if nothing else stood in its way. So no ray becomes
 * two. A ray that has met as many surfaces as it may sees the surroundings, too. Within glass light
 * is lost by Beer and Lambert: after one world unit what is left is the colour of surfaces.
 *
 * A ray begins outside; each refraction takes it to the other side. So meshes need not say which
 * side of their triangles is outside.
 */
#ifndef GZ_RENDER_SURFACE_CPU_SURFACE_GLASS_H
#define GZ_RENDER_SURFACE_CPU_SURFACE_GLASS_H

#include "render/raycast/cpu/simd_surroundings.h"
#include "render/surface/cpu/surface_cast.h"
#include "render/surface/cpu/surface_field.h"
#include "render/surface/cpu/surface_packet.h"

/* Rays on their way through glass. */
struct glass {
	alignas(64) float light[3][GZ_SURFACE_RAYS];  /* that they have gathered */
	alignas(64) float weight[3][GZ_SURFACE_RAYS]; /* of what is still to come */
	alignas(64) int inside[GZ_SURFACE_RAYS];      /* -1: within glass */
};

/* Add a share of what the lanes of the mask see of the surroundings. */
SIMD void gather_surroundings(const struct gz_surface_cast *cast, const vf origin[3],
			      const vf direction[3], vf share, struct lanes lanes,
			      struct glass *glass)
{
	const struct rgb seen = see_surroundings(&cast->frame.around, origin, direction);
	for (int i = 0; i < 3; i++) {
		float *light = glass->light[i] + lanes.first;
		const vf weight = vf_load(glass->weight[i] + lanes.first) * share;
		put_lanes(lanes.mask, vf_fma(weight, seen.channel[i], vf_load(light)), light);
	}
}

/* How surfaces split the lanes' rays. */
struct split {
	vf reflected[3], refracted[3]; /* unit directions */
	vf share;                      /* that is reflected, [0, 1] */
};

/* Split rays at normals that face them. */
SIMD struct split split_rays(const struct gz_surface_cast *cast, const vf direction[3],
			     const vf normal[3], vm inside)
{
	struct split split;
	const vf one = vf_set(1), index = vf_set(cast->frame.refractive_index);
	const vf ratio = vf_select(inside, index, one / index);
	const vf cosine = clamp_lanes(vf_set(0) - dot_lanes(direction, normal), vf_set(0), one);
	const vf rest = one - ratio * ratio * (one - cosine * cosine);
	const vf beyond = vf_sqrt(vf_max(rest, vf_set(0)));
	const vf outside = one - vf_select(inside, beyond, cosine);
	const vf power2 = outside * outside;
	const vf least = vf_set(cast->frame.least_reflection);
	const vf schlick = vf_fma((one - least) * power2 * power2, outside, least);
	split.share = vf_select(vf_less(rest, vf_set(0)), one, schlick);
	for (int axis = 0; axis < 3; axis++) {
		split.reflected[axis] = vf_fma(vf_set(2) * cosine, normal[axis], direction[axis]);
		split.refracted[axis] = vf_fma(vf_fma(ratio, cosine, vf_set(0) - beyond),
					       normal[axis], ratio * direction[axis]);
	}
	return split;
}

/* Take from the weights what glass absorbs on the way to where the lanes of the mask are. */
SIMD void absorb(const struct gz_surface_cast *cast, vf distance, struct lanes lanes,
		 struct glass *glass)
{
	const vm inside = vm_and(lanes.mask, load_mask(glass->inside + lanes.first));
	if (!vm_any(inside))
		return;
	for (int i = 0; i < 3; i++) {
		float *weight = glass->weight[i] + lanes.first;
		const vf left = exp2_negative(distance * vf_set(cast->frame.absorbed_per_mm[i]));
		put_lanes(inside, vf_load(weight) * left, weight);
	}
}

/* Send on the lanes of the mask, all of which have met one mesh. */
SIMD void bend_lanes(const struct gz_surface_cast *cast, unsigned number, struct lanes lanes,
		     struct packet *packet, struct glass *glass)
{
	struct RTCRay16 *ray = &packet->hit.ray;
	float *const origins[3] = { ray->org_x, ray->org_y, ray->org_z };
	float *const directions[3] = { ray->dir_x, ray->dir_y, ray->dir_z };
	const int first = lanes.first;
	const struct ways way = load_ways(ray, first);
	struct meeting at = read_meeting(cast, number, packet, lanes);
	const vf distance = vf_load(ray->tfar + first);
	const vm away = vf_less(vf_set(0), dot_lanes(at.normal, way.direction));
	const vm inside = load_mask(glass->inside + first);
	absorb(cast, distance, lanes, glass);
	for (int axis = 0; axis < 3; axis++) {
		at.place[axis] = vf_fma(distance, way.direction[axis], way.origin[axis]);
		at.normal[axis] = vf_select(away, vf_set(0) - at.normal[axis], at.normal[axis]);
	}
	const struct split split = split_rays(cast, way.direction, at.normal, inside);
	const vm mirrors = vf_less(vf_set(0.5F), split.share);
	const vf onward = vf_select(mirrors, split.share, vf_set(1) - split.share);
	vf other[3];
	for (int axis = 0; axis < 3; axis++)
		other[axis] = vf_select(mirrors, split.refracted[axis], split.reflected[axis]);
	gather_surroundings(cast, at.place, other, vf_set(1) - onward, lanes, glass);
	const vf lift = vf_select(mirrors, vf_set(cast->frame.lift), vf_set(-cast->frame.lift));
	for (int axis = 0; axis < 3; axis++) {
		const vf turned = vf_select(mirrors, split.reflected[axis], split.refracted[axis]);
		put_lanes(lanes.mask, turned, directions[axis] + first);
		put_lanes(lanes.mask, vf_fma(lift, at.normal[axis], at.place[axis]),
			  origins[axis] + first);
	}
	for (int i = 0; i < 3; i++) {
		float *weight = glass->weight[i] + first;
		put_lanes(lanes.mask, vf_load(weight) * onward, weight);
	}
	const vm through = vm_but(lanes.mask, mirrors);
	const vm stays = vm_but(inside, through), enters = vm_but(through, inside);
	store_mask(vm_or(stays, enters), glass->inside + first);
}

/* Begin the rays again from where they are. */
SIMD void relaunch_lanes(const struct gz_surface_cast *cast, int first, struct packet *packet)
{
	struct RTCRay16 *ray = &packet->hit.ray;
	vf from = vf_set(0), to = vf_set(INFINITY);
	if (cast->frame.clipped) {
		const struct ways way = load_ways(ray, first);
		(void)clip_lanes(cast, way.origin, way.direction, &from, &to);
	}
	vf_store(ray->tnear + first, from);
	vf_store(ray->tfar + first, to);
	vi_store(packet->hit.hit.geomID + first, vi_set(-1));
}

/* Gather what rays see that have met nothing, and send on the others. packet->valid becomes the
 * latter. Returns whether there are any. */
SIMD int bend_hits(const struct gz_surface_cast *cast, int first, struct packet *packet,
		   struct glass *glass)
{
	const vi number = vi_load(packet->hit.hit.geomID + first);
	const vm valid = load_mask(packet->valid + first);
	const vm met = vm_and(valid, vi_nonzero(vi_add(number, vi_set(1))));
	const vm missed = vm_but(valid, met);
	if (vm_any(missed)) {
		const struct ways way = load_ways(&packet->hit.ray, first);
		gather_surroundings(cast, way.origin, way.direction, vf_set(1),
				    (struct lanes) { first, missed }, glass);
	}
	for (unsigned i = 0; i < cast->mesh_count; i++) {
		const vi other = vi_add(number, vi_set(-(int32_t)i));
		const vm mask = vm_but(met, vi_nonzero(other));
		if (vm_any(mask))
			bend_lanes(cast, i, (struct lanes) { first, mask }, packet, glass);
	}
	relaunch_lanes(cast, first, packet);
	store_mask(met, packet->valid + first);
	return vm_any(met);
}

/* Begin with rays that gather everything. */
SIMD void begin_glass(int first, struct glass *glass)
{
	for (int i = 0; i < 3; i++) {
		vf_store(glass->light[i] + first, vf_set(0));
		vf_store(glass->weight[i] + first, vf_set(1));
	}
	for (int i = first; i < first + SIMD_LANES; i++)
		glass->inside[i] = 0;
}

/* Note the depth and the object that rays have met first. */
SIMD void note_first_hits(const struct gz_surface_cast *cast, int first,
			  const struct packet *packet, struct gz_surface_hits *hits)
{
	const vi number = vi_load(packet->hit.hit.geomID + first);
	const vm met =
		vm_and(load_mask(packet->valid + first), vi_nonzero(vi_add(number, vi_set(1))));
	const vf depth = vf_load(packet->hit.ray.tfar + first) * vf_set(cast->frame.world_per_mm);
	vi id = vi_set(0);
	for (unsigned i = 0; i < cast->mesh_count; i++) {
		const vm mask = vm_but(met, vi_nonzero(vi_add(number, vi_set(-(int32_t)i))));
		id = vi_select(mask, vi_set((int32_t)cast->meshes[i].id), id);
	}
	vf_store(hits->depth + first, vf_select(met, depth, vf_set(INFINITY)));
	vi_store(hits->ids + first, id);
}

/* The pixels of what rays have gathered. */
SIMD void glass_pixels(int first, const struct glass *glass, struct gz_surface_hits *hits)
{
	const struct rgb rgb = { { vf_load(glass->light[0] + first),
				   vf_load(glass->light[1] + first),
				   vf_load(glass->light[2] + first) } };
	vi_store(hits->pixels + first, pack_rgb(&rgb));
}

#endif
