/*
 * The surface of a volume without triangles: the rays of a packet find where the data first cross
 * the isovalue. A part of the kernel: see surface_kernel.h.
 *
 * Between the middles of eight voxels the data are trilinear, and along a ray a polynomial of the
 * third degree (Marmitt et al., "Fast and Accurate Ray-Voxel Intersection Techniques for
 * Iso-Surface Ray Tracing", VMV 2004). A ray goes from one such cube to the next, over macrocells
 * whose range does not hold the isovalue. Where the eight voxels lie on both sides of it, the
 * polynomial is made of four values, its extremes and its end show where it first crosses, and
 * bisection finds the place. So nothing is missed, however thin. Rays
 * from the surface begin a little off it, on the side that they go to. As with triangles, the
 * surface lies between the middles of the outermost voxels, and its normals are central differences
 * of the data.
 */
#ifndef GZ_RENDER_SURFACE_CPU_SURFACE_FIELD_H
#define GZ_RENDER_SURFACE_CPU_SURFACE_FIELD_H

#include "render/raycast/cpu/cast_fetch.h"
#include "render/surface/cpu/surface_cast.h"
#include "render/surface/cpu/surface_packet.h"

/* Crossings of the isovalue that lanes look for. Places along rays count finest voxel edges. */
struct crossing {
	vf from, length; /* the part of the ray that crosses */
	vf powers[4];    /* the data less the isovalue there, by powers of the share of that part */
	vf before, behind; /* shares between which it crosses */
	vm found;
	vm above; /* lanes that lie above the isovalue before it */
};

SIMD vm vm_either(vm a, vm b)
{
	return vm_or(vm_but(a, b), vm_but(b, a));
}

/* Which of the places k steps along the rays lie above the isovalue. */
SIMD vm is_above(const struct gz_surface_field *field, const struct rays *rays, vf k, vm mask)
{
	vf at[3];
	for (int axis = 0; axis < 3; axis++)
		at[axis] = vf_fma(k, rays->delta[axis], rays->datum[axis]);
	const vf value = sample_trilinear(&field->voxels, field->type, at, mask);
	return vm_and(mask, vf_less(vf_set(field->value), value));
}

/* Rays of SIMD_LANES in voxels and steps. */
SIMD struct rays rays_through_field(const struct gz_surface_field *field, const vf origin[3],
				    const vf direction[3])
{
	struct rays rays = { .view = NULL };
	for (int axis = 0; axis < 3; axis++) {
		const vf per_mm = vf_set(field->voxels_per_mm[axis]), least = vf_set(1e-12F);
		const vf raw = direction[axis] * per_mm * vf_set(field->step_mm);
		rays.delta[axis] = vf_select(vf_less(vf_abs(raw), least), least, raw);
		rays.inverse[axis] = vf_set(1) / rays.delta[axis];
		rays.start[axis] =
			vf_fma(origin[axis], per_mm, vf_set(0.5F * field->voxels.dims[axis]));
		rays.datum[axis] = rays.start[axis] - vf_set(0.5F);
	}
	return rays;
}

/* Cut rays where the surface can be: between the middles of the outermost voxels. */
SIMD vm cut_by_field(const struct gz_surface_field *field, const struct rays *rays, vf *from,
		     vf *to)
{
	for (int axis = 0; axis < 3; axis++) {
		const vf last = vf_set(field->voxels.dims[axis] - 1);
		const vf low = (vf_set(0) - rays->datum[axis]) * rays->inverse[axis];
		const vf high = (last - rays->datum[axis]) * rays->inverse[axis];
		*from = vf_max(*from, vf_min(low, high));
		*to = vf_min(*to, vf_max(low, high));
	}
	return vf_less(*from, *to);
}

/* The eight voxels around a cube; bits of their numbers are axes. */
SIMD void load_cube(const struct gz_surface_field *field, const vi cube[3], vm mask, vf out[8])
{
	const struct gz_cast *voxels = &field->voxels;
	const vi up_y = vi_set(voxels->stride[1]), up_z = vi_set(voxels->stride[2]);
	const vi first = vi_add(cube[0], vi_add(vi_mul(cube[1], up_y), vi_mul(cube[2], up_z)));
	const vi rows[4] = { first, vi_add(first, up_y), vi_add(first, up_z),
			     vi_add(vi_add(first, up_y), up_z) };
	for (int i = 0; i < 4; i++)
		load_pair(voxels, field->type, rows[i], mask, &out[2 * i], &out[2 * i + 1]);
}

