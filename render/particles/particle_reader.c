#include "render/particles/particle_reader.h"

#include <inttypes.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "base/text.h"

#define GZ_LOG_MODULE "particles"

/* Particles between two reports of progress. Chosen: a few milliseconds. */
#define REPORT_EVERY ((size_t)1 << 16)

enum { FIRST_ROOM = 1024 };

enum gz_result gz_particle_reader_open(const struct gz_particle_request *request,
				       struct gz_particle_reader **out_reader)
{
	struct gz_particle_reader *reader = calloc(1, sizeof *reader);
	*out_reader = reader;
	if (!reader) {
		gz_err(request->log, "%s: no memory", request->path);
		return GZ_ERR_NO_MEM;
	}
	reader->request = request;
	reader->particles.time_points = 1;
	reader->particles.value_range[0] = reader->particles.value_range[1] = 1;
	if (request->value != GZ_PARTICLE_FILL) {
		reader->particles.value_range[0] = INFINITY;
		reader->particles.value_range[1] = -INFINITY;
	}
	return gz_byte_stream_open(request->path, gz_coding_of_file(request->path), 0, request->log,
				   &reader->stream);
}

static void tell_left_out(const struct gz_particle_reader *reader)
{
	const struct gz_particle_request *request = reader->request;
	if (reader->lost > 0)
		gz_warn(request->log,
			"%s: %zu of %zu particles are left out: their position%s is not finite, or "
			"beyond 1e30",
			request->path, reader->lost,
			reader->lost + reader->outside + reader->particles.count,
			request->value == GZ_PARTICLE_FILL ? "" : " or value");
	if (reader->outside > 0)
		gz_warn(request->log,
			"%s: %zu particles are left out: they lie outside 0 to 1, where this "
			"format has all",
			request->path, reader->outside);
}

enum gz_result gz_particle_reader_close(struct gz_particle_reader **reader, enum gz_result result,
					struct gz_particles *out_particles)
{
	struct gz_particle_reader *r = *reader;
	if (!r)
		return result;
	if (result == GZ_OK && r->particles.count == 0)
		result = r->lost + r->outside == 0
				 ? gz_particle_refuse(r, "has no particles; nothing can be shown")
				 : gz_particle_refuse(r,
						      "none of its %zu particles has a finite "
						      "position within reach and a value; nothing "
						      "can be shown",
						      r->lost + r->outside);
	if (result == GZ_OK) {
		tell_left_out(r);
		r->particles.left_out = r->lost + r->outside;
		*out_particles = r->particles;
	} else {
		gz_particles_free(&r->particles);
	}
	gz_byte_stream_close(&r->stream);
	free(r);
	*reader = NULL;
	return result;
}

enum gz_result gz_particle_refuse(const struct gz_particle_reader *reader, const char *format, ...)
{
	char text[256];
	va_list arguments;
	va_start(arguments, format);
	vsnprintf(text, sizeof text, format, arguments);
	va_end(arguments);
	gz_err(reader->request->log, "%s: %s", reader->request->path, text);
	return GZ_ERR_FORMAT;
}

/* Fill the buffer again once all of it is used. */
static enum gz_result refill(struct gz_particle_reader *reader)
{
	size_t got = 0;
	if (reader->at < reader->size || reader->ended)
		return GZ_OK;
	const enum gz_result result =
		gz_byte_stream_read(reader->stream, reader->bytes, sizeof reader->bytes, &got);
	reader->at = 0;
	reader->size = result == GZ_OK ? got : 0;
	reader->ended = reader->size < sizeof reader->bytes;
	return result;
}

static enum gz_result refuse_truncated(const struct gz_particle_reader *reader)
{
	return gz_particle_refuse(reader,
				  "truncated: it ends after %" PRIu64
				  " bytes, before all it announces; fetch it again",
				  reader->taken);
}

/* Pass over bytes that are not in the buffer. */
static enum gz_result skip_unread(struct gz_particle_reader *reader, uint64_t size)
{
	const enum gz_result result = gz_byte_stream_skip(reader->stream, size);
	if (result == GZ_OK)
		reader->taken += size;
	return result;
}

enum gz_result gz_particle_take(struct gz_particle_reader *reader, void *buffer, uint64_t size)
{
	uint8_t *out = buffer;
	if (!out && size > reader->size - reader->at && !reader->ended) {
		const size_t there = reader->size - reader->at;
		reader->at = reader->size;
		reader->taken += there;
		return skip_unread(reader, size - there);
	}
	while (size > 0) {
		const enum gz_result result = refill(reader);
		if (result != GZ_OK)
			return result;
		const size_t there = reader->size - reader->at;
		const size_t part = there < size ? there : (size_t)size;
		if (part == 0)
			return refuse_truncated(reader);
		if (out) {
			memcpy(out, reader->bytes + reader->at, part);
			out += part;
		}
		reader->at += part;
		reader->taken += part;
		size -= part;
	}
	return GZ_OK;
}

