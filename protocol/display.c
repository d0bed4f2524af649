#include "protocol/display.h"

#include <math.h>

#define DEG_PER_RAD 57.295779513082320877

struct gz_display gz_display_default(int width_px, int height_px)
{
	/* The angle between the left and the right edge is 50.4 degrees: see the header. */
	static const double distance_mm = 600.0;
	static const double half_width_deg = 50.4 / 2;
	double width_mm = 2 * distance_mm * tan(half_width_deg / DEG_PER_RAD);
	return (struct gz_display) {
		.px = { width_px, height_px },
		.mm = { width_mm, width_mm * height_px / width_px },
		.distance_mm = distance_mm,
	};
}

static bool is_length(double mm)
{
	return isfinite(mm) && mm > 0;
}

static bool is_side(int px)
{
	return px >= 1 && px <= GZ_DISPLAY_SIDE_MAX_PX;
}

bool gz_display_valid(const struct gz_display *display)
{
	return is_side(display->px[0]) && is_side(display->px[1]) && is_length(display->mm[0]) &&
	       is_length(display->mm[1]) && is_length(display->distance_mm);
}

bool gz_display_same(const struct gz_display *a, const struct gz_display *b)
{
	return a->px[0] == b->px[0] && a->px[1] == b->px[1] && a->mm[0] == b->mm[0] &&
	       a->mm[1] == b->mm[1] && a->distance_mm == b->distance_mm;
}

void gz_display_to_mm(const struct gz_display *display, struct gz_point point, double out_mm[3])
{
	out_mm[0] = ((double)point.x - 0.5) * display->mm[0];
	out_mm[1] = ((double)point.y - 0.5) * display->mm[1];
	out_mm[2] = display->distance_mm;
}

double gz_display_angle_deg(const struct gz_display *display, struct gz_point a, struct gz_point b)
{
	double u[3], v[3];
	gz_display_to_mm(display, a, u);
	gz_display_to_mm(display, b, v);
	double cross[3] = {
		u[1] * v[2] - u[2] * v[1],
		u[2] * v[0] - u[0] * v[2],
		u[0] * v[1] - u[1] * v[0],
	};
	double sine = sqrt(cross[0] * cross[0] + cross[1] * cross[1] + cross[2] * cross[2]);
	double cosine = u[0] * v[0] + u[1] * v[1] + u[2] * v[2];
	/* acos of the cosine alone would lose angles below a thousandth of a degree. */
	return atan2(sine, cosine) * DEG_PER_RAD;
}

double gz_display_px_per_deg(const struct gz_display *display)
{
	double px_per_mm = display->px[0] / display->mm[0];
	return px_per_mm * display->distance_mm / DEG_PER_RAD;
}
