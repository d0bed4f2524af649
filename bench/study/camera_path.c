#include "bench/study/camera_path.h"

#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "base/text.h"
#include "bench/study/hash.h"
#include "render/scene/scene_settings.h"

#define GZ_LOG_MODULE "camera path"

/* Bytes of the largest file. Chosen: all frames of a path at 600 bytes. */
#define FILE_SIZE_MAX ((size_t)64 << 20)

static const char blanks[] = ",; \t\r";

/* A file in reading. */
struct reading {
	const char *path;
	const struct gz_log *log;
	int line;
	/* Of its keys only those of [camera] count. In a session: the camera of the next frame; in
	 * a table: what lines do not name. */
	struct gz_scene_settings *settings;
	struct gz_camera_path *out;
};

static enum gz_result refuse_line(const struct reading *reading, const char *what)
{
	gz_err(reading->log, "%s:%d: %s", reading->path, reading->line, what);
	return GZ_ERR_FORMAT;
}

static enum gz_result add_camera(const struct reading *reading, const struct gz_camera *camera)
{
	struct gz_camera_path *path = reading->out;
	struct gz_ray_frame unused;
	if (gz_camera_rays(camera, 1, 1, &unused) != GZ_OK)
		return refuse_line(reading, "eye and look_at must differ, and fov_deg lie between "
					    "0 and 180");
	if (path->count == GZ_CAMERA_PATH_MAX)
		return refuse_line(reading, "more cameras than a path may have");
	if (path->count == path->capacity) {
		const size_t capacity = path->capacity ? 2 * path->capacity : 64;
		struct gz_camera *cameras =
			realloc(path->cameras, capacity * sizeof *path->cameras);
		if (!cameras) {
			gz_err(reading->log, "%s: no memory", reading->path);
			return GZ_ERR_NO_MEM;
		}
		path->cameras = cameras;
		path->capacity = capacity;
	}
	path->cameras[path->count++] = *camera;
	return GZ_OK;
}

/* ---- tables ---- */

enum { NUMBERS_MAX = 10 };

static enum gz_result read_table_line(const struct reading *reading, char *line)
{
	double numbers[NUMBERS_MAX + 1];
	int count = 0;
	for (char *word; count <= NUMBERS_MAX && (word = gz_number_next_word(&line, blanks));
	     count++) {
		if (word[0] == '#')
			break;
		if (gz_number_parse(word, &numbers[count]))
			continue;
		if (count == 0 && reading->line == 1)
			return GZ_OK; /* a heading */
		return refuse_line(reading, "not a number");
	}
	if (count == 0)
		return GZ_OK;
	if (count != 6 && count != 9 && count != NUMBERS_MAX)
		return refuse_line(reading,
				   "not a camera; give eye x y z, look_at x y z, and, if they "
				   "change, up x y z and fov_deg");
	struct gz_camera camera = reading->settings->camera;
	memcpy(camera.eye, numbers, sizeof camera.eye);
	memcpy(camera.look_at, numbers + 3, sizeof camera.look_at);
	if (count > 6)
		memcpy(camera.up, numbers + 6, sizeof camera.up);
	if (count > 9)
		camera.fov_deg = numbers[9];
	return add_camera(reading, &camera);
}

/* ---- sessions ---- */

static const char session_head[] = "#gazecast-session ";

/* "!set KEY VALUE" changes the camera if the key is one of [camera]. */
static enum gz_result change_camera(struct reading *reading, char *line)
{
	static const char set[] = "!set\t";
	if (strncmp(line, set, sizeof set - 1) != 0)
		return GZ_OK;
	struct gz_option_binding tables[GZ_SCENE_TABLE_COUNT];
	gz_scene_bind(reading->settings, tables);
	char *key = line + sizeof set - 1, *value = strchr(key, '\t');
	if (!value)
		return refuse_line(reading, "a setting without a value");
	*value++ = '\0';
	const struct gz_option *option = gz_options_find(&tables[GZ_SCENE_CAMERA], 1, key, NULL);
	char message[GZ_OPTION_MESSAGE_SIZE];
	if (option && gz_option_parse(option, value, tables[GZ_SCENE_CAMERA].target, message,
				      sizeof message) != GZ_OK)
		return refuse_line(reading, message);
	return GZ_OK;
}

static enum gz_result read_session_line(struct reading *reading, char *line)
{
	if (line[0] == '#' || line[0] == '\0')
		return GZ_OK;
	return line[0] == '!' ? change_camera(reading, line)
			      : add_camera(reading, &reading->settings->camera);
}

/* ---- both ---- */

static enum gz_result read_lines(struct reading *reading, char *text)
{
	enum gz_result result = GZ_OK;
	const bool session = text && strncmp(text, session_head, sizeof session_head - 1) == 0;
	while (text && result == GZ_OK) {
		char *line = text, *end = strchr(text, '\n');
		text = end ? end + 1 : NULL;
		if (end)
			*end = '\0';
		reading->line++;
		result =
			session ? read_session_line(reading, line) : read_table_line(reading, line);
	}
	if (result == GZ_OK && reading->out->count == 0) {
		gz_err(reading->log, "%s: no camera in it", reading->path);
		result = GZ_ERR_FORMAT;
	}
	return result;
}

enum gz_result gz_camera_path_read(const char *path, const struct gz_camera *first,
				   const struct gz_log *log, struct gz_camera_path *out_path)
{
	const struct gz_text_file file = { path, "camera path", FILE_SIZE_MAX };
	struct gz_text text = { 0 };
	struct gz_camera_path made = { 0 };
	struct gz_scene_settings *settings = calloc(1, sizeof *settings);
	struct reading reading = { .path = path, .log = log, .settings = settings, .out = &made };
	if (!settings)
		return GZ_ERR_NO_MEM;
	settings->camera = *first;
	enum gz_result result = gz_text_load(&text, &file, log);
	if (result == GZ_OK)
		result = read_lines(&reading, text.bytes);
	gz_text_free(&text);
	free(settings);
	if (result == GZ_OK)
		*out_path = made;
	else
		gz_camera_path_free(&made);
	return result;
}

void gz_camera_path_hash(const struct gz_camera_path *path, struct gz_hash *hash)
{
	gz_hash_add_number(hash, (double)path->count);
	for (size_t i = 0; i < path->count; i++) {
		const struct gz_camera *camera = &path->cameras[i];
		for (int axis = 0; axis < 3; axis++) {
			gz_hash_add_number(hash, camera->eye[axis]);
			gz_hash_add_number(hash, camera->look_at[axis]);
			gz_hash_add_number(hash, camera->up[axis]);
		}
		gz_hash_add_number(hash, camera->projection);
		gz_hash_add_number(hash, camera->fov_deg);
		gz_hash_add_number(hash, camera->height);
	}
}

void gz_camera_path_free(struct gz_camera_path *path)
{
	free(path->cameras);
	*path = (struct gz_camera_path) { 0 };
}
