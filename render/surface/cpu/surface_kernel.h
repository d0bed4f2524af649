/*
 * The kernel: one tile of rays through triangle meshes, compiled once for each instruction set as
 * render/raycast/cpu/cast_kernel.h explains. Embree finds the triangles; the rest is here.
 */
#ifndef GZ_RENDER_SURFACE_CPU_SURFACE_KERNEL_H
#define GZ_RENDER_SURFACE_CPU_SURFACE_KERNEL_H

#include "render/raycast/cpu/simd_light.h"
#include "render/raycast/cpu/simd_surroundings.h"
#include "render/surface/cpu/surface_cast.h"
#include "render/surface/cpu/surface_field.h"
#include "render/surface/cpu/surface_glass.h"
#include "render/surface/cpu/surface_packet.h"
#include "render/surface/cpu/surface_trace.h"

/*
 * Lift places from where the lanes of the mask have met a mesh to where the planes of the corners'
 * normals would have them: a ray that began on its triangle would meet the neighbours of a surface
 * that is meant to be round (Hanika, "Hacking the shadow terminator", Ray Tracing Gems II, 2021,
 * chapter 4).
 */
SIMD void lift_places(const struct gz_surface_mesh *mesh, const struct meeting *at, vf side,
		      vm mask, vf place[3])
{
	vf corners[3][3];
	load_corners(mesh, at->triangle, mask, corners);
	for (int corner = 0; corner < 3; corner++) {
		vf from[3];
		for (int axis = 0; axis < 3; axis++)
			from[axis] = at->place[axis] - corners[corner][axis];
		const vf below = side * dot_lanes(from, at->corner_normals[corner]);
		const vf lift = vf_max(vf_set(0) - below, vf_set(0)) * at->shares[corner] * side;
		for (int axis = 0; axis < 3; axis++)
			place[axis] = vf_fma(lift, at->corner_normals[corner][axis], place[axis]);
	}
}

/* Whether the way from a surface to the light is looked at. */
SIMD int follows_light(const struct gz_surface_cast *cast)
{
	return cast->frame.shadows || cast->shade_count > 0;
}

/* Begin the shadow rays, a little above the surface because places are rounded. */
SIMD void aim_shadows(const struct gz_surface_cast *cast, unsigned number, const struct meeting *at,
		      const struct view *view, struct lanes lanes, struct packet *packet)
{
	const int first = lanes.first;
	struct RTCRay16 *ray = &packet->shadow;
	float *const origins[3] = { ray->org_x, ray->org_y, ray->org_z };
	const vm behind = vf_less(dot_lanes(at->normal, view->eye), vf_set(0));
	const vf side = vf_select(behind, vf_set(-1), vf_set(1));
	vf place[3];
	for (int axis = 0; axis < 3; axis++)
		place[axis] =
			vf_fma(side * vf_set(cast->frame.lift), at->normal[axis], at->place[axis]);
	if (!cast->field.on || number != cast->field.number)
		lift_places(&cast->meshes[number], at, side, lanes.mask, place);
	const vf towards[3] = { vf_set(cast->frame.light.towards[0]),
				vf_set(cast->frame.light.towards[1]),
				vf_set(cast->frame.light.towards[2]) };
	vf from = vf_set(0), to = vf_set(INFINITY);
	if (cast->frame.clipped)
		(void)clip_lanes(cast, place, towards, &from, &to);
	put_lanes(lanes.mask, to, ray->tfar + first);
	for (int axis = 0; axis < 3; axis++)
		put_lanes(lanes.mask, place[axis], origins[axis] + first);
}

SIMD void clear_mirrored(int first, struct packet *packet)
{
	vf_store(packet->mirrored_share + first, vf_set(0));
	for (int channel = 0; channel < 3; channel++)
		vf_store(packet->mirrored[channel] + first, vf_set(0));
}

/* Note what the lanes of the mask mirror. */
SIMD void mirror_lanes(const struct gz_surface_cast *cast, const struct meeting *at,
		       const struct view *view, struct lanes lanes, struct packet *packet)
{
	const struct mirrored mirrored =
		find_mirrored(&cast->frame.around, cast->frame.light.reflection, at->place,
			      at->normal, view->eye);
	put_lanes(lanes.mask, mirrored.share, packet->mirrored_share + lanes.first);
	for (int channel = 0; channel < 3; channel++)
		put_lanes(lanes.mask, mirrored.seen.channel[channel],
			  packet->mirrored[channel] + lanes.first);
}

