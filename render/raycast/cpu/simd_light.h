/*
 * Light on a point of a surface, for each lane: struct gz_light has the formulas. Include it after
 * the vocabulary of an instruction set: cast_kernel.h explains the scheme.
 */
#ifndef GZ_RENDER_RAYCAST_CPU_SIMD_LIGHT_H
#define GZ_RENDER_RAYCAST_CPU_SIMD_LIGHT_H

#include "render/light/light_constants.h"
#include "render/raycast/shared/lighting.h"

/* Unit vectors towards the eye, and halfway between eye and light: the same for all samples of a
 * ray. */
struct view {
	vf eye[3], half[3];
};

/* 2^x for x <= 0, to 2e-7: the fraction in [-1/2, 1/2] by a polynomial (Taylor of exp(f ln 2),
 * degree 6), the whole part into the exponent. */
SIMD vf exp2_negative(vf x)
{
	x = vf_max(x, vf_set(-126));
	const vf whole = vf_floor(x + vf_set(0.5F));
	const vf f = (x - whole) * vf_set(0.693147180559945F);
	vf p = vf_set(1.0F / 720);
	p = vf_fma(p, f, vf_set(1.0F / 120));
	p = vf_fma(p, f, vf_set(1.0F / 24));
	p = vf_fma(p, f, vf_set(1.0F / 6));
	p = vf_fma(p, f, vf_set(0.5F));
	p = vf_fma(p, f, vf_set(1));
	p = vf_fma(p, f, vf_set(1));
	/* whole + 127 is 1 to 127, so the sign bit stays 0 */
	return p * vf_bits(vi_shift_left(vi_trunc(whole + vf_set(127)), 23));
}

/* log2 of x > 0, to 2e-7: x = 2^whole * m with m around 1, and log m = 2 artanh((m - 1) / (m + 1))
 * by its series, to the 9th power. */
SIMD vf log2_positive(vf x)
{
	const int32_t root_half = 0x3F3504F3; /* bits of sqrt(1/2), the least m */
	const vi bits = vi_add(vi_bits(x), vi_set(0x3F800000 - root_half));
	const vf whole = vf_from_i(vi_add(vi_shift_right(bits, 23), vi_set(-127)));
	const vf m = vf_bits(vi_add(vi_and(bits, vi_set(0x7FFFFF)), vi_set(root_half)));
	const vf z = (m - vf_set(1)) * vf_inverse(m + vf_set(1));
	const vf z2 = z * z;
	vf p = vf_set(1.0F / 9);
	p = vf_fma(p, z2, vf_set(1.0F / 7));
	p = vf_fma(p, z2, vf_set(1.0F / 5));
	p = vf_fma(p, z2, vf_set(1.0F / 3));
	p = vf_fma(p, z2, vf_set(1));
	return vf_fma(p * z, vf_set(2.88539008177793F), whole); /* 2 / ln 2 */
}

/* The scalar product of unit vectors, or of 0. */
SIMD vf dot_lanes(const vf a[3], const vf b[3])
{
	return vf_fma(a[2], b[2], vf_fma(a[1], b[1], a[0] * b[0]));
}

SIMD vf clamp_lanes(vf x, vf least, vf greatest)
{
	return vf_min(vf_max(x, least), greatest);
}

SIMD vi to_byte(vf x)
{
	return vi_trunc(vf_fma(vf_min(vf_max(x, vf_set(0)), vf_set(1)), vf_set(255), vf_set(0.5F)));
}

/* The factor of a colour, and the white to add to it. */
struct shine {
	vf factor, white;
};

/* x^exponent, for an exponent from 1 up. */
SIMD vf whole_power(vf x, int exponent)
{
	for (; !(exponent & 1); exponent >>= 1)
		x = x * x;
	vf power = x;
	while (exponent >>= 1) {
		x = x * x;
		if (exponent & 1)
			power = power * x;
	}
	return power;
}

/* |N.H|^shininess. Most scenes have a whole number, which takes a third of the time. */
SIMD vf find_gloss(const struct gz_cast_light *light, vf cosine)
{
	const vf clamped = clamp_lanes(vf_abs(cosine), vf_set(light->least_cosine), vf_set(1));
	if (light->whole_shininess)
		return whole_power(clamped, light->whole_shininess);
	return exp2_negative(vf_set(light->shininess) * log2_positive(clamped));
}

SIMD struct shine find_shine(const struct gz_cast_light *light, const struct view *view,
			     const vf normal[3], vf occlusion)
{
	const vf facing = vf_set(1 / GZ_LIGHT_FACING);
	const vf towards[3] = { vf_set(light->towards[0]), vf_set(light->towards[1]),
				vf_set(light->towards[2]) };
	const vf side = clamp_lanes(dot_lanes(normal, view->eye) * facing, vf_set(-1), vf_set(1));
	const vf diffuse = vf_max(side * dot_lanes(normal, towards), vf_set(0));
	const vf gloss = find_gloss(light, dot_lanes(normal, view->half)) *
			 vf_min(diffuse * facing, vf_set(1));
	const vf ambient = vf_set(light->ambient) * (vf_set(1) - occlusion);
	return (struct shine) { vf_fma(diffuse, vf_set(light->diffuse), ambient),
				gloss * vf_set(light->specular) };
}

#endif
