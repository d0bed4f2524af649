#include "render/illustration/shading_tile.h"

#include "render/illustration/plane_kernels.h"

void gz_shading_tile_compose(const struct gz_shading_shared *shared, int x, int y,
			     struct gz_shading_tile *room)
{
	gz_plane_kernels_find()->compose_tile(shared, x, y, room);
}

void gz_shading_row_survey(const struct gz_shading_frame *frame, int y,
			   const struct gz_depth_range *range, uint8_t *filled, float *out_shares)
{
	gz_plane_kernels_find()->survey_row(frame, y, range, filled, out_shares);
}
