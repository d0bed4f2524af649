/*
 * A tile's rays as Embree takes them, and what they have met. A part of the kernel: see
 * surface_kernel.h.
 */
#ifndef GZ_RENDER_SURFACE_CPU_SURFACE_PACKET_H
#define GZ_RENDER_SURFACE_CPU_SURFACE_PACKET_H

#include <math.h>
#include <stdalign.h>

#include "render/raycast/cpu/simd_clip.h"
#include "render/raycast/cpu/simd_light.h"
#include "render/surface/cpu/surface_cast.h"

/* A tile on its way. The arrays of Embree's structs are in memory. */
struct packet {
	struct RTCRayHit16 hit;
	struct RTCRay16 shadow;
	alignas(64) int valid[GZ_SURFACE_RAYS]; /* -1: cast this ray */
	alignas(64) float factor[GZ_SURFACE_RAYS];
	float white[GZ_SURFACE_RAYS];
	alignas(64) float colour[3][GZ_SURFACE_RAYS]; /* of what each ray has met */
	/* With light.reflection: what it mirrors, and with which share. */
	float mirrored[3][GZ_SURFACE_RAYS], mirrored_share[GZ_SURFACE_RAYS];
};

SIMD void store_mask(vm mask, int *out)
{
	vi_store((uint32_t *)out, vi_select(mask, vi_set(-1), vi_set(0)));
}

SIMD vm load_mask(const int *mask)
{
	return vi_nonzero(vi_load(mask));
}

/* Store the lanes of the mask. */
SIMD void put_lanes(vm mask, vf a, float *out)
{
	vf_store(out, vf_select(mask, a, vf_load(out)));
}

/* Cut rays by the clip region. Returns the lanes of which something is left. */
SIMD vm clip_lanes(const struct gz_surface_cast *cast, const vf origin[3], const vf direction[3],
		   vf *from, vf *to)
{
	for (int axis = 0; axis < 3; axis++) {
		const vf least = vf_set(1e-12F);
		const vf along =
			vf_select(vf_less(vf_abs(direction[axis]), least), least, direction[axis]);
		const vf low = (vf_set(cast->frame.clip_least[axis]) - origin[axis]) / along;
		const vf high = (vf_set(cast->frame.clip_greatest[axis]) - origin[axis]) / along;
		*from = vf_max(*from, vf_min(low, high));
		*to = vf_min(*to, vf_max(low, high));
	}
	cut_by_plane(cast->frame.clip_plane, origin, direction, from, to);
	return vf_less(*from, *to);
}

/* Set up the rays of SIMD_LANES pixels from number `first` on. */
SIMD void aim_lanes(const struct gz_surface_cast *cast, const struct gz_surface_tile *tile,
		    int first, struct packet *packet)
{
	struct RTCRay16 *ray = &packet->hit.ray;
	float *const origins[3] = { ray->org_x, ray->org_y, ray->org_z };
	float *const directions[3] = { ray->dir_x, ray->dir_y, ray->dir_z };
	const vf x = vf_load(tile->x + first), y = vf_load(tile->y + first);
	vf origin[3], direction[3], from = vf_set(0), to = vf_set(INFINITY);
	vm valid = vm_from_bits(tile->active >> first);
	for (int axis = 0; axis < 3; axis++) {
		origin[axis] = vf_fma(y, vf_set(cast->frame.origin_dy[axis]),
				      vf_fma(x, vf_set(cast->frame.origin_dx[axis]),
					     vf_set(cast->frame.origin00[axis])));
		direction[axis] = vf_fma(y, vf_set(cast->frame.direction_dy[axis]),
					 vf_fma(x, vf_set(cast->frame.direction_dx[axis]),
						vf_set(cast->frame.direction00[axis])));
	}
	const vf inverse = vf_set(1) / vf_sqrt(dot_lanes(direction, direction));
	for (int axis = 0; axis < 3; axis++) {
		direction[axis] = direction[axis] * inverse;
		vf_store(origins[axis] + first, origin[axis]);
		vf_store(directions[axis] + first, direction[axis]);
	}
	if (cast->frame.clipped)
		valid = vm_and(valid, clip_lanes(cast, origin, direction, &from, &to));
	vf_store(ray->tnear + first, from);
	vf_store(ray->tfar + first, to);
	vf_store(ray->time + first, vf_set(0));
	vi_store(ray->mask + first, vi_set(-1));
	vi_store(ray->flags + first, vi_set(0));
	struct RTCHit16 *hit = &packet->hit.hit;
	vi_store(hit->geomID + first, vi_set(-1)); /* RTC_INVALID_GEOMETRY_ID */
	vi_store(hit->instID[0] + first, vi_set(-1));
	store_mask(valid, packet->valid + first);
}

