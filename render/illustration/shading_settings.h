/**
 * @file
 * The settings of a shading map: the thesis's 24 single ones and three more, and six that stand for
 * them in everyday use (Pfisterer 2007, sections 3.2 and 3.3).
 */
#ifndef GZ_RENDER_ILLUSTRATION_SHADING_SETTINGS_H
#define GZ_RENDER_ILLUSTRATION_SHADING_SETTINGS_H

#include <stdbool.h>

#include "base/option.h"

/** The single settings, section [shading_map]. Presets are the thesis's defaults (section 3.3.1)
 *  where it has one, otherwise what the presets of the six make of them. */
struct gz_shading_settings {
	/** Towards the light, in the frame of the picture: right, up, towards the viewer. */
	double light_direction[3];
	/* Weights of surface parameters, relative to each other. */
	double main_light, plateau_light, grazing_light, surface_shape, curvature;
	int main_light_smoothing; /**< level of the normals, 0: the surface's own */
	double plain_light;       /**< weight, too: Lambert's law */
	double flat;              /**< brightness of surfaces if all these weights are 0 */
	double exaggeration;      /**< a of grazing light */
	double detail_frequency;  /**< 0: wide forms, 1: fine ones */
	double equalisation;      /**< share of the equalised tone, the rest is the tone itself */
	/* Weights of scene information. */
	double importance, viewer_distance, object_distance;
	double object_distance_mm; /**< distance that counts as far */
	/* Image parameters. Widths are standard deviations, shares of the picture's height. */
	double edge_light, edge_light_width;
	double overlap_shadow, overlap_shadow_width;
	double haze, haze_near, haze_far, haze_exponent;
	double haze_background; /**< brightness of what is far */
	double lines;           /**< weight */
	int line_width;         /**< number of the filter, 1 to 4: L1 to L4 */
};

/** The table of struct gz_shading_settings. */
extern const struct gz_option gz_shading_options[];
/** Its rows. */
extern const size_t gz_shading_option_count;

/** Which scene information a picture shows. One at a time: several would cover each other. */
enum gz_scene_information {
	GZ_SHOWS_NONE,
	GZ_SHOWS_IMPORTANCE,
	GZ_SHOWS_VIEWER_DISTANCE,
	GZ_SHOWS_OBJECT_DISTANCE,
};

/** The six combined settings, section [illustration]; numbers are from 0 (little) over 1/2 (medium)
 *  to 1 (much). */
struct gz_illustration_settings {
	double edge_emphasis;    /**< less main light and more plateau light, wider lines */
	double detail_amplitude; /**< below 1/2 smoother than the surface, above exaggerated */
	double detail_frequency; /**< 0: wide forms, 1: fine ones */
	double spatial_effect;   /**< edge light, overlap shadow, atmospheric perspective */
	double foreground;       /**< how far the foreground reaches before the haze */
	int scene_information;   /**< enum gz_scene_information */
};

/** Depth from which on there is haze, for each share of the foreground: gz_illustration_apply(). */
#define GZ_HAZE_NEAR_OF_FOREGROUND 0.6

/** The table of struct gz_illustration_settings. */
extern const struct gz_option gz_illustration_options[];
/** Its rows. */
extern const size_t gz_illustration_option_count;

/**
 * Set the single settings that the six stand for; the others stay. The thesis says which settings
 * belong together and in which direction they go (section 3.3.2); the ends of their ranges are
 * chosen:
 *
 *  - edge emphasis e: main light 1 - 0.6 e, plateau light 0.7 e, so that at e = 1/2 plateau light
 *    has half the weight of main light, the most that section 3.3.3 advises for whole scenes; line
 *    width 1 to 4; grazing light (main light + plateau light) / 2, the ratio 1 : 2 of section 3.3.1
 *  - detail amplitude a: exaggeration 4^(2 a - 1), that is 1/4 to 4; below a = 1/2 main light
 *    smoothed by up to 4 levels; above, surface shape up to a weight of 1/2
 *  - detail frequency: the same number
 *  - spatial effect s: edge light, overlap shadow and haze have the weight s
 *  - foreground f: haze from depth 0.6 f on, with the exponent 0.5 * 4^f
 *  - scene information: the one that is shown has the weight 1, the others 0
 */
void gz_illustration_apply(const struct gz_illustration_settings *combined,
			   struct gz_shading_settings *settings);

#endif