/* The data less the isovalue k along the rays, from the cube around. */
SIMD vf value_in_cube(const struct gz_surface_field *field, const struct rays *rays,
		      const vi cube[3], const vf corners[8], vf k)
{
	vf share[3];
	for (int axis = 0; axis < 3; axis++)
		share[axis] =
			vf_fma(k, rays->delta[axis], rays->datum[axis]) - vf_from_i(cube[axis]);
	const vf low = mix(mix(corners[0], corners[1], share[0]),
			   mix(corners[2], corners[3], share[0]), share[1]);
	const vf high = mix(mix(corners[4], corners[5], share[0]),
			    mix(corners[6], corners[7], share[0]), share[1]);
	return mix(low, high, share[2]) - vf_set(field->value);
}

SIMD vf polynomial(const vf powers[4], vf t)
{
	return vf_fma(vf_fma(vf_fma(powers[3], t, powers[2]), t, powers[1]), t, powers[0]);
}

/* The polynomial with these values at 0, 1/3, 2/3 and 1. */
SIMD void interpolate_powers(const vf at[4], vf powers[4])
{
	powers[0] = at[0];
	powers[1] = vf_set(-5.5F) * at[0] + vf_set(9) * at[1] + vf_set(-4.5F) * at[2] + at[3];
	powers[2] = vf_set(9) * at[0] + vf_set(-22.5F) * at[1] + vf_set(18) * at[2] +
		    vf_set(-4.5F) * at[3];
	powers[3] = vf_set(-4.5F) * at[0] + vf_set(13.5F) * at[1] + vf_set(-13.5F) * at[2] +
		    vf_set(4.5F) * at[3];
}

/* A share within the part, or its end for anything else, NaN included. */
SIMD vf within_part(vf t)
{
	const vm within = vm_and(vf_less(vf_set(0), t), vf_less(t, vf_set(1)));
	return vf_select(within, t, vf_set(1));
}

/* Where the polynomial is extreme, in order: roots of its derivative. */
SIMD void find_extremes(const vf powers[4], vf out[2])
{
	const vf three = vf_set(3) * powers[3], half = powers[2];
	const vf inner = half * half - three * powers[1];
	const vf root = vf_sqrt(vf_max(inner, vf_set(0)));
	const vm negative = vf_less(half, vf_set(0));
	const vf sum = vf_select(negative, root - half, vf_set(0) - root - half);
	const vm none = vf_less(inner, vf_set(0));
	const vf first = vf_select(none, vf_set(1), within_part(sum / three));
	const vf second = vf_select(none, vf_set(1), within_part(powers[1] / sum));
	out[0] = vf_min(first, second);
	out[1] = vf_max(first, second);
}

/* Look for lanes' first crossing within a cube, between k and next. Returns those that cross. */
SIMD vm cross_cube(const struct gz_surface_field *field, const struct rays *rays, vm mask, vf k,
		   vf next, struct crossing *out)
{
	vi cube[3];
	vf corners[8], at[4], powers[4], places[3], lowest, highest;
	const vf length = next - k, middle = vf_fma(length, vf_set(0.5F), k);
	for (int axis = 0; axis < 3; axis++) {
		const vf place = vf_fma(middle, rays->delta[axis], rays->datum[axis]);
		cube[axis] = vi_min(vi_trunc(vf_max(place, vf_set(0))),
				    vi_set(field->voxels.last[axis]));
	}
	load_cube(field, cube, mask, corners);
	lowest = highest = corners[0];
	for (int i = 1; i < 8; i++) {
		lowest = vf_min(lowest, corners[i]);
		highest = vf_max(highest, corners[i]);
	}
	/* all on the side that the ray is on */
	const vm all_above = vf_less(vf_set(field->value), lowest);
	const vm any_above = vf_less(vf_set(field->value), highest);
	const vm same = vm_or(vm_and(all_above, out->above),
			      vm_but(vm_but(vm_all(), any_above), out->above));
	const vm may = vm_but(mask, same);
	if (!vm_any(may))
		return may;
	for (int i = 0; i < 4; i++)
		at[i] = value_in_cube(field, rays, cube, corners,
				      vf_fma(length, vf_set((float)i / 3), k));
	interpolate_powers(at, powers);
	find_extremes(powers, places);
	places[2] = vf_set(1);
	vm found = vm_but(may, may);
	vf before = vf_set(0);
	for (int i = 0; i < 3; i++) {
		const vf value = i < 2 ? polynomial(powers, places[i]) : at[3];
		const vm above = vf_less(vf_set(0), value);
		const vm crosses = vm_and(vm_but(may, found), vm_either(above, out->above));
		out->before = vf_select(crosses, before, out->before);
		out->behind = vf_select(crosses, places[i], out->behind);
		found = vm_or(found, crosses);
		before = places[i];
	}
	for (int i = 0; i < 4; i++)
		out->powers[i] = vf_select(found, powers[i], out->powers[i]);
	out->from = vf_select(found, k, out->from);
	out->length = vf_select(found, length, out->length);
	return found;
}

