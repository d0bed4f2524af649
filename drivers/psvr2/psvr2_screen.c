#include "drivers/psvr2/psvr2_screen.h"

#include <math.h>
#include <string.h>

/* cos 85 degrees. */
static const double COS_GRAZING = 0.08715574274765817;

/* Chosen: a point a million screens away is no measurement. */
static const double FARTHEST = 1e6;

static double dot(const double a[3], const double b[3])
{
	return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* Turn @p from towards @p to by an angle, and @p to along: a rotation of the frame about its third
 * axis. */
static void turn(double from[3], double to[3], double angle_deg)
{
	double angle = angle_deg * (M_PI / 180);
	for (int i = 0; i < 3; i++) {
		double a = from[i], b = to[i];
		from[i] = cos(angle) * a + sin(angle) * b;
		to[i] = cos(angle) * b - sin(angle) * a;
	}
}

struct gz_psvr2_screen gz_psvr2_screen_make(const struct gz_psvr2_screen_params *params)
{
	struct gz_psvr2_screen screen = {
		.centre_mm = { params->offset_mm[0], params->offset_mm[1], params->distance_mm },
		.right = { 1, 0, 0 },
		.down = { 0, 1, 0 },
		.ahead = { 0, 0, 1 },
	};
	memcpy(screen.size_mm, params->size_mm, sizeof screen.size_mm);
	/* Nearer is against ahead. */
	turn(screen.right, screen.ahead, -params->turn_deg[0]);
	turn(screen.down, screen.ahead, -params->turn_deg[1]);
	turn(screen.right, screen.down, params->turn_deg[2]);
	return screen;
}

bool gz_psvr2_screen_meet(const struct gz_psvr2_screen *screen, const struct gz_psvr2_ray *ray,
			  struct gz_point *out_point)
{
	double direction[3], to_centre[3], place[3];
	if (!ray->has_origin || !ray->has_direction)
		return false;
	for (int i = 0; i < 3; i++) {
		direction[i] = (double)ray->direction[i];
		to_centre[i] = screen->centre_mm[i] - (double)ray->origin_mm[i];
	}
	double slope = dot(direction, screen->ahead);
	double distance_mm = dot(to_centre, screen->ahead);
	if (slope < COS_GRAZING || distance_mm <= 0)
		return false;
	for (int i = 0; i < 3; i++)
		place[i] = direction[i] * (distance_mm / slope) - to_centre[i];
	double x = dot(place, screen->right) / screen->size_mm[0] + 0.5;
	double y = dot(place, screen->down) / screen->size_mm[1] + 0.5;
	if (fabs(x) > FARTHEST || fabs(y) > FARTHEST)
		return false;
	*out_point = (struct gz_point) { (float)x, (float)y };
	return true;
}
