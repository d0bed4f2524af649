#include "daemon/rate_meter.h"

#include "base/clock.h"

/* Shorter stretches are not measured: a status sent on a change would say anything. */
static const double SHORTEST_S = 0.2;

void gz_rate_meter_step(struct gz_rate_meter *meter, int64_t host_ns)
{
	if (meter->count == 0 || host_ns < meter->last_ns) {
		meter->count = 0;
		meter->first_ns = host_ns;
	}
	meter->last_ns = host_ns;
	meter->count++;
}

double gz_rate_meter_take(struct gz_rate_meter *meter)
{
	double span_s = gz_ns_to_s(meter->last_ns) - gz_ns_to_s(meter->first_ns);
	if (meter->count == 0)
		meter->rate_hz = 0;
	if (meter->count < 2 || span_s < SHORTEST_S)
		return meter->rate_hz;
	meter->rate_hz = (double)(meter->count - 1) / span_s;
	/* The newest sample is the first of the next stretch. */
	meter->first_ns = meter->last_ns;
	meter->count = 1;
	return meter->rate_hz;
}
