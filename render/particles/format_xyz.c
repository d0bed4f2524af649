/* XYZ: text with a point a line: x, y and z, separated by blanks, commas or semicolons; further
 * words of the line are not used. Comments begin with # or //. The first line may be the number of
 * points, and the line behind it is then a comment, as chemists write it. */
#include <ctype.h>
#include <inttypes.h>
#include <math.h>
#include <string.h>

#include "base/text.h"
#include "render/particles/particle_reader.h"

#define GZ_LOG_MODULE "particles"

#define SEPARATORS " \t,;"

static bool is_comment(const char *line)
{
	const char *text = line + strspn(line, SEPARATORS);
	return !*text || *text == '#' || strncmp(text, "//", 2) == 0;
}

/* Read a point from a line, which is changed. */
static bool take_point(char *line, double out_position[3])
{
	char *rest = line;
	for (int i = 0; i < 3; i++) {
		const char *word = gz_number_next_word(&rest, SEPARATORS);
		if (!word || !gz_particle_word_number(word, &out_position[i]))
			return false;
	}
	return true;
}

/* Text of points only, at least two: a line that the start cuts off does not count. */
static bool recognise_xyz(const char *path, const struct gz_file_start *start)
{
	char line[GZ_PARTICLE_LINE_MAX];
	double position[3];
	size_t at = 0, points = 0;
	(void)path;
	while (at < start->size) {
		const uint8_t *end = memchr(start->bytes + at, '\n', start->size - at);
		const size_t length = end ? (size_t)(end - (start->bytes + at)) : start->size - at;
		if (length >= sizeof line || memchr(start->bytes + at, 0, length))
			return false;
		if (!end && start->size == GZ_FILE_START_SIZE)
			break;
		memcpy(line, start->bytes + at, length);
		line[length > 0 && line[length - 1] == '\r' ? length - 1 : length] = '\0';
		at += length + 1;
		if (is_comment(line))
			continue;
		if (!take_point(line, position))
			return false;
		points++;
	}
	return points >= 2;
}

/* Whether a line is nothing but a whole number. */
static bool is_point_count(const char *line, uint64_t *out_count)
{
	char word[GZ_PARTICLE_LINE_MAX];
	long long number;
	memcpy(word, line, strlen(line) + 1);
	char *rest = word;
	const char *first = gz_number_next_word(&rest, SEPARATORS);
	if (!first || gz_number_next_word(&rest, SEPARATORS) ||
	    !gz_number_parse_whole(first, &number) || number < 0)
		return false;
	*out_count = (uint64_t)number;
	return true;
}

static enum gz_result add_line(struct gz_particle_reader *reader, char *line, uint64_t number)
{
	double position[3];
	if (is_comment(line))
		return GZ_OK;
	if (!take_point(line, position))
		return gz_particle_refuse(reader, "line %" PRIu64 " is not a point; write x y z",
					  number);
	return gz_particle_add(reader, position, 0);
}

/* The first line: a count, whose next line is a comment, or a point. */
static enum gz_result read_first_line(struct gz_particle_reader *reader, uint64_t *out_count,
				      uint64_t *number)
{
	char line[GZ_PARTICLE_LINE_MAX];
	enum gz_result result = gz_particle_take_line(reader, line);
	if (result != GZ_OK)
		return result;
	(*number)++;
	if (!is_point_count(line, out_count))
		return add_line(reader, line, *number);
	result = gz_particle_check_claim(reader, *out_count, 5, "points");
	if (result == GZ_OK)
		result = gz_particle_take_line(reader, line);
	(*number)++;
	return result;
}

static enum gz_result read_xyz(struct gz_particle_reader *reader)
{
	char line[GZ_PARTICLE_LINE_MAX];
	uint64_t announced = UINT64_MAX, number = 0;
	enum gz_result result = read_first_line(reader, &announced, &number);
	while (result == GZ_OK) {
		result = gz_particle_take_line(reader, line);
		number++;
		if (result == GZ_OK)
			result = add_line(reader, line, number);
	}
	if (result != GZ_ERR_NOT_FOUND)
		return result;
	const uint64_t points = reader->particles.count + reader->lost;
	if (announced != UINT64_MAX && announced != points)
		return gz_particle_refuse(reader, "announces %" PRIu64 " points, but has %" PRIu64,
					  announced, points);
	return GZ_OK;
}

static enum gz_result load_xyz(const struct gz_particle_request *request,
			       struct gz_particles *out_particles)
{
	struct gz_particle_reader *reader = NULL;
	enum gz_result result = gz_particle_reader_open(request, &reader);
	if (result == GZ_OK)
		result = gz_particle_one_step(reader);
	if (result == GZ_OK && request->value != GZ_PARTICLE_FILL)
		result = gz_particle_refuse_value(reader, 0);
	if (result == GZ_OK)
		result = read_xyz(reader);
	return gz_particle_reader_close(&reader, result, out_particles);
}

const struct gz_particle_format gz_particle_format_xyz = {
	.name = "XYZ",
	.endings = { ".xyz", ".xyz.gz" },
	.recognise = recognise_xyz,
	.load = load_xyz,
	.limits = "text: a point a line; what follows x y z in a line is not used",
};
