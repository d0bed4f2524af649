#include "render/raycast/shared/ray_content.h"

#include <string.h>

static bool same_depths(const struct gz_ray_content *content, const struct gz_ray_depths *depths)
{
	if (!depths)
		return !content->deep;
	return content->deep && content->depths.nearest == depths->nearest &&
	       content->depths.farthest == depths->farthest;
}

uint64_t gz_ray_content_follow(struct gz_ray_content *content, const struct gz_plan *plan,
			       const struct gz_ray_params *rays, const struct gz_ray_frame *frame,
			       const struct gz_ray_depths *depths, uint64_t revision)
{
	const int *shift = plan->view.shift;
	if (content->any && content->revision == revision &&
	    memcmp(&content->frame, frame, sizeof *frame) == 0 && content->shift[0] == shift[0] &&
	    content->shift[1] == shift[1] && content->step_phase == (int)plan->step_phase &&
	    same_depths(content, depths) && gz_ray_params_same(&content->rays, rays))
		return content->serial;
	*content = (struct gz_ray_content) {
		.any = true,
		.serial = content->serial + 1,
		.revision = revision,
		.frame = *frame,
		.shift = { shift[0], shift[1] },
		.step_phase = (int)plan->step_phase,
		.deep = depths != NULL,
		.rays = *rays,
	};
	if (depths)
		content->depths = *depths;
	return content->serial;
}

void gz_ray_content_forget(struct gz_ray_content *content)
{
	content->any = false;
}
