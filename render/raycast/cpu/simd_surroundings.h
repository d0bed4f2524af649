/*
 * What rays see of the surroundings, for each lane: render/light/environment.h and
 * render/light/cube.h have the formulas. Include it after the vocabulary of an instruction set, as
 * simd_light.h.
 */
#ifndef GZ_RENDER_RAYCAST_CPU_SIMD_SURROUNDINGS_H
#define GZ_RENDER_RAYCAST_CPU_SIMD_SURROUNDINGS_H

#include "render/light/surroundings.h"
#include "render/raycast/cpu/simd_light.h"

struct rgb {
	vf channel[3];
};

SIMD vi pack_rgb(const struct rgb *rgb)
{
	const vi red = to_byte(rgb->channel[0]), green = to_byte(rgb->channel[1]);
	const vi blue = to_byte(rgb->channel[2]), opaque = vi_set((int32_t)0xFF000000);
	return vi_or(vi_or(red, vi_shift_left(green, 8)), vi_or(vi_shift_left(blue, 16), opaque));
}

/* The floor, or the sky where the floor is not met. */
SIMD struct rgb floor_or_sky(const struct gz_seen_surroundings *around, const vf origin[3],
			     const vf direction[3], vf rise, struct rgb sky)
{
	vf height = vf_set(-around->floor_height), tiles = vf_set(0);
	for (int axis = 0; axis < 3; axis++)
		height = vf_fma(origin[axis], vf_set(around->axes[0][axis]), height);
	const vm meets = vm_and(vf_less(vf_set(0), height), vf_less(rise, vf_set(-GZ_FLOOR_FALL)));
	const vf distance = height / vf_max(vf_set(0) - rise, vf_set(GZ_FLOOR_FALL));
	for (int side = 1; side < 3; side++) {
		vf place = vf_set(0);
		for (int axis = 0; axis < 3; axis++)
			place = vf_fma(vf_fma(distance, direction[axis], origin[axis]),
				       vf_set(around->axes[side][axis]), place);
		tiles = tiles + vf_floor(place * vf_set(around->tiles_per_length));
	}
	const vf half = tiles * vf_set(0.5F);
	const vm odd = vf_less(vf_set(0.25F), half - vf_floor(half));
	const vf share = exp2_negative(distance * vf_set(-around->fade_per_length));
	for (int i = 0; i < 3; i++) {
		const vf horizon = vf_set(around->horizon[i]);
		const vf tile = vf_select(odd, vf_set(around->dark[i]), vf_set(around->bright[i]));
		const vf floor = vf_fma(share, tile - horizon, horizon);
		sky.channel[i] = vf_select(meets, floor, sky.channel[i]);
	}
	return sky;
}

/* What rays from here see of the sky and its floor. */
SIMD struct rgb see_sky(const struct gz_seen_surroundings *around, const vf origin[3],
			const vf direction[3])
{
	struct rgb seen;
	vf rise = vf_set(0), cosine = vf_set(0);
	for (int axis = 0; axis < 3; axis++) {
		rise = vf_fma(direction[axis], vf_set(around->axes[0][axis]), rise);
		cosine = vf_fma(direction[axis], vf_set(around->sun[axis]), cosine);
	}
	const vf up = vf_min(vf_max(rise, vf_set(0)), vf_set(1));
	const vf blue = up * (vf_set(2) - up);
	const vf sun =
		clamp_lanes((cosine - vf_set(GZ_SUN_RIM)) * vf_set(1 / (GZ_SUN_DISC - GZ_SUN_RIM)),
			    vf_set(0), vf_set(1));
	for (int i = 0; i < 3; i++) {
		const vf horizon = vf_set(around->horizon[i]);
		const vf sky = vf_fma(blue, vf_set(around->zenith[i]) - horizon, horizon);
		seen.channel[i] = vf_fma(sun * sun, vf_set(1) - sky, sky);
	}
	return around->floor ? floor_or_sky(around, origin, direction, rise, seen) : seen;
}

/* A texel of a cube, by its number, channels 0 to 255. */
SIMD struct rgb load_texel(const struct gz_seen_surroundings *around, vi index)
{
	const vi texel = vi_gather(around->texels, index, 4, vm_all()), byte = vi_set(0xFF);
	return (struct rgb) { { vf_from_i(vi_and(texel, byte)),
				vf_from_i(vi_and(vi_shift_right(texel, 8), byte)),
				vf_from_i(vi_and(vi_shift_right(texel, 16), byte)) } };
}

SIMD vf lerp_lanes(vf a, vf b, vf share)
{
	return vf_fma(share, b - a, a);
}

/* Where a face's lanes look at it: the face's number, and s and t of render/light/cube.h. */
struct on_cube {
	vi face;
	vf s, t;
};