/* Light what the lanes of the mask have met, all of one mesh. Returns the lanes that the light
 * would reach if nothing stood between. */
SIMD vm light_lanes(const struct gz_surface_cast *cast, unsigned number, struct lanes lanes,
		    struct packet *packet, struct gz_surface_hits *hits)
{
	const struct gz_surface_mesh *mesh = &cast->meshes[number];
	const int first = lanes.first;
	const vm mask = lanes.mask;
	const struct RTCRay16 *ray = &packet->hit.ray;
	const float *const origins[3] = { ray->org_x, ray->org_y, ray->org_z };
	const float *const directions[3] = { ray->dir_x, ray->dir_y, ray->dir_z };
	struct meeting at = read_meeting(cast, number, packet, lanes);
	struct view view;
	const vf distance = vf_load(ray->tfar + first);
	vf length2 = vf_set(1e-12F); /* not 0 where eye and light are opposite */
	for (int axis = 0; axis < 3; axis++) {
		const vf direction = vf_load(directions[axis] + first);
		at.place[axis] = vf_fma(distance, direction, vf_load(origins[axis] + first));
		view.eye[axis] = vf_set(0) - direction;
		view.half[axis] = view.eye[axis] + vf_set(cast->frame.light.towards[axis]);
		length2 = vf_fma(view.half[axis], view.half[axis], length2);
	}
	const vf inverse = vf_set(1) / vf_sqrt(length2);
	for (int axis = 0; axis < 3; axis++)
		view.half[axis] = view.half[axis] * inverse;
	const struct shine shine = find_shine(&cast->frame.light, &view, at.normal, vf_set(0));
	const vi id = vi_load(hits->ids + first);
	vi_store(hits->ids + first, vi_select(mask, vi_set((int32_t)mesh->id), id));
	put_lanes(mask, shine.factor, packet->factor + first);
	put_lanes(mask, shine.white, packet->white + first);
	if (cast->frame.light.reflection > 0)
		mirror_lanes(cast, &at, &view, lanes, packet);
	for (int channel = 0; channel < 3; channel++)
		put_lanes(mask, vf_set(mesh->colour[channel]), packet->colour[channel] + first);
	if (!follows_light(cast))
		return mask;
	aim_shadows(cast, number, &at, &view, lanes, packet);
	return vm_and(mask, vf_less(vf_set(cast->frame.light.ambient), shine.factor));
}

/* Light what SIMD_LANES rays from number `first` on have met. packet->valid becomes the rays that
 * the light would reach if nothing stood between. Returns whether there are any. */
SIMD int light_hits(const struct gz_surface_cast *cast, int first, struct packet *packet,
		    struct gz_surface_hits *hits)
{
	const vi number = vi_load(packet->hit.hit.geomID + first);
	const vm valid = load_mask(packet->valid + first);
	const vm met = vm_and(valid, vi_nonzero(vi_add(number, vi_set(1))));
	vm lit = vm_but(met, met);
	vi_store(hits->ids + first, vi_set(0));
	vf_store(packet->factor + first, vf_set(0));
	vf_store(packet->white + first, vf_set(0));
	for (int channel = 0; channel < 3; channel++)
		vf_store(packet->colour[channel] + first, vf_set(0));
	if (cast->frame.light.reflection > 0)
		clear_mirrored(first, packet);
	/* Each mesh once that some lane has met: there may be hundreds of others. */
	vm left = met;
	unsigned last = cast->mesh_count;
	for (int lane = 0; lane < SIMD_LANES; lane++) {
		const unsigned i = packet->hit.hit.geomID[first + lane];
		if (i == last || i >= cast->mesh_count)
			continue;
		last = i;
		const vi other = vi_add(number, vi_set(-(int32_t)i));
		const vm mask = vm_but(left, vi_nonzero(other));
		left = vm_but(left, mask);
		if (vm_any(mask))
			lit = vm_or(lit, light_lanes(cast, i, (struct lanes) { first, mask },
						     packet, hits));
	}
	const vf depth = vf_load(packet->hit.ray.tfar + first) * vf_set(cast->frame.world_per_mm);
	vf_store(hits->depth + first, vf_select(met, depth, vf_set(INFINITY)));
	store_mask(lit, packet->valid + first);
	return vm_any(lit);
}