/* The next byte; -1 at the end of the file. */
static enum gz_result next_byte(struct gz_particle_reader *reader, int *out_byte)
{
	const enum gz_result result = refill(reader);
	*out_byte = -1;
	if (result == GZ_OK && reader->at < reader->size) {
		*out_byte = reader->bytes[reader->at++];
		reader->taken++;
	}
	return result;
}

enum gz_result gz_particle_take_line(struct gz_particle_reader *reader,
				     char line[GZ_PARTICLE_LINE_MAX])
{
	size_t used = 0;
	int byte = -1;
	for (;;) {
		const enum gz_result result = next_byte(reader, &byte);
		if (result != GZ_OK)
			return result;
		if (byte < 0 && used == 0)
			return GZ_ERR_NOT_FOUND;
		if (byte < 0 || byte == '\n')
			break;
		if (used + 1 == GZ_PARTICLE_LINE_MAX)
			return gz_particle_refuse(reader, "a line is longer than %d bytes",
						  GZ_PARTICLE_LINE_MAX - 1);
		line[used++] = (char)byte;
	}
	if (used > 0 && line[used - 1] == '\r')
		used--;
	line[used] = '\0';
	return GZ_OK;
}

bool gz_particle_word_number(const char *word, double *out_number)
{
	static const char *const not_finite[] = { "nan", "inf", "infinity" };
	if (gz_number_parse(word, out_number))
		return true;
	const char *bare = word + (*word == '-' || *word == '+');
	for (size_t i = 0; i < sizeof not_finite / sizeof not_finite[0]; i++)
		if (strcasecmp(bare, not_finite[i]) == 0) {
			*out_number = (double)NAN;
			return true;
		}
	/* Numbers beyond the range of a double are as good as infinite. */
	char *end = NULL;
	const double number = strtod(word, &end);
	if (end == word || *end != '\0' || isfinite(number))
		return false;
	*out_number = (double)NAN;
	return true;
}

static bool separates_words(int byte)
{
	return byte == ' ' || byte == '\t' || byte == '\n' || byte == '\r' || byte == ',';
}

static enum gz_result take_word(struct gz_particle_reader *reader, char word[GZ_PARTICLE_LINE_MAX])
{
	size_t used = 0;
	int byte = -1;
	do {
		const enum gz_result result = next_byte(reader, &byte);
		if (result != GZ_OK)
			return result;
	} while (byte >= 0 && separates_words(byte));
	while (byte >= 0 && !separates_words(byte) && used + 1 < GZ_PARTICLE_LINE_MAX) {
		word[used++] = (char)byte;
		const enum gz_result result = next_byte(reader, &byte);
		if (result != GZ_OK)
			return result;
	}
	word[used] = '\0';
	return used > 0 ? GZ_OK : refuse_truncated(reader);
}

static enum gz_result read_text_numbers(struct gz_particle_reader *reader, double *out_numbers,
					uint64_t count)
{
	char word[GZ_PARTICLE_LINE_MAX];
	double number;
	for (uint64_t i = 0; i < count; i++) {
		const enum gz_result result = take_word(reader, word);
		if (result != GZ_OK)
			return result;
		if (!gz_particle_word_number(word, &number))
			return gz_particle_refuse(reader,
						  "%.40s, before byte %" PRIu64 ", is not a number",
						  word, reader->taken);
		if (out_numbers)
			out_numbers[i] = number;
	}
	return GZ_OK;
}

enum gz_result gz_particle_read_numbers(struct gz_particle_reader *reader, enum gz_file_number type,
					double *out_numbers, uint64_t count)
{
	uint8_t bytes[8] = { 0 };
	const size_t size = gz_file_number_size(type);
	if (reader->coding == GZ_PARTICLE_TEXT)
		return read_text_numbers(reader, out_numbers, count);
	if (!out_numbers)
		return gz_particle_take(reader, NULL, count * size);
	for (uint64_t i = 0; i < count; i++) {
		const enum gz_result result = gz_particle_take(reader, bytes, size);
		if (result != GZ_OK)
			return result;
		out_numbers[i] =
			gz_file_number_at(bytes, type, reader->coding == GZ_PARTICLE_BIG_ENDIAN);
	}
	return GZ_OK;
}

enum gz_result gz_particle_check_claim(const struct gz_particle_reader *reader, uint64_t count,
				       uint64_t each, const char *what)
{
	const uint64_t bound = gz_byte_stream_bound(reader->stream);
	const uint64_t left = bound > reader->taken ? bound - reader->taken : 0;
	if (count <= left / each)
		return GZ_OK;
	return gz_particle_refuse(reader,
				  "announces %" PRIu64 " %s, but has bytes for at most %" PRIu64
				  "; fetch it again",
				  count, what, left / each);
}

