#include "filter/correct.h"

#include <math.h>

bool gz_correct_usable(const struct gz_correct_params *params)
{
	for (int i = 0; i < 3; i++)
		if (!isfinite(params->x[i]) || !isfinite(params->y[i]))
			return false;
	double area = params->x[1] * params->y[2] - params->x[2] * params->y[1];
	return isfinite(area) && fabs(area) >= GZ_CORRECT_LEAST_AREA;
}

struct gz_point gz_correct_point(const struct gz_correct_params *params, struct gz_point point)
{
	if (!isfinite(point.x) || !isfinite(point.y))
		return point;
	const double *x = params->x, *y = params->y;
	return (struct gz_point) { (float)(x[0] + x[1] * point.x + x[2] * point.y),
				   (float)(y[0] + y[1] * point.x + y[2] * point.y) };
}

void gz_correct_step(const struct gz_correct_params *params, struct gz_sample *sample)
{
	sample->point = gz_correct_point(params, sample->point);
	for (int i = 0; i < GZ_EYE_COUNT; i++)
		sample->eye[i].point = gz_correct_point(params, sample->eye[i].point);
}
