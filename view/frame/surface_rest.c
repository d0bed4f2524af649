#include "view/frame/surface_rest.h"

static bool is_same_surface(const struct gz_surface_state *a, const struct gz_surface_state *b)
{
	return a->isovalue == b->isovalue && a->time_point == b->time_point;
}

bool gz_surface_rest_step(struct gz_surface_rest *rest, const struct gz_surface_state *state,
			  bool held, int64_t now_ns)
{
	if (rest->known && !is_same_surface(state, &rest->state)) {
		rest->moves = true;
		rest->changed_ns = now_ns;
	}
	rest->known = true;
	rest->state = *state;
	if (rest->moves && !held && gz_surface_rest_left_ns(rest, now_ns) == 0)
		rest->moves = false;
	return rest->moves;
}

int64_t gz_surface_rest_left_ns(const struct gz_surface_rest *rest, int64_t now_ns)
{
	const int64_t spent_ns = now_ns - rest->changed_ns;
	return spent_ns < GZ_SURFACE_REST_NS ? GZ_SURFACE_REST_NS - spent_ns : 0;
}
