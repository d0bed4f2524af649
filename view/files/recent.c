#include "view/files/recent.h"

#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "base/text.h"

#define GZ_LOG_MODULE "recent"

enum gz_result gz_recent_file(char out_path[GZ_PATH_SIZE])
{
	const char *state = getenv("XDG_STATE_HOME"), *home = getenv("HOME");
	int length = -1;
	/* The specification: relative paths are ignored. */
	if (state && state[0] == '/')
		length = snprintf(out_path, GZ_PATH_SIZE, "%s/gazecast/recent", state);
	else if (home && home[0] == '/')
		length = snprintf(out_path, GZ_PATH_SIZE, "%s/.local/state/gazecast/recent", home);
	return length > 0 && length < GZ_PATH_SIZE ? GZ_OK : GZ_ERR_NOT_FOUND;
}

void gz_recent_read(const char *file, struct gz_recent *out_recent)
{
	char line[GZ_PATH_SIZE + 1];
	*out_recent = (struct gz_recent) { 0 };
	FILE *stream = fopen(file, "re");
	while (stream && out_recent->count < GZ_RECENT_MAX && fgets(line, sizeof line, stream)) {
		char *end = strchr(line, '\n');
		if (!end) { /* too long: skip the rest of the line */
			for (int c = fgetc(stream); c != '\n' && c != EOF;)
				c = fgetc(stream);
			continue;
		}
		*end = '\0';
		if (line[0] == '/')
			memcpy(out_recent->paths[out_recent->count++], line,
			       (size_t)(end - line) + 1);
	}
	if (stream)
		fclose(stream);
}

void gz_recent_add(struct gz_recent *recent, const char *path)
{
	char *real = realpath(path, NULL);
	if (!real || strlen(real) >= GZ_PATH_SIZE || strpbrk(real, "\n")) {
		free(real);
		return;
	}
	size_t at = 0;
	while (at < recent->count && strcmp(recent->paths[at], real) != 0)
		at++;
	if (at == recent->count && recent->count < GZ_RECENT_MAX)
		recent->count++;
	if (at == GZ_RECENT_MAX)
		at--;
	memmove(recent->paths[1], recent->paths[0], at * sizeof recent->paths[0]);
	memcpy(recent->paths[0], real, strlen(real) + 1);
	free(real);
}

/* Create the folders above a file with mode 0700, as the specification asks. */
static void make_state_folders(const char *file)
{
	char path[GZ_PATH_SIZE];
	snprintf(path, sizeof path, "%s", file);
	for (char *slash = strchr(path + 1, '/'); slash; slash = strchr(slash + 1, '/')) {
		*slash = '\0';
		mkdir(path, S_IRWXU);
		*slash = '/';
	}
}

enum gz_result gz_recent_write(const struct gz_recent *recent, const char *file,
			       const struct gz_log *log)
{
	struct gz_text text = { 0 };
	for (size_t i = 0; i < recent->count; i++)
		gz_text_add(&text, "%s\n", recent->paths[i]);
	make_state_folders(file);
	/* A list that is not kept is no reason to stop, and the user did not choose its place. */
	const enum gz_result result = gz_text_write(&text, file, NULL);
	if (result != GZ_OK)
		gz_info(log, "%s: cannot be written, so this file is not listed as recent", file);
	gz_text_free(&text);
	return result;
}

bool gz_recent_is_first(const struct gz_recent *recent, const char *path)
{
	char *real = recent->count > 0 ? realpath(path, NULL) : NULL;
	const bool first = real && strcmp(real, recent->paths[0]) == 0;
	free(real);
	return first;
}

/* FNV-1a with 64 bits (Fowler, Noll and Vo; draft-eastlake-fnv). */
static uint64_t hash_of(const char *text)
{
	uint64_t hash = UINT64_C(14695981039346656037);
	for (; *text; text++)
		hash = (hash ^ (unsigned char)*text) * UINT64_C(1099511628211);
	return hash;
}

enum gz_result gz_recent_picture(const char *path, char out_path[GZ_PATH_SIZE])
{
	char list[GZ_PATH_SIZE];
	if (gz_recent_file(list) != GZ_OK)
		return GZ_ERR_NOT_FOUND;
	*strrchr(list, '/') = '\0';
	const enum gz_result r = gz_text_print(out_path, GZ_PATH_SIZE, "%s/pictures/%016llx.png",
					       list, (unsigned long long)hash_of(path));
	return r == GZ_OK ? GZ_OK : GZ_ERR_NOT_FOUND;
}

enum gz_result gz_recent_write_picture(const struct gz_image *image, const char *file,
				       const struct gz_log *log)
{
	make_state_folders(file);
	return gz_image_write_png(image, file, log);
}
