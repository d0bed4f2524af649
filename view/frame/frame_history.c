#include "view/frame/frame_history.h"

#include <math.h>
#include <stdlib.h>

void gz_frame_history_add(struct gz_frame_history *history, const struct gz_frame_cost *cost)
{
	struct gz_frame_cost *kept = &history->costs[history->next];
	*kept = *cost;
	for (int part = 0; part < GZ_FRAME_PARTS; part++)
		kept->ms[part] = fmax(0, cost->ms[part]); /* 0 also of what is no number */
	history->next = (history->next + 1) % GZ_FRAME_HISTORY_SIZE;
	if (history->count < GZ_FRAME_HISTORY_SIZE)
		history->count++;
}

const struct gz_frame_cost *gz_frame_history_at(const struct gz_frame_history *history, size_t back)
{
	if (back >= history->count)
		return NULL;
	return &history->costs[(history->next + GZ_FRAME_HISTORY_SIZE - 1 - back) %
			       GZ_FRAME_HISTORY_SIZE];
}

double gz_frame_cost_total_ms(const struct gz_frame_cost *cost)
{
	double total = 0;
	for (int part = 0; part < GZ_FRAME_PARTS; part++)
		total += cost->ms[part];
	return total;
}

static int compare(const void *a, const void *b)
{
	const double one = *(const double *)a, other = *(const double *)b;
	return (one > other) - (one < other);
}

double gz_frame_history_quantile_ms(const struct gz_frame_history *history, enum gz_frame_part part,
				    double share)
{
	double values[GZ_FRAME_HISTORY_SIZE];
	if (history->count == 0)
		return 0;
	for (size_t i = 0; i < history->count; i++) {
		const struct gz_frame_cost *cost = gz_frame_history_at(history, i);
		values[i] = part == GZ_FRAME_PARTS ? gz_frame_cost_total_ms(cost) : cost->ms[part];
	}
	qsort(values, history->count, sizeof values[0], compare);
	const double rank = ceil(share * (double)history->count);
	return values[rank < 1 ? 0 : (size_t)rank - 1];
}
