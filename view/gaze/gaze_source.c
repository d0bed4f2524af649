#include "view/gaze/gaze_source.h"

#include <math.h>
#include <stdlib.h>

/* A point somebody else sets: once for "fixed", by every motion for "mouse". */
struct point_source {
	struct gz_gaze_source base;
	bool known;
	struct gz_point point;
};

static void point_read(struct gz_gaze_source *source, int64_t time_ns,
		       struct gz_gaze_reading *out_reading)
{
	(void)time_ns;
	const struct point_source *self = (const struct point_source *)source;
	*out_reading = (struct gz_gaze_reading) {
		.known = self->known,
		.point = self->point,
		.connected = true,
		.noise_deg = NAN,
	};
}

static void point_destroy(struct gz_gaze_source *source)
{
	free(source);
}

static const struct gz_gaze_source_ops fixed_ops = {
	.name = "fixed",
	.live = false,
	.read = point_read,
	.destroy = point_destroy,
};

static const struct gz_gaze_source_ops mouse_ops = {
	.name = "mouse",
	.live = true,
	.read = point_read,
	.destroy = point_destroy,
};

static enum gz_result point_create(const struct gz_gaze_source_ops *ops, bool known,
				   struct gz_point point, struct gz_gaze_source **out_source)
{
	struct point_source *self = calloc(1, sizeof *self);
	if (!self)
		return GZ_ERR_NO_MEM;
	self->base.ops = ops;
	self->known = known;
	self->point = point;
	*out_source = &self->base;
	return GZ_OK;
}

enum gz_result gz_gaze_source_fixed(struct gz_point point, struct gz_gaze_source **out_source)
{
	return point_create(&fixed_ops, true, point, out_source);
}

enum gz_result gz_gaze_source_mouse(struct gz_gaze_source **out_source)
{
	return point_create(&mouse_ops, false, (struct gz_point) { 0.5f, 0.5f }, out_source);
}

void gz_gaze_source_move(struct gz_gaze_source *source, struct gz_point point)
{
	if (source->ops != &mouse_ops)
		return;
	struct point_source *self = (struct point_source *)source;
	self->known = true;
	self->point = point;
}

void gz_gaze_source_read(struct gz_gaze_source *source, int64_t time_ns,
			 struct gz_gaze_reading *out_reading)
{
	source->ops->read(source, time_ns, out_reading);
}

bool gz_gaze_source_display(struct gz_gaze_source *source, struct gz_display *out_display)
{
	return source->ops->display && source->ops->display(source, out_display);
}

const struct gz_status *gz_gaze_source_status(const struct gz_gaze_source *source)
{
	return source->ops->status ? source->ops->status(source) : NULL;
}

void gz_gaze_source_destroy(struct gz_gaze_source **source)
{
	if (!source || !*source)
		return;
	(*source)->ops->destroy(*source);
	*source = NULL;
}
