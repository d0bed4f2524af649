#include "render/scene/saved_view.h"

#include <ctype.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define GZ_LOG_MODULE "scene"

/* Least and most digits that tell a double from all others (IEEE 754-2008, 5.12.2). */
enum { DIGITS_LEAST = 6, DIGITS_MOST = 17 };

static size_t add_number(char *text, size_t used, double number)
{
	char shortest[32] = "";
	for (int digits = DIGITS_LEAST; digits <= DIGITS_MOST; digits++) {
		snprintf(shortest, sizeof shortest, "%.*g", digits, number);
		if (strtod(shortest, NULL) == number)
			break;
	}
	return used + (size_t)snprintf(text + used, GZ_SAVED_VIEW_SIZE - used, " %s", shortest);
}

static size_t add_place(char *text, size_t used, const char *word, const double place[3])
{
	used += (size_t)snprintf(text + used, GZ_SAVED_VIEW_SIZE - used, "%s%s", used ? " " : "",
				 word);
	for (int i = 0; i < 3; i++)
		used = add_number(text, used, place[i]);
	return used;
}

void gz_saved_view_print(const struct gz_camera *camera, char out_text[GZ_SAVED_VIEW_SIZE])
{
	const bool parallel = camera->projection == GZ_PROJECTION_ORTHOGRAPHIC;
	size_t used = add_place(out_text, 0, "eye", camera->eye);
	used = add_place(out_text, used, "look_at", camera->look_at);
	used = add_place(out_text, used, "up", camera->up);
	used += (size_t)snprintf(out_text + used, GZ_SAVED_VIEW_SIZE - used, " %s",
				 parallel ? "height" : "fov_deg");
	add_number(out_text, used, parallel ? camera->height : camera->fov_deg);
}

static void skip_blanks(const char **text)
{
	while (isspace((unsigned char)**text))
		(*text)++;
}

/* The word, ended by a blank; *text is then behind it. */
static bool take_word(const char **text, const char *word)
{
	const size_t length = strlen(word);
	skip_blanks(text);
	if (strncmp(*text, word, length) != 0 || !isspace((unsigned char)(*text)[length]))
		return false;
	*text += length;
	return true;
}

static bool take_number(const char **text, double *out_number)
{
	char *end;
	*out_number = strtod(*text, &end);
	const bool whole = end != *text && (!*end || isspace((unsigned char)*end));
	*text = end;
	return whole;
}

static bool take_place(const char **text, const char *word, double out_place[3])
{
	return take_word(text, word) && take_number(text, &out_place[0]) &&
	       take_number(text, &out_place[1]) && take_number(text, &out_place[2]);
}

static bool take_projection(const char **text, struct gz_camera *camera)
{
	if (take_word(text, "fov_deg")) {
		camera->projection = GZ_PROJECTION_PERSPECTIVE;
		return take_number(text, &camera->fov_deg);
	}
	camera->projection = GZ_PROJECTION_ORTHOGRAPHIC;
	return take_word(text, "height") && take_number(text, &camera->height);
}

enum gz_result gz_saved_view_parse(const char *text, struct gz_camera *camera)
{
	struct gz_camera read = *camera;
	struct gz_ray_frame rays;
	if (!take_place(&text, "eye", read.eye) || !take_place(&text, "look_at", read.look_at) ||
	    !take_place(&text, "up", read.up) || !take_projection(&text, &read))
		return GZ_ERR_FORMAT;
	skip_blanks(&text);
	if (*text || gz_camera_rays(&read, 1, 1, &rays) != GZ_OK)
		return GZ_ERR_FORMAT;
	*camera = read;
	return GZ_OK;
}

enum gz_result gz_saved_views_check(const char views[GZ_SAVED_VIEWS][GZ_SAVED_VIEW_SIZE],
				    const char *name, const struct gz_log *log)
{
	for (int i = 0; i < GZ_SAVED_VIEWS; i++) {
		struct gz_camera camera = { .fov_deg = 1, .height = 1 };
		if (!views[i][0] || gz_saved_view_parse(views[i], &camera) == GZ_OK)
			continue;
		gz_err(log,
		       "%s: views.%d: no view; the form is: eye X Y Z look_at X Y Z up X Y Z "
		       "fov_deg F, or height H at its end, with the eye elsewhere than look_at",
		       name, i + 1);
		return GZ_ERR_FORMAT;
	}
	return GZ_OK;
}