/* What the shadow rays of all lanes share. Those that are not cast are valid, too, and have ended:
 * where Embree cuts a packet into smaller ones, it looks at all of their rays. */
SIMD void begin_shadows(const struct gz_surface_cast *cast, int first, struct packet *packet)
{
	struct RTCRay16 *ray = &packet->shadow;
	float *const origins[3] = { ray->org_x, ray->org_y, ray->org_z };
	float *const directions[3] = { ray->dir_x, ray->dir_y, ray->dir_z };
	vf_store(ray->tnear + first, vf_set(0));
	vf_store(ray->tfar + first, vf_set(-INFINITY));
	vf_store(ray->time + first, vf_set(0));
	vi_store(ray->mask + first, vi_set(-1));
	vi_store(ray->flags + first, vi_set(0));
	for (int axis = 0; axis < 3; axis++) {
		vf_store(origins[axis] + first, vf_set(0));
		vf_store(directions[axis] + first, vf_set(cast->frame.light.towards[axis]));
	}
}

/* Take the light from the rays whose shadow ray has met something: it ends at -INFINITY. */
SIMD void darken_lanes(const struct gz_surface_cast *cast, int first, struct packet *packet)
{
	const vm lit = load_mask(packet->valid + first);
	const vm dark = vm_and(lit, vf_less(vf_load(packet->shadow.tfar + first), vf_set(0)));
	put_lanes(dark, vf_set(cast->frame.light.ambient), packet->factor + first);
	put_lanes(dark, vf_set(0), packet->white + first);
}

/* Take from the light what others keep back of it, where no surface does. */
static __attribute__((noinline)) void dim_by_shades(const struct gz_surface_cast *cast, float step,
						    struct packet *packet)
{
	const struct RTCRay16 *ray = &packet->shadow;
	const float *const origins[3] = { ray->org_x, ray->org_y, ray->org_z };
	const float ambient = cast->frame.light.ambient;
	struct gz_shade_places places = { .step = step };
	for (int i = 0; i < GZ_SURFACE_RAYS; i++) {
		places.active |= (uint32_t)(packet->valid[i] && ray->tfar[i] >= 0) << i;
		for (int axis = 0; axis < 3; axis++)
			places.at[axis][i] = origins[axis][i] * cast->frame.world_per_mm;
	}
	for (size_t k = 0; k < cast->shade_count && places.active; k++) {
		float shares[GZ_SHADE_PLACES];
		cast->shades[k].find(cast->shades[k].user, &places, shares);
		for (int i = 0; i < GZ_SURFACE_RAYS; i++) {
			const float share = places.active >> i & 1 ? shares[i] : 1;
			packet->factor[i] = ambient + share * (packet->factor[i] - ambient);
			packet->white[i] *= share;
		}
	}
}

SIMD void colour_lanes(const struct gz_surface_cast *cast, int first, const struct packet *packet,
		       struct gz_surface_hits *hits)
{
	const vm met = vi_nonzero(vi_load(hits->ids + first));
	const vf factor = vf_load(packet->factor + first), white = vf_load(packet->white + first);
	vi pixel = vi_set((int32_t)0xFF000000);
	for (int channel = 0; channel < 3; channel++) {
		const vf colour = vf_load(packet->colour[channel] + first);
		vf lit = vf_fma(colour, factor, white);
		if (cast->frame.light.reflection > 0)
			lit = lerp_lanes(vf_min(lit, vf_set(1)),
					 vf_load(packet->mirrored[channel] + first),
					 vf_load(packet->mirrored_share + first));
		const vi byte = to_byte(lit);
		pixel = vi_or(pixel, channel == 0   ? byte
				     : channel == 1 ? vi_shift_left(byte, 8)
						    : vi_shift_left(byte, 16));
	}
	vi behind = vi_set((int32_t)cast->frame.background);
	if (cast->frame.around.kind != GZ_SURROUNDINGS_NONE) {
		const struct ways way = load_ways(&packet->hit.ray, first);
		const struct rgb seen =
			see_surroundings(&cast->frame.around, way.origin, way.direction);
		behind = pack_rgb(&seen);
	}
	vi_store(hits->pixels + first, vi_select(met, pixel, behind));
}

#define EACH_REGISTER for (int first = 0; first < GZ_SURFACE_RAYS; first += SIMD_LANES)