/* The next face of a cube behind k, or a little farther where rounding puts it before. */
SIMD vf next_face(const struct rays *rays, vf k)
{
	vf next = k + vf_set(2);
	for (int axis = 0; axis < 3; axis++) {
		const vf place = vf_fma(k, rays->delta[axis], rays->datum[axis]);
		const vm forward = vf_less(vf_set(0), rays->delta[axis]);
		const vf face =
			vf_select(forward, vf_floor(place) + vf_set(1), vf_ceil(place) - vf_set(1));
		next = vf_min(next, (face - rays->datum[axis]) * rays->inverse[axis]);
	}
	return vf_max(next, k + vf_set(GZ_FIELD_ONWARD));
}

/* Find where lanes first cross, from k on. */
SIMD void find_crossing(const struct gz_surface_field *field, const struct rays *rays, vm running,
			vf k, vf to, struct crossing *out)
{
	vf until = vf_set(-1); /* up to here cells hold the isovalue */
	while (vm_any(running)) {
		const vm asks = vm_but(running, vf_less(k, until));
		vf next = vf_min(next_face(rays, k), to);
		vm takes = running;
		if (vm_any(asks)) {
			vf leave;
			const vm empty =
				vm_and(asks, look_up_cell(&field->voxels, rays, k, asks, &leave));
			until = vf_select(vm_but(asks, empty), leave, until);
			const vf onward = vf_max(leave, k + vf_set(GZ_FIELD_ONWARD));
			next = vf_select(empty, vf_min(onward, to), next);
			takes = vm_but(running, empty);
		}
		if (vm_any(takes)) {
			const vm crosses = cross_cube(field, rays, takes, k, next, out);
			out->found = vm_or(out->found, crosses);
			running = vm_but(running, crosses);
		}
		k = next;
		running = vm_and(running, vf_less(k, to));
	}
}

SIMD vf bisect_crossing(struct crossing *crossing)
{
	for (int i = 0; i < GZ_FIELD_BISECTIONS; i++) {
		const vf middle = (crossing->before + crossing->behind) * vf_set(0.5F);
		const vm above = vf_less(vf_set(0), polynomial(crossing->powers, middle));
		const vm other = vm_either(above, crossing->above);
		crossing->before = vf_select(other, crossing->before, middle);
		crossing->behind = vf_select(other, middle, crossing->behind);
	}
	return vf_fma(crossing->behind, crossing->length, crossing->from);
}

/* Where lanes of the mask first cross, between these distances in mm, of which the second becomes
 * that of the crossing. Not inlined: all voxel types are in it. */
