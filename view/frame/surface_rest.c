#include "view/frame/isovalue_rest.h"

bool gz_isovalue_rest_step(struct gz_isovalue_rest *rest, double isovalue, bool held,
			   int64_t now_ns)
{
	if (rest->known && isovalue != rest->value) {
		rest->moves = true;
		rest->changed_ns = now_ns;
	}
	rest->known = true;
	rest->value = isovalue;
	if (rest->moves && !held && gz_isovalue_rest_left_ns(rest, now_ns) == 0)
		rest->moves = false;
	return rest->moves;
}

int64_t gz_isovalue_rest_left_ns(const struct gz_isovalue_rest *rest, int64_t now_ns)
{
	const int64_t spent_ns = now_ns - rest->changed_ns;
	return spent_ns < GZ_ISOVALUE_REST_NS ? GZ_ISOVALUE_REST_NS - spent_ns : 0;
}
