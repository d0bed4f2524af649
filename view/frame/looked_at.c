#include "view/frame/looked_at.h"

#include <math.h>

#include "render/raycast/shared/ray_params.h"
#include "render/section/section.h"

/* The object whose matter rays pass; NULL: there is none. */
static const struct gz_object *find_clear_object(const struct gz_object *objects, size_t count)
{
	for (size_t i = 0; i < count; i++)
		if (objects[i].technique->sharing == GZ_SHARES_AS_CLEAR && objects[i].volume &&
		    objects[i].transfer)
			return &objects[i];
	return NULL;
}

/* The ray of a place, up to what is picked there. */
static bool ray_of_place(const struct gz_pick_request *request, const struct gz_pick *pick,
			 struct gz_section_ray *out_ray)
{
	const struct gz_ray_params *rays = request->settings;
	struct gz_ray_frame frame;
	double length = 0;
	if (gz_camera_rays(request->camera, request->width, request->height, &frame) != GZ_OK)
		return false;
	const double x = request->x - 0.5, y = request->y - 0.5;
	for (int i = 0; i < 3; i++) {
		out_ray->origin[i] =
			frame.origin00[i] + x * frame.origin_dx[i] + y * frame.origin_dy[i];
		out_ray->direction[i] = frame.direction00[i] + x * frame.direction_dx[i] +
					y * frame.direction_dy[i];
		length += out_ray->direction[i] * out_ray->direction[i];
	}
	out_ray->until = pick->count > 0 ? pick->depths[0] / sqrt(length) : INFINITY;
	out_ray->clip = rays->clip;
	return true;
}

/* The values that look like the one that is seen. */
static struct gz_looked_at values_seen(const struct gz_object *object,
				       const struct gz_section_seen *seen)
{
	const double value = fmin(1, fmax(0, seen->value));
	struct gz_transfer_emphasis alike = { .least = value - seen->unit / 2,
					      .greatest = value + seen->unit / 2 };
	if (!object->volume->labels)
		gz_transfer_find_alike(object->transfer, value, &alike);
	return (struct gz_looked_at) { object->id, value, alike.least, alike.greatest };
}

struct gz_looked_at gz_looked_at_find(struct gz_picture_maker *pictures,
				      const struct gz_object *objects, size_t count,
				      const struct gz_pick_request *request)
{
	struct gz_pick pick = { 0 };
	struct gz_section_ray ray;
	struct gz_section_seen seen;
	if (gz_picture_maker_pick(pictures, request, &pick) != GZ_OK)
		pick.count = 0;
	const struct gz_object *clear = find_clear_object(objects, count);
	if (clear && ray_of_place(request, &pick, &ray)) {
		/* Without emphasis: what stands out now would go on to hide what is in front of it.
		 */
		struct gz_transfer plain = *clear->transfer;
		plain.emphasis = (struct gz_transfer_emphasis) { 0 };
		if (gz_section_look(clear->volume, &plain, &ray, &seen) &&
		    (pick.count == 0 || seen.opacity >= 0.5))
			return values_seen(clear, &seen);
	}
	return (struct gz_looked_at) { .id = gz_pick_most_seen(&pick) };
}