static enum gz_result grow_particles(struct gz_particle_reader *reader)
{
	struct gz_particles *particles = &reader->particles;
	const bool valued = reader->request->value != GZ_PARTICLE_FILL;
	const size_t room = reader->room ? 2 * reader->room : FIRST_ROOM;
	double(*positions)[3] = NULL;
	float *values = particles->values;
	if (gz_memory_fits_machine(room * (sizeof *positions + sizeof *values)))
		positions = realloc(particles->positions, room * sizeof *positions);
	if (positions) {
		particles->positions = positions;
		values = valued ? realloc(particles->values, room * sizeof *values) : NULL;
	}
	if (!positions || (valued && !values)) {
		gz_err(reader->request->log, "%s: no memory for %zu particles",
		       reader->request->path, room);
		return GZ_ERR_NO_MEM;
	}
	particles->values = values;
	reader->room = room;
	return GZ_OK;
}

static bool position_usable(const double position[3])
{
	for (int i = 0; i < 3; i++)
		if (!(fabs(position[i]) <= GZ_PARTICLE_COORDINATE_MAX))
			return false;
	return true;
}

static bool inside_promised_box(const struct gz_particles *particles, const double position[3])
{
	for (int i = 0; i < 3 && particles->has_box; i++)
		if (position[i] < particles->box_least[i] ||
		    position[i] > particles->box_greatest[i])
			return false;
	return true;
}

/* Tell how far the file is read, now and then. */
static enum gz_result report_reading(struct gz_particle_reader *reader)
{
	const struct gz_particle_request *request = reader->request;
	const uint64_t bound = gz_byte_stream_bound(reader->stream);
	if (reader->particles.count - reader->reported < REPORT_EVERY)
		return GZ_OK;
	reader->reported = reader->particles.count;
	const double share = bound > 0 ? (double)reader->taken / (double)bound : 0;
	return gz_loading_goes_on(request->loading, share, request->path) ? GZ_OK
									  : GZ_ERR_CANCELLED;
}

enum gz_result gz_particle_add(struct gz_particle_reader *reader, const double position[3],
			       double value)
{
	struct gz_particles *particles = &reader->particles;
	const bool valued = reader->request->value != GZ_PARTICLE_FILL;
	if (!position_usable(position) || (valued && !(fabs(value) <= GZ_PARTICLE_VALUE_MAX))) {
		reader->lost++;
		return GZ_OK;
	}
	if (!inside_promised_box(particles, position)) {
		reader->outside++;
		return GZ_OK;
	}
	if (particles->count == GZ_PARTICLES_MAX)
		return gz_particle_refuse(reader, "more than %zu particles are not read",
					  GZ_PARTICLES_MAX);
	const enum gz_result result =
		particles->count == reader->room ? grow_particles(reader) : GZ_OK;
	if (result != GZ_OK)
		return result;
	memcpy(particles->positions[particles->count], position, sizeof *particles->positions);
	if (valued) {
		const float stored = (float)value;
		particles->values[particles->count] = stored;
		particles->value_range[0] = fmin(particles->value_range[0], (double)stored);
		particles->value_range[1] = fmax(particles->value_range[1], (double)stored);
	}
	particles->count++;
	return report_reading(reader);
}

enum gz_result gz_particle_one_step(const struct gz_particle_reader *reader)
{
	const struct gz_particle_request *request = reader->request;
	if (request->time_point == 0)
		return GZ_OK;
	gz_err(request->log, "%s: has no time point %d; it holds one time step", request->path,
	       request->time_point + 1);
	return GZ_ERR_INVAL;
}

enum gz_result gz_particle_refuse_value(const struct gz_particle_reader *reader, unsigned there)
{
	char list[64] = "fill";
	size_t used = strlen(list);
	for (int i = 1; i < GZ_PARTICLE_VALUE_COUNT; i++)
		if (there & 1U << i)
			used += (size_t)snprintf(list + used, sizeof list - used, ", %s",
						 gz_particle_value_names[i]);
	gz_err(reader->request->log, "%s: its particles have no %s; particles.value may be: %s",
	       reader->request->path, gz_particle_value_names[reader->request->value], list);
	return GZ_ERR_UNSUPPORTED;
}

enum gz_particle_value gz_particle_value_named(const char *name)
{
	static const struct {
		const char *name;
		enum gz_particle_value value;
	} names[] = {
		{ "density", GZ_PARTICLE_DENSITY },
		{ "pressure", GZ_PARTICLE_PRESSURE },
		{ "velocity", GZ_PARTICLE_SPEED },
		{ "v", GZ_PARTICLE_SPEED },
	};
	for (size_t i = 0; i < sizeof names / sizeof names[0]; i++)
		if (strcasecmp(name, names[i].name) == 0)
			return names[i].value;
	return GZ_PARTICLE_FILL;
}