/* Find what the rays of a packet meet first. */
SIMD void meet_surfaces(const struct gz_surface_cast *cast, bool coherent, struct packet *packet)
{
	trace_first(cast, coherent, packet);
	if (cast->field.on)
		EACH_REGISTER meet_field(cast, first, packet);
}

/* Follow the rays of a packet through glass, after their first triangles have been found. */
SIMD void follow_through_glass(const struct gz_surface_cast *cast, bool coherent,
			       struct packet *packet, struct gz_surface_hits *out_hits)
{
	struct glass glass;
	EACH_REGISTER
	{
		begin_glass(first, &glass);
		note_first_hits(cast, first, packet, out_hits);
	}
	for (int met = 0;; met++) {
		int any = 0;
		EACH_REGISTER any |= bend_hits(cast, first, packet, &glass);
		if (!any || met + 1 == cast->frame.bounces)
			break;
		meet_surfaces(cast, coherent, packet);
	}
	EACH_REGISTER
	{
		const struct ways way = load_ways(&packet->hit.ray, first);
		gather_surroundings(cast, way.origin, way.direction, vf_set(1),
				    (struct lanes) { first, load_mask(packet->valid + first) },
				    &glass);
		glass_pixels(first, &glass, out_hits);
	}
}

/* Aim rays from some places to the light, as far as the clip region reaches. */
SIMD void aim_from_places(const struct gz_surface_cast *cast, const struct gz_shade_places *places,
			  int first, struct packet *packet)
{
	struct RTCRay16 *ray = &packet->shadow;
	float *const origins[3] = { ray->org_x, ray->org_y, ray->org_z };
	const vf mm = vf_set(1 / cast->frame.world_per_mm);
	const vf towards[3] = { vf_set(cast->frame.light.towards[0]),
				vf_set(cast->frame.light.towards[1]),
				vf_set(cast->frame.light.towards[2]) };
	vm valid = vm_from_bits(places->active >> first);
	vf place[3], from = vf_set(places->from) * mm, to = vf_set(INFINITY);
	begin_shadows(cast, first, packet);
	for (int axis = 0; axis < 3; axis++)
		place[axis] = vf_load(places->at[axis] + first) * mm;
	if (cast->frame.clipped)
		valid = vm_and(valid, clip_lanes(cast, place, towards, &from, &to));
	for (int axis = 0; axis < 3; axis++)
		put_lanes(valid, place[axis], origins[axis] + first);
	put_lanes(valid, from, ray->tnear + first);
	put_lanes(valid, to, ray->tfar + first);
	store_mask(valid, packet->valid + first);
}

/* gz_surface_lit_function */
static void find_lit_places(const struct gz_surface_cast *cast,
			    const struct gz_shade_places *places, float out_shares[GZ_SHADE_PLACES])
{
	struct packet packet;
	EACH_REGISTER aim_from_places(cast, places, first, &packet);
	trace_shadows(cast, true, &packet);
	if (cast->field.on)
		EACH_REGISTER shade_by_field(cast, first, &packet);
	EACH_REGISTER
	{
		const vm valid = load_mask(packet.valid + first);
		const vm met = vf_less(vf_load(packet.shadow.tfar + first), vf_set(0));
		vf_store(out_shares + first, vf_select(vm_and(valid, met), vf_set(0), vf_set(1)));
	}
}

/* Cast a tile: gz_surface_tile_function. */
static void cast_surface_tile(const struct gz_surface_cast *cast,
			      const struct gz_surface_tile *tile, struct gz_surface_hits *out_hits)
{
	struct packet packet;
	int any_lit = 0;
	EACH_REGISTER
	{
		aim_lanes(cast, tile, first, &packet);
		if (follows_light(cast))
			begin_shadows(cast, first, &packet);
	}
	meet_surfaces(cast, tile->coherent, &packet);
	if (cast->frame.bounces) {
		follow_through_glass(cast, tile->coherent, &packet, out_hits);
		return;
	}
	EACH_REGISTER any_lit |= light_hits(cast, first, &packet, out_hits);
	if (cast->frame.shadows && any_lit) {
		trace_shadows(cast, tile->coherent, &packet);
		if (cast->field.on)
			EACH_REGISTER shade_by_field(cast, first, &packet);
		EACH_REGISTER darken_lanes(cast, first, &packet);
	}
	if (cast->shade_count > 0 && any_lit)
		dim_by_shades(cast, tile->step, &packet);
	EACH_REGISTER colour_lanes(cast, first, &packet, out_hits);
}

#endif
