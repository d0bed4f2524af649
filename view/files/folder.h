/**
 * @file
 * The contents of a folder, for the list from which the user opens a scene, volume or picture.
 */
#ifndef GZ_VIEW_FILES_FOLDER_H
#define GZ_VIEW_FILES_FOLDER_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/result.h"
#include "protocol/gaze.h"
#include "render/scene/scene_open.h"

/** Size of an entry's name with its NUL, bytes. Longer names are left out. */
#define GZ_FOLDER_NAME_SIZE 256

/** Largest number of entries read. Chosen: nobody searches a longer list by eye. */
#define GZ_FOLDER_ENTRIES_MAX 20000

/** One file or folder. */
struct gz_folder_entry {
	char name[GZ_FOLDER_NAME_SIZE];
	bool is_folder;
	enum gz_file_kind kind; /**< judged by the name */
	uint64_t bytes;
};

/** A folder that was read. Zero-initialised: no folder. */
struct gz_folder {
	char path[GZ_PATH_SIZE]; /**< absolute */
	/** Folders first, then files; each by name, with numbers in names compared by value. */
	struct gz_folder_entry *entries;
	size_t count, room;
	size_t others; /**< files left out because gazeview cannot open them */
};

/** What is listed besides folders, scenes, volumes and pictures. */
struct gz_folder_filter {
	bool others; /**< all other files */
	bool hidden; /**< names that begin with a dot */
};

/**
 * Read a folder and replace what @p folder holds.
 *
 * @param[out] message  on failure: the reason, one line, cut to @p message_size bytes
 * @retval GZ_ERR_IO      the folder cannot be read; @p folder is unchanged
 * @retval GZ_ERR_NO_MEM  out of memory; @p folder is unchanged
 */
enum gz_result gz_folder_read(const char *path, const struct gz_folder_filter *filter,
			      struct gz_folder *folder, char *message, size_t message_size);

/**
 * Find an entry, ignoring case.
 *
 * @return the index of the first name that begins with @p text, otherwise of the first that
 *         contains it, otherwise folder->count. An empty text finds nothing.
 */
size_t gz_folder_find(const struct gz_folder *folder, const char *text);

/**
 * The path of @p name relative to the folder. An absolute name stays as it is; "~/" stands for the
 * user's home folder.
 *
 * @retval GZ_ERR_FULL  the path does not fit; @p out_path is an empty string
 */
enum gz_result gz_folder_path_of(const struct gz_folder *folder, const char *name,
				 char out_path[GZ_PATH_SIZE]);

/** Free the entries and zero @p folder. */
void gz_folder_free(struct gz_folder *folder);

#endif
