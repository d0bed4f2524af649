/**
 * @file
 * The series that a path stands for, as a list to choose from: filled while a decoder process finds
 * them (render/decode/), read by whoever shows them.
 */
#ifndef GZ_RENDER_DATA_SERIES_LIST_H
#define GZ_RENDER_DATA_SERIES_LIST_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/log.h"
#include "base/result.h"
#include "render/data/volume.h"
#include "render/decode/decode.h"

/** A row of the list. */
struct gz_series_row {
	struct gz_decode_series series;
	uint64_t version; /**< changes with the row; 0: nothing is known yet */
	bool has_picture; /**< all of it is there */
	/** Grey, the topmost row first. */
	uint8_t picture[GZ_DECODE_PICTURE_EDGE * GZ_DECODE_PICTURE_EDGE];
};

/** A list. Threads may share it. */
struct gz_series_list;

/**
 * Make an empty list.
 *
 * @param wake  called when it has changed, on the thread that fills it; NULL: nobody waits
 * @param[out] out_list  owned by the caller: gz_series_list_free()
 * @retval GZ_ERR_NO_MEM  not logged
 */
enum gz_result gz_series_list_create(void (*wake)(void), struct gz_series_list **out_list);

/** Free and set to NULL. Accepts a pointer to NULL. */
void gz_series_list_free(struct gz_series_list **list);

/** Number of series so far. */
size_t gz_series_list_count(struct gz_series_list *list);

/** Changes with each change of the list. */
uint64_t gz_series_list_version(struct gz_series_list *list);

/** Bring a row up to date. @param[in,out] row  zeroed, or from an earlier call with this @p index,
 * below the count @return whether it has changed */
bool gz_series_list_update(struct gz_series_list *list, size_t index, struct gz_series_row *row);

/** What fills the list. Valid as long as it is. */
struct gz_decode_listener gz_series_list_listener(struct gz_series_list *list);

/**
 * List the DICOM series of a folder, a DICOMDIR or a file, even a single one. Blocks until all is
 * known.
 *
 * @param loading  progress and cancelling; may be NULL
 * @param list     may be read meanwhile
 * @retval GZ_OK               it has at least one series
 * @retval GZ_ERR_UNSUPPORTED  neither a folder nor a DICOM file; logged
 * @return else as gz_volume_load(); logged except GZ_ERR_CANCELLED
 */
enum gz_result gz_series_list_read(const char *path, const struct gz_loading *loading,
				   const struct gz_log *log, struct gz_series_list *list);

#endif
