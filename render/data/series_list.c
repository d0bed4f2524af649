#include "render/data/series_list.h"

#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "base/utf8.h"
#include "render/data/decoded_volume.h"
#include "render/data/dicom_name.h"

#define GZ_LOG_MODULE "volume"

/* Rows for which there is room at first. */
#define ROOM_LEAST 16

struct kept_row {
	struct gz_series_row row;
	uint32_t bands; /* of its picture that are there, one bit each */
};

struct gz_series_list {
	pthread_mutex_t lock;
	void (*wake)(void);
	/* Under the lock: */
	struct kept_row *rows;
	size_t count, room;
	uint64_t version;
};

enum gz_result gz_series_list_create(void (*wake)(void), struct gz_series_list **out_list)
{
	struct gz_series_list *list = calloc(1, sizeof *list);
	if (!list)
		return GZ_ERR_NO_MEM;
	pthread_mutex_init(&list->lock, NULL);
	list->wake = wake;
	*out_list = list;
	return GZ_OK;
}

void gz_series_list_free(struct gz_series_list **list)
{
	if (!*list)
		return;
	pthread_mutex_destroy(&(*list)->lock);
	free((*list)->rows);
	free(*list);
	*list = NULL;
}

size_t gz_series_list_count(struct gz_series_list *list)
{
	pthread_mutex_lock(&list->lock);
	const size_t count = list->count;
	pthread_mutex_unlock(&list->lock);
	return count;
}

uint64_t gz_series_list_version(struct gz_series_list *list)
{
	pthread_mutex_lock(&list->lock);
	const uint64_t version = list->version;
	pthread_mutex_unlock(&list->lock);
	return version;
}

bool gz_series_list_update(struct gz_series_list *list, size_t index, struct gz_series_row *row)
{
	pthread_mutex_lock(&list->lock);
	const bool changed = index < list->count && list->rows[index].row.version != row->version;
	if (changed)
		*row = list->rows[index].row;
	pthread_mutex_unlock(&list->lock);
	return changed;
}

/* ---- filling ---- */

static bool make_room_for_row(struct gz_series_list *list)
{
	const size_t room = list->room ? 2 * list->room : ROOM_LEAST;
	if (list->count < list->room)
		return true;
	struct kept_row *rows = realloc(list->rows, room * sizeof *rows);
	if (!rows)
		return false;
	list->rows = rows;
	list->room = room;
	return true;
}

/* Note that a row has changed, and let go of the list. */
static void finish_change(struct gz_series_list *list, struct kept_row *kept)
{
	kept->row.version = ++list->version;
	pthread_mutex_unlock(&list->lock);
	if (list->wake)
		list->wake();
}

static enum gz_result add_series_row(void *user, const struct gz_decode_series *series)
{
	struct gz_series_list *list = user;
	pthread_mutex_lock(&list->lock);
	if (!make_room_for_row(list)) {
		pthread_mutex_unlock(&list->lock);
		return GZ_ERR_NO_MEM;
	}
	struct kept_row *kept = &list->rows[list->count++];
	memset(kept, 0, sizeof *kept);
	kept->row.series = *series;
	finish_change(list, kept);
	return GZ_OK;
}

static void add_picture_rows(void *user, uint32_t index, const struct gz_decode_picture *picture)
{
	struct gz_series_list *list = user;
	pthread_mutex_lock(&list->lock);
	struct kept_row *kept = &list->rows[index];
	memcpy(kept->row.picture + picture->band * sizeof picture->pixels, picture->pixels,
	       sizeof picture->pixels);
	kept->bands |= 1U << picture->band;
	kept->row.has_picture = kept->bands == (1U << GZ_DECODE_PICTURE_BANDS) - 1;
	finish_change(list, kept);
}

static void refuse_series_row(void *user, uint32_t index, const char *why)
{
	struct gz_series_list *list = user;
	pthread_mutex_lock(&list->lock);
	struct kept_row *kept = &list->rows[index];
	snprintf(kept->row.series.reason, sizeof kept->row.series.reason, "%s", why);
	gz_utf8_clean(kept->row.series.reason); /* a character may have been cut */
	finish_change(list, kept);
}

struct gz_decode_listener gz_series_list_listener(struct gz_series_list *list)
{
	return (struct gz_decode_listener) {
		.user = list,
		.series = add_series_row,
		.picture = add_picture_rows,
		.refused = refuse_series_row,
	};
}

enum gz_result gz_series_list_read(const char *path, const struct gz_loading *loading,
				   const struct gz_log *log, struct gz_series_list *list)
{
	struct gz_loading listing = loading ? *loading : (struct gz_loading) { 0 };
	struct stat status;
	listing.series_list = list;
	const struct gz_volume_file file = { .path = path, .loading = &listing, .log = log };
	struct gz_volume none;
	if (stat(path, &status) == 0 && !gz_dicom_is(path)) {
		gz_err(log, "%s: not DICOM; only DICOM folders and files hold several series",
		       path);
		return GZ_ERR_UNSUPPORTED;
	}
	const enum gz_result result = gz_volume_decode(&file, "dicom-list", NULL, &none);
	return result == GZ_ERR_CHOICE ? GZ_OK : result;
}
