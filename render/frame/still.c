#include "render/frame/still.h"

#include <math.h>

/* The first picture of a view keeps nothing, and the second stores. If the third takes nothing of
 * it, none will. */
enum { PICTURES_UNTIL_KEPT = 3 };

/* The most by which a picture's raise is a multiple of the one before, or the other way round.
 * Chosen: it doubles once rays fill the picture, and a jump of the gaze does not upset it. */
static const double raise_change = 2;

static bool same_view(const struct gz_still_view *a, const struct gz_still_view *b)
{
	return a->serial == b->serial && a->width == b->width && a->height == b->height &&
	       gz_camera_same(&a->camera, &b->camera);
}

static void start_again(struct gz_still *still, double growth)
{
	*still = (struct gz_still) { .view = still->view, .finer2 = 1, .raise = growth };
}

double gz_still_begin(struct gz_still *still, const struct gz_still_view *view, double growth)
{
	if (!same_view(&still->view, view)) {
		still->view = *view;
		start_again(still, growth);
	}
	still->pictures++;
	if (still->keeps)
		still->finer2 += still->raise;
	return still->whole ? GZ_PLAN_FINER_MAX : fmin(sqrt(still->finer2), GZ_PLAN_FINER_MAX);
}

/* Let each picture add as many rays, though ever fewer pixels lack one. */
static void adapt_raise(struct gz_still *still, uint64_t rays, double growth)
{
	const double wanted = growth * (double)still->method_rays;
	const double added = fmax((double)rays - (double)still->last_rays, 1);
	still->raise *= fmin(fmax(wanted / added, 1 / raise_change), raise_change);
}

void gz_still_end(struct gz_still *still, const struct gz_plan *plan, bool keeps, double growth)
{
	/* Something has changed that the caller did not tell. */
	if (still->keeps && !keeps)
		start_again(still, growth);
	if (still->finer2 > 1)
		adapt_raise(still, plan->ray_count, growth);
	else
		still->method_rays = plan->ray_count;
	still->last_rays = plan->ray_count;
	still->keeps = keeps;
	still->whole = still->whole || (keeps && gz_plan_is_whole(plan));
}

bool gz_still_settling(const struct gz_still *still)
{
	return still->pictures > 0 && !still->whole &&
	       (still->keeps || still->pictures < PICTURES_UNTIL_KEPT);
}
