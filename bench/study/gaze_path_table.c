#include "bench/study/gaze_path_table.h"

#include <math.h>
#include <string.h>

#include "base/text.h"

#define GZ_LOG_MODULE "path"

/* Bytes of the largest table. Chosen: a million places of 64 bytes. */
#define TABLE_SIZE_MAX ((size_t)64 << 20)

/* How many pictures away a place may lie. */
#define FARTHEST 100

static const char blanks[] = ",; \t\r";

/* Cut the first line off. NULL behind the last. */
static char *next_line(char **text)
{
	char *line = *text, *end;
	if (!line || !*line)
		return NULL;
	end = strchr(line, '\n');
	*text = end ? end + 1 : NULL;
	if (end)
		*end = '\0';
	return line;
}

/* What a line holds. */
enum line_kind { LINE_PLACE, LINE_EMPTY, LINE_WORDS, LINE_SHORT };

static enum line_kind read_place(char *line, const int size[2], struct gz_point *out_gaze)
{
	double at[2];
	for (int axis = 0; axis < 2; axis++) {
		const char *word = gz_number_next_word(&line, blanks);
		if (axis == 0 && (!word || word[0] == '#'))
			return LINE_EMPTY;
		if (!word || !gz_number_parse(word, &at[axis]))
			return axis == 0 ? LINE_WORDS : LINE_SHORT;
		at[axis] /= size ? size[axis] : 1;
	}
	*out_gaze = (struct gz_point) { (float)at[0], (float)at[1] };
	return LINE_PLACE;
}

static enum gz_result refuse_line(const char *path, int number, enum line_kind kind, bool pixels,
				  const struct gz_log *log)
{
	if (kind != LINE_PLACE)
		gz_err(log, "%s:%d: not a place; give two numbers, x and y", path, number);
	else
		gz_err(log, "%s:%d: the place is %d pictures away%s", path, number, FARTHEST,
		       pixels ? "" : "; if it is in pixels, add their number: FILE.csv:1920x1080");
	return GZ_ERR_FORMAT;
}

static enum gz_result read_lines(const char *path, char *text, const int size[2],
				 const struct gz_log *log, gz_gaze_place_function *take, void *user)
{
	enum gz_result result = GZ_OK;
	char *line;
	for (int number = 1; result == GZ_OK && (line = next_line(&text)); number++) {
		struct gz_point gaze = { 0, 0 };
		const enum line_kind kind = read_place(line, size, &gaze);
		const bool near = fabsf(gaze.x) < FARTHEST && fabsf(gaze.y) < FARTHEST;
		if (kind == LINE_EMPTY || (kind == LINE_WORDS && number == 1))
			continue;
		result = kind == LINE_PLACE && near
				 ? take(user, gaze)
				 : refuse_line(path, number, kind, size != NULL, log);
	}
	return result;
}

enum gz_result gz_gaze_path_table_read(const char *path, const int size[2],
				       const struct gz_log *log, gz_gaze_place_function *take,
				       void *user)
{
	const struct gz_text_file file = { path, "table of places", TABLE_SIZE_MAX };
	struct gz_text text = { 0 };
	enum gz_result result = gz_text_load(&text, &file, log);
	if (result == GZ_OK)
		result = read_lines(path, text.bytes, size, log, take, user);
	gz_text_free(&text);
	return result;
}
