/**
 * @file
 * The loops over planes for each instruction set; internal to this room. plane_kernels.c and
 * plane_kernels_avx2.c compile the same loops (depth_blur_loops.h, feature_lines_loops.h), with the
 * same bits.
 */
#ifndef GZ_RENDER_ILLUSTRATION_PLANE_KERNELS_H
#define GZ_RENDER_ILLUSTRATION_PLANE_KERNELS_H

#include "render/illustration/depth_blur.h"
#include "render/illustration/feature_lines.h"

/** What is done with bands of planes. Threads: any, for different bands. */
struct gz_plane_kernels {
	/** gz_blur_along_rows() */
	void (*blur_rows)(const struct gz_gaussian *gaussian, const struct gz_plane_band *band,
			  const float *in, float *out);
	/** gz_blur_along_columns() */
	void (*blur_columns)(const struct gz_gaussian *gaussian, const struct gz_plane_band *band,
			     const float *in, float *out);
	/** gz_depth_share() */
	void (*share_depth)(const void *depth, const uint32_t *ids, int count,
			    const struct gz_depth_range *range, float *out_shares);
	/** gz_depth_halve() */
	void (*halve_rows)(const float *upper, const float *lower, int width, float *out_cells);
	/** gz_depth_enlarge(), @p share of the way from the row of cells @p above to that @p below
	 */
	void (*enlarge_row)(const float *above, const float *below, float share, int width,
			    int level, int x, float *out_pixels);
	/** gz_feature_lines() */
	void (*find_lines)(const struct gz_line_window *window, int rows,
			   enum gz_line_filter filter, float threshold, float *out_lines);
};

extern const struct gz_plane_kernels gz_plane_kernels_portable;
#ifdef GZ_ILLUSTRATION_X86
extern const struct gz_plane_kernels gz_plane_kernels_avx2;
#endif

/** The best that this processor runs. Static. */
const struct gz_plane_kernels *gz_plane_kernels_find(void);

#endif
