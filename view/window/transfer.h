/**
 * @file
 * The part of the window in which the transfer function is edited. Internal to view/.
 */
#ifndef GZ_VIEW_WINDOW_TRANSFER_H
#define GZ_VIEW_WINDOW_TRANSFER_H

#include <stdbool.h>

#include "render/transfer/transfer.h"
#include "view/window/part.h"

/** The part. */
extern const struct gz_window_part gz_window_transfer_part;

/**
 * The transfer function as it is shown, edits counted in.
 *
 * @param[out] out_differs  whether no file has it: it has been changed since it was loaded or saved
 * @param[out] out_file     path of the file that it was loaded from or saved to last; empty: none.
 *                          Valid until the next turn; NULL: not wanted
 * @return valid until the next turn; NULL without a scene
 */
const struct gz_transfer *gz_window_transfer(const struct gz_window *window, bool *out_differs,
					     const char **out_file);

/** The file that window->settings name has it: it differs from no file any more. */
void gz_window_transfer_saved(struct gz_window *window);

/** Load a file in the place of what is shown, as one step that can be taken back; the settings name
 * it then. @return what gz_transfer_load() returns; logged. GZ_ERR_INVAL without a scene; logged */
enum gz_result gz_window_transfer_load(struct gz_window *window, const char *file);

#endif
