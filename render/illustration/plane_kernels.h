/**
 * @file
 * The loops over planes for each instruction set; internal to this room. plane_kernels.c,
 * plane_kernels_avx2.c and plane_kernels_avx512.c compile the same loops (shading_tile_loops.h and
 * what it includes), with the same bits.
 */
#ifndef GZ_RENDER_ILLUSTRATION_PLANE_KERNELS_H
#define GZ_RENDER_ILLUSTRATION_PLANE_KERNELS_H

#include "render/illustration/depth_blur.h"
#include "render/illustration/feature_lines.h"
#include "render/illustration/shading_tile.h"
#include "render/illustration/tone_curve.h"

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
	/** gz_depth_enlarge() */
	void (*enlarge_cells)(const float *cells, int width, int height, int level, int x, int y,
			      float *out_pixels);
	/** gz_feature_lines() */
	bool (*find_lines)(const struct gz_line_window *window, int rows,
			   enum gz_line_filter filter, float threshold, float *out_lines);
	/** gz_tone_count() */
	void (*count_tones)(const void *map, const uint32_t *ids, size_t count, size_t step,
			    struct gz_tone_histogram *histogram);
	/** gz_shading_row_survey() */
	void (*survey_row)(const struct gz_shading_frame *frame, int y,
			   const struct gz_depth_range *range, uint8_t *filled, float *out_shares);
	/** gz_shading_tile_compose() */
	void (*compose_tile)(const struct gz_shading_shared *shared, int x, int y,
			     struct gz_shading_tile *room);
};

extern const struct gz_plane_kernels gz_plane_kernels_portable;
#ifdef GZ_ILLUSTRATION_X86
extern const struct gz_plane_kernels gz_plane_kernels_avx2;
extern const struct gz_plane_kernels gz_plane_kernels_avx512;
#endif

/** The best that this processor runs. Static. */
const struct gz_plane_kernels *gz_plane_kernels_find(void);

#endif
