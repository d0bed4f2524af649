/*
 * Colour gathered front to back, and the pixel it becomes.
 * A part of the kernel: see cast_kernel.h.
 */
#ifndef GZ_RENDER_RAYCAST_CPU_CAST_LIGHT_H
#define GZ_RENDER_RAYCAST_CPU_CAST_LIGHT_H

#include "render/raycast/cpu/cast.h"

/* What has been gathered so far. */
struct light {
	vf red, green, blue, through;
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
	/* whole + 127 is from 1 to 127: no sign to mind */
	return p * vf_bits(vi_shift_left(vi_trunc(whole + vf_set(127)), 23));
}

/* A sample's colour: red and green up to 2047, blue up to 1023. */
struct colour {
	vf red, green, blue;
};

SIMD struct colour unpack_colour(vi packed)
{
	return (struct colour) {
		vf_from_i(vi_shift_right(packed, 21)),
		vf_from_i(vi_and(vi_shift_right(packed, 10), vi_set(2047))),
		vf_from_i(vi_and(packed, vi_set(1023))),
	};
}

SIMD void composite_colour(struct colour colour, vf opacity, vm visible, struct light *light)
{
	const vf weight = light->through * vf_select(visible, opacity, vf_set(0));
	light->red = vf_fma(weight, colour.red, light->red);
	light->green = vf_fma(weight, colour.green, light->green);
	light->blue = vf_fma(weight, colour.blue, light->blue);
	light->through = light->through - weight;
}

/* Add a sample's colour where it has opacity. */
SIMD void composite(vi colour, vf opacity, vm visible, struct light *light)
{
	composite_colour(unpack_colour(colour), opacity, visible, light);
}

SIMD vi to_byte(vf x)
{
	return vi_trunc(vf_fma(vf_min(vf_max(x, vf_set(0)), vf_set(1)), vf_set(255), vf_set(0.5F)));
}

SIMD vi to_pixel(const struct gz_cast *cast, const struct light *light)
{
	const vf *t = &light->through;
	const vi red =
		to_byte(vf_fma(*t, vf_set(cast->background[0]), light->red * vf_set(1.0F / 2047)));
	const vi green = to_byte(
		vf_fma(*t, vf_set(cast->background[1]), light->green * vf_set(1.0F / 2047)));
	const vi blue =
		to_byte(vf_fma(*t, vf_set(cast->background[2]), light->blue * vf_set(1.0F / 1023)));
	const vi opaque = vi_set((int32_t)0xFF000000);
	return vi_or(vi_or(red, vi_shift_left(green, 8)), vi_or(vi_shift_left(blue, 16), opaque));
}

#endif
