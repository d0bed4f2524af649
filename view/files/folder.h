/**
 * @file
 * What is in a folder, for somebody who looks for something to open.
 */
#ifndef GZ_VIEW_FILES_FOLDER_H
#define GZ_VIEW_FILES_FOLDER_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/result.h"
#include "protocol/gaze.h"
#include "render/scene/scene_open.h"

#define GZ_FOLDER_NAME_SIZE 256

/** Most entries of a folder that are listed. Chosen: more nobody looks through. */
#define GZ_FOLDER_ENTRIES_MAX 20000

/** Something in a folder. */
struct gz_folder_entry {
	char name[GZ_FOLDER_NAME_SIZE];
	bool is_folder;
	enum gz_file_kind kind; /**< by its name */
	uint64_t bytes;
};

/** A folder, read. Zero-initialised holds none. */
struct gz_folder {
	char path[GZ_PATH_SIZE];         /**< absolute */
	struct gz_folder_entry *entries; /**< folders first, then by name, numbers in it by value */
	size_t count, room;
	size_t others; /**< files that are none to open, not listed */
};

/** What is listed beside folders, scenes, volumes and pictures. */
struct gz_folder_filter {
	bool others; /**< every other file too */
	bool hidden; /**< names that begin with a dot too */
};

/**
 * Read a folder, in place of the one that @p folder holds.
 *
 * @param[out] message  on failure: what is wrong, one line
 * @retval GZ_ERR_IO      it cannot be read; @p folder is as it was
 * @retval GZ_ERR_NO_MEM  @p folder is as it was
 */
enum gz_result gz_folder_read(const char *path, const struct gz_folder_filter *filter,
			      struct gz_folder *folder, char *message, size_t message_size);

/** The first entry whose name begins with @p text, letters alike in either case, else the first
 * that has it within; folder->count if none does. An empty text: no entry. */
size_t gz_folder_find(const struct gz_folder *folder, const char *text);

/** The path of something in the folder; absolute names stay, "~/" is the user's own folder.
 *  GZ_ERR_FULL: it does not fit, and @p out_path is an empty string */
enum gz_result gz_folder_path_of(const struct gz_folder *folder, const char *name,
				 char out_path[GZ_PATH_SIZE]);

/** Free what it holds and zero it. */
void gz_folder_free(struct gz_folder *folder);

#endif