/* The origins and directions of SIMD_LANES rays. */
struct ways {
	vf origin[3], direction[3];
};

SIMD struct ways load_ways(const struct RTCRay16 *ray, int first)
{
	return (struct ways) {
		{ vf_load(ray->org_x + first), vf_load(ray->org_y + first),
		  vf_load(ray->org_z + first) },
		{ vf_load(ray->dir_x + first), vf_load(ray->dir_y + first),
		  vf_load(ray->dir_z + first) },
	};
}

/* Some of SIMD_LANES lanes, from ray `first` on. */
struct lanes {
	int first;
	vm mask;
};

/* Where rays meet a mesh. */
struct meeting {
	vi triangle;             /* three times its number */
	vf corner_normals[3][3]; /* [corner][axis] */
	vf shares[3];            /* of the corners */
	vf normal[3];            /* of length 1 */
	vf place[3];
};

/* Read the corners of triangles. */
SIMD void load_corners(const struct gz_surface_mesh *mesh, vi triangle, vm mask, vf out[3][3])
{
	for (int corner = 0; corner < 3; corner++) {
		const vi number = vi_gather(mesh->triangles + corner, triangle, 4, mask);
		const vi vertex = vi_mul(number, vi_set(3));
		for (int axis = 0; axis < 3; axis++)
			out[corner][axis] = vf_gather(mesh->positions + axis, vertex, mask);
	}
}

/* Unpack normals: the inverse of gz_normal_pack(). */
SIMD void unpack_normals(vi word, vf out[3])
{
	const vf unit = vf_set(1.0F / GZ_NORMAL_UNIT);
	const vf none = vf_set(0);
	const vf low = vf_from_i(vi_and(word, vi_set(0xffff)));
	const vf high = vf_from_i(vi_and(word, vi_set(-0x10000)));
	const vf x = (low - vf_set(GZ_NORMAL_OFFSET)) * unit;
	const vf y = high * (vf_set(1.0F / 0x10000) * unit);
	out[2] = vf_set(1) - vf_abs(x) - vf_abs(y);
	const vf fold = vf_max(none - out[2], none); /* 0 on the upper half */
	out[0] = x + vf_select(vf_less(x, none), fold, none - fold);
	out[1] = y + vf_select(vf_less(y, none), fold, none - fold);
	const vf inverse = vf_set(1) / vf_sqrt(dot_lanes(out, out));
	for (int axis = 0; axis < 3; axis++)
		out[axis] = out[axis] * inverse;
}

/* Read the triangles that the lanes of the mask have met, all of one mesh; not the places. */
SIMD struct meeting read_triangles(const struct gz_surface_mesh *mesh, const struct packet *packet,
				   struct lanes lanes)
{
	const vf u = vf_load(packet->hit.hit.u + lanes.first);
	const vf v = vf_load(packet->hit.hit.v + lanes.first);
	struct meeting at = {
		.triangle = vi_mul(vi_load(packet->hit.hit.primID + lanes.first), vi_set(3)),
		.shares = { vf_set(1) - u - v, u, v },
	};
	for (int corner = 0; corner < 3; corner++)
		unpack_normals(
			vi_gather(&mesh->normals->corner[corner], at.triangle, 4, lanes.mask),
			at.corner_normals[corner]);
	for (int axis = 0; axis < 3; axis++)
		at.normal[axis] = vf_fma(v, at.corner_normals[2][axis],
					 vf_fma(u, at.corner_normals[1][axis],
						at.shares[0] * at.corner_normals[0][axis]));
	const vf length2 = dot_lanes(at.normal, at.normal);
	const vf inverse = vf_set(1) / vf_sqrt(vf_max(length2, vf_set(1e-30F)));
	for (int axis = 0; axis < 3; axis++)
		at.normal[axis] = at.normal[axis] * inverse;
	return at;
}

#endif
