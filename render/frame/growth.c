#include "render/frame/growth.h"

#include <math.h>

/* The first picture of a view is not kept, the second is, and the third may be finer. A backend
 * that does not keep the second keeps none. */
enum { PICTURES_UNTIL_KEPT = 2 };

/* The most by which a rise is a multiple of the one before, or the other way round. Chosen: it
 * doubles once rays fill the picture, and a jump of the gaze does not upset it. */
static const double rise_change = 2;

/* The first rise where the method has rounds. The finer plan has one round, with all the rays that
 * the method could need, which is enough for one picture. */
static const double rise_to_one_round = 1e-6;

static bool same_view(const struct gz_growth_view *a, const struct gz_growth_view *b)
{
	return a->serial == b->serial && a->width == b->width && a->height == b->height &&
	       gz_camera_same(&a->camera, &b->camera) && gz_display_same(&a->display, &b->display);
}

static void start_with(struct gz_growth *growth, const struct gz_growth_view *view)
{
	*growth = (struct gz_growth) { .view = *view, .finer_squared = 1 };
}

double gz_growth_begin(struct gz_growth *growth, const struct gz_growth_view *view)
{
	if (!same_view(&growth->view, view))
		start_with(growth, view);
	return growth->whole ? GZ_PLAN_FINER_MAX
			     : fmin(sqrt(growth->finer_squared), GZ_PLAN_FINER_MAX);
}

/* Let each picture add as many rays, though ever fewer pixels lack one. */
static double next_rise(const struct gz_growth *growth, const struct gz_growth_picture *picture)
{
	if (growth->finer_squared <= 1)
		return picture->refines ? rise_to_one_round : picture->share;
	if (growth->finer_squared <= 1 + rise_to_one_round)
		return picture->share;
	const double wanted =
		fmax(picture->share * (double)growth->method_rays, GZ_TILE_EDGE * GZ_TILE_EDGE);
	const double added = fmax((double)picture->plan->ray_count - (double)growth->last_rays, 1);
	return growth->rise * fmin(fmax(wanted / added, 1 / rise_change), rise_change);
}

void gz_growth_end(struct gz_growth *growth, const struct gz_growth_picture *picture)
{
	/* Something has changed that the caller did not tell. */
	if (growth->keeps && !picture->keeps) {
		const struct gz_growth_view view = growth->view;
		start_with(growth, &view);
	}
	growth->pictures++;
	growth->keeps = picture->keeps;
	if (growth->finer_squared <= 1 + rise_to_one_round)
		growth->method_rays = picture->plan->ray_count;
	if (picture->keeps && growth->pictures >= PICTURES_UNTIL_KEPT) {
		growth->whole = growth->whole || gz_plan_is_whole(picture->plan);
		growth->rise = next_rise(growth, picture);
		growth->finer_squared += growth->rise;
	}
	growth->last_rays = picture->plan->ray_count;
}

bool gz_growth_settling(const struct gz_growth *growth)
{
	return growth->pictures > 0 && !growth->whole &&
	       (growth->keeps || growth->pictures < PICTURES_UNTIL_KEPT);
}
