#include "view/files/folder.h"

#include <dirent.h>
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>

#include "base/text.h"

static int compare_entries(const void *left, const void *right)
{
	const struct gz_folder_entry *a = left, *b = right;
	if (a->is_folder != b->is_folder)
		return a->is_folder ? -1 : 1;
	return strverscmp(a->name, b->name);
}

static bool is_listed(const struct gz_folder_entry *entry, const struct gz_folder_filter *filter)
{
	return filter->others || entry->is_folder || entry->kind == GZ_FILE_SCENE ||
	       entry->kind == GZ_FILE_VOLUME || entry->kind == GZ_FILE_RAW ||
	       entry->kind == GZ_FILE_PICTURE;
}

static enum gz_result append_entry(struct gz_folder *folder, const struct gz_folder_entry *entry)
{
	if (folder->count == folder->room) {
		const size_t room = folder->room ? 2 * folder->room : 64;
		struct gz_folder_entry *entries = realloc(folder->entries, room * sizeof *entries);
		if (!entries)
			return GZ_ERR_NO_MEM;
		folder->entries = entries;
		folder->room = room;
	}
	folder->entries[folder->count++] = *entry;
	return GZ_OK;
}

static enum gz_result list_entry(struct gz_folder *folder, DIR *stream, const char *name,
				 const struct gz_folder_filter *filter)
{
	struct gz_folder_entry entry = { .kind = gz_file_kind_by_name(name) };
	struct stat status;
	if (strlen(name) >= sizeof entry.name || strcmp(name, ".") == 0 ||
	    strcmp(name, "..") == 0 || (name[0] == '.' && !filter->hidden) ||
	    folder->count == GZ_FOLDER_ENTRIES_MAX || fstatat(dirfd(stream), name, &status, 0) != 0)
		return GZ_OK;
	memcpy(entry.name, name, strlen(name) + 1);
	entry.is_folder = S_ISDIR(status.st_mode);
	entry.bytes = (uint64_t)status.st_size;
	if (entry.is_folder || (S_ISREG(status.st_mode) && is_listed(&entry, filter)))
		return append_entry(folder, &entry);
	folder->others++;
	return GZ_OK;
}

static enum gz_result read_stream(DIR *stream, const struct gz_folder_filter *filter,
				  struct gz_folder *folder)
{
	enum gz_result result = GZ_OK;
	for (struct dirent *entry; result == GZ_OK && (entry = readdir(stream));)
		result = list_entry(folder, stream, entry->d_name, filter);
	if (folder->count > 0)
		qsort(folder->entries, folder->count, sizeof folder->entries[0], compare_entries);
	return result;
}

enum gz_result gz_folder_read(const char *path, const struct gz_folder_filter *filter,
			      struct gz_folder *folder, char *message, size_t message_size)
{
	struct gz_folder read = { 0 };
	char *real = realpath(path, NULL);
	DIR *stream = real && strlen(real) < GZ_PATH_SIZE ? opendir(real) : NULL;
	if (!stream) {
		snprintf(message, message_size, "%s: %s", path, strerror(errno));
		free(real);
		return GZ_ERR_IO;
	}
	memcpy(read.path, real, strlen(real) + 1);
	free(real);
	const enum gz_result result = read_stream(stream, filter, &read);
	closedir(stream);
	if (result != GZ_OK) {
		snprintf(message, message_size, "%s: %s", path, gz_result_text(result));
		gz_folder_free(&read);
		return result;
	}
	gz_folder_free(folder);
	*folder = read;
	return GZ_OK;
}

size_t gz_folder_find(const struct gz_folder *folder, const char *text)
{
	const size_t length = strlen(text);
	for (size_t i = 0; i < folder->count && length > 0; i++)
		if (strncasecmp(folder->entries[i].name, text, length) == 0)
			return i;
	for (size_t i = 0; i < folder->count && length > 0; i++)
		if (strcasestr(folder->entries[i].name, text))
			return i;
	return folder->count;
}

enum gz_result gz_folder_path_of(const struct gz_folder *folder, const char *name,
				 char out_path[GZ_PATH_SIZE])
{
	const char *home = getenv("HOME");
	if (name[0] == '/')
		return gz_text_print(out_path, GZ_PATH_SIZE, "%s", name);
	if (name[0] == '~' && (name[1] == '/' || !name[1]) && home)
		return gz_text_print(out_path, GZ_PATH_SIZE, "%s%s", home, name + 1);
	return gz_text_print(out_path, GZ_PATH_SIZE, "%s/%s",
			     strcmp(folder->path, "/") == 0 ? "" : folder->path, name);
}

void gz_folder_free(struct gz_folder *folder)
{
	free(folder->entries);
	*folder = (struct gz_folder) { 0 };
}
