/**
 * @file
 * Where a panel opens: where it covers no other one. If there is no such place, the panels that
 * were opened first are folded. Pure functions.
 */
#ifndef GZ_VIEW_PANELS_PANEL_PLACES_H
#define GZ_VIEW_PANELS_PANEL_PLACES_H

#include <stdbool.h>

#ifdef __cplusplus
extern "C" {
#endif

/** Most other panels. Chosen: there are fewer. */
#define GZ_PANEL_OTHERS_MAX 12

/** A rectangle, x to the right and y down. */
struct gz_panel_rectangle {
	float x, y, width, height;
};

/** Another panel that is shown. */
struct gz_panel_other {
	struct gz_panel_rectangle at; /**< of a folded one: its title */
	float title_height;
	int opened;  /**< those with lower numbers were opened earlier */
	bool folded; /**< only its title is shown */
};

/** A panel to be placed. */
struct gz_panel_placing {
	struct gz_panel_rectangle room; /**< where panels may lie */
	float gap;                      /**< kept free between panels */
	float width, height;            /**< of the panel */
	float wanted[2];                /**< its upper left corner where nothing is in the way */
	struct gz_panel_other others[GZ_PANEL_OTHERS_MAX];
	int count; /**< of others, at most GZ_PANEL_OTHERS_MAX */
};

/**
 * Find a place for a panel. If it would cover others wherever it lay, the earliest of these are
 * folded, their titles at the top of the room; but none if that does not help either. Then the
 * place is the one that covers least.
 *
 * @param[in,out] placing  others that are to be folded become so, at their new places
 * @param[out] out_corner  upper left corner of the panel
 */
void gz_panel_find_place(struct gz_panel_placing *placing, float out_corner[2]);

#ifdef __cplusplus
}
#endif

#endif