static __attribute__((noinline)) struct crossing cross_field(const struct gz_surface_field *field,
							     const struct ways *way, vm mask,
							     vf from_mm, vf *to_mm)
{
	const struct rays rays = rays_through_field(field, way->origin, way->direction);
	const vf per_mm = vf_set(1 / field->step_mm);
	vf from = from_mm * per_mm, to = *to_mm * per_mm;
	const vm running = vm_and(mask, cut_by_field(field, &rays, &from, &to));
	const vf none = vf_set(0);
	struct crossing crossing = {
		.from = none,
		.length = none,
		.powers = { none, none, none, none },
		.before = none,
		.behind = none,
		.found = vm_but(running, running),
		.above = vm_but(running, running),
	};
	if (!vm_any(running))
		return crossing;
	crossing.above = is_above(field, &rays, from, running);
	find_crossing(field, &rays, running, from, to, &crossing);
	if (vm_any(crossing.found)) {
		const vf at = bisect_crossing(&crossing) * vf_set(field->step_mm);
		*to_mm = vf_select(crossing.found, at, *to_mm);
	}
	return crossing;
}

/* Let the rays of a packet meet the field, where it lies nearer than what they have met. */
SIMD void meet_field(const struct gz_surface_cast *cast, int first, struct packet *packet)
{
	struct RTCRayHit16 *hit = &packet->hit;
	const vm valid = load_mask(packet->valid + first);
	if (!vm_any(valid))
		return;
	const struct ways way = load_ways(&hit->ray, first);
	vf to = vf_load(hit->ray.tfar + first);
	const struct crossing crossing =
		cross_field(&cast->field, &way, valid, vf_load(hit->ray.tnear + first), &to);
	vf_store(hit->ray.tfar + first, to);
	const vi number = vi_load(hit->hit.geomID + first);
	vi_store(hit->hit.geomID + first,
		 vi_select(crossing.found, vi_set((int32_t)cast->field.number), number));
}

/* End the shadow rays of a packet that meet the field, as Embree does: at -INFINITY. */
SIMD void shade_by_field(const struct gz_surface_cast *cast, int first, struct packet *packet)
{
	struct RTCRay16 *ray = &packet->shadow;
	const vm lit = vm_and(load_mask(packet->valid + first),
			      vf_less(vf_set(0), vf_load(ray->tfar + first)));
	if (!vm_any(lit))
		return;
	const struct ways way = load_ways(ray, first);
	vf to = vf_load(ray->tfar + first);
	const struct crossing crossing =
		cross_field(&cast->field, &way, lit, vf_load(ray->tnear + first), &to);
	put_lanes(crossing.found, vf_set(-INFINITY), ray->tfar + first);
}

/* Where the lanes of the mask have met the field. Its normal points upwards. */
static __attribute__((noinline)) struct meeting read_field(const struct gz_surface_cast *cast,
							   const struct packet *packet,
							   struct lanes lanes)
{
	const struct gz_surface_field *field = &cast->field;
	const struct ways way = load_ways(&packet->hit.ray, lanes.first);
	const vf distance = vf_load(packet->hit.ray.tfar + lanes.first);
	struct meeting at = { .triangle = vi_set(0) }; /* a field has none */
	vf places[3], length2 = vf_set(1e-30F);
	for (int axis = 0; axis < 3; axis++) {
		at.place[axis] = vf_fma(distance, way.direction[axis], way.origin[axis]);
		places[axis] = vf_fma(at.place[axis], vf_set(field->voxels_per_mm[axis]),
				      vf_set(0.5F * field->voxels.dims[axis] - 0.5F));
	}
	for (int axis = 0; axis < 3; axis++) {
		vf side[2];
		for (int i = 0; i < 2; i++) {
			vf there[3] = { places[0], places[1], places[2] };
			there[axis] = there[axis] + vf_set(i ? 1.0F : -1.0F);
			side[i] = sample_trilinear(&field->voxels, field->type, there, lanes.mask);
		}
		at.normal[axis] = (side[1] - side[0]) * vf_set(field->voxels_per_mm[axis]);
		length2 = vf_fma(at.normal[axis], at.normal[axis], length2);
	}
	const vf inverse = vf_set(1) / vf_sqrt(length2);
	for (int axis = 0; axis < 3; axis++)
		at.normal[axis] = at.normal[axis] * inverse;
	return at;
}

/* Where the lanes of the mask have met something, all of one mesh or of the field. */
SIMD struct meeting read_meeting(const struct gz_surface_cast *cast, unsigned number,
				 const struct packet *packet, struct lanes lanes)
{
	if (cast->field.on && number == cast->field.number)
		return read_field(cast, packet, lanes);
	return read_triangles(&cast->meshes[number], packet, lanes);
}

#endif
