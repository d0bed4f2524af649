#include "render/illustration/feature_lines.h"

#include "render/illustration/plane_kernels.h"

void gz_feature_lines(const struct gz_line_planes *planes, const struct gz_plane_band *band,
		      enum gz_line_filter filter, float threshold, float *out_lines)
{
	gz_plane_kernels_find()->find_lines(planes, band, filter, threshold, out_lines);
}