SIMD struct on_cube meet_cube(const struct gz_seen_surroundings *around, const vf direction[3])
{
	vf along[3], size[3];
	for (int i = 0; i < 3; i++) {
		along[i] = vf_set(0);
		for (int axis = 0; axis < 3; axis++)
			along[i] = vf_fma(direction[axis], vf_set(around->axes[i][axis]), along[i]);
		size[i] = vf_abs(along[i]);
	}
	const vf none = vf_set(0), r = along[0], f = along[1], u = along[2];
	const vm front = vm_and(vf_less(size[0], size[1]), vf_less(size[2], size[1]));
	const vm above = vm_but(vf_less(size[0], size[2]), front);
	const vf most = vf_select(above, u, vf_select(front, f, r));
	const vm behind = vf_less(most, none);
	const vf least = vf_set(1e-6F); /* a unit vector has more */
	const vf scale = vf_set(1) / vf_max(vf_abs(most), least);
	const vf ahead_s = vf_select(above, r, vf_select(front, r, none - f));
	const vf behind_s = vf_select(above, r, vf_select(front, none - r, f));
	const vf up_t = vf_select(behind, none - f, f);
	const vi pair = vi_select(above, vi_set(GZ_CUBE_UP),
				  vi_select(front, vi_set(GZ_CUBE_FRONT), vi_set(GZ_CUBE_RIGHT)));
	return (struct on_cube) {
		vi_add(pair, vi_select(behind, vi_set(1), vi_set(0))),
		scale * vf_select(behind, behind_s, ahead_s),
		scale * vf_select(above, up_t, none - u),
	};
}

/* What rays see of six pictures: bilinear between the four texels around, which are all there
 * because a face has a rim. */
SIMD struct rgb see_cube(const struct gz_seen_surroundings *around, const vf direction[3])
{
	const struct on_cube on = meet_cube(around, direction);
	const vf half_edge = vf_set(0.5F * (float)around->edge),
		 greatest = vf_set((float)around->edge);
	const int row = around->edge + 2;
	/* from the middle of the rim's first texel */
	const vf x = clamp_lanes(vf_fma(on.s, half_edge, half_edge) + vf_set(0.5F), vf_set(0.5F),
				 greatest + vf_set(0.5F));
	const vf y = clamp_lanes(vf_fma(on.t, half_edge, half_edge) + vf_set(0.5F), vf_set(0.5F),
				 greatest + vf_set(0.5F));
	const vi column = vi_trunc(x), line = vi_trunc(y);
	const vf across = x - vf_from_i(column), down = y - vf_from_i(line);
	const vi first = vi_add(
		vi_add(vi_mul(on.face, vi_set(row * row)), vi_mul(line, vi_set(row))), column);
	const vi below = vi_add(first, vi_set(row)), one = vi_set(1);
	const struct rgb texels[4] = {
		load_texel(around, first),
		load_texel(around, vi_add(first, one)),
		load_texel(around, below),
		load_texel(around, vi_add(below, one)),
	};
	struct rgb seen;
	for (int i = 0; i < 3; i++)
		seen.channel[i] =
			vf_set(1.0F / 255) *
			lerp_lanes(lerp_lanes(texels[0].channel[i], texels[1].channel[i], across),
				   lerp_lanes(texels[2].channel[i], texels[3].channel[i], across),
				   down);
	return seen;
}

/* What rays from here see of the surroundings. */
SIMD struct rgb see_surroundings(const struct gz_seen_surroundings *around, const vf origin[3],
				 const vf direction[3])
{
	struct rgb seen;
	if (around->kind == GZ_SURROUNDINGS_SKY)
		return see_sky(around, origin, direction);
	if (around->kind == GZ_SURROUNDINGS_CUBE)
		return see_cube(around, direction);
	for (int i = 0; i < 3; i++)
		seen.channel[i] = vf_set(around->horizon[i]);
	return seen;
}

/* What a surface mirrors, and with which share: struct gz_light has the formula. */
struct mirrored {
	struct rgb seen;
	vf share;
};

SIMD struct mirrored find_mirrored(const struct gz_seen_surroundings *around, float reflection,
				   const vf place[3], const vf normal[3], const vf to_eye[3])
{
	const vf along = dot_lanes(normal, to_eye), one = vf_set(1);
	const vf outside = one - vf_min(vf_abs(along), one), power2 = outside * outside;
	vf direction[3];
	for (int axis = 0; axis < 3; axis++)
		direction[axis] = vf_fma(along + along, normal[axis], vf_set(0) - to_eye[axis]);
	return (struct mirrored) {
		see_surroundings(around, place, direction),
		vf_fma(vf_set(1 - reflection) * power2 * power2, outside, vf_set(reflection)),
	};
}

#endif
