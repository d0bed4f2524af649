/* The .particles files of Schlemminger, Mueller and Berg, "Visualisierung von Fluiden mit OpenGL",
 * 2017: a header of two 32-bit numbers, time steps and particles, then 44 bytes for each particle
 * of each step. All numbers are little-endian. Positions are 0 to 1. */
#include <inttypes.h>
#include <math.h>
#include <sys/stat.h>

#include "render/particles/particle_reader.h"

#define GZ_LOG_MODULE "particles"

enum { HEAD_BYTES = 8, PARTICLE_BYTES = 44 };

/* Where a particle has its numbers, bytes. Bytes 12 to 23 are a normal. */
enum { AT_POSITION = 0, AT_VELOCITY = 24, AT_DENSITY = 36, AT_PRESSURE = 40 };

/* What the header says. */
struct particles_head {
	uint64_t steps, particles;
};

static uint64_t head_number(const uint8_t *bytes)
{
	return (uint64_t)gz_file_number_at(bytes, GZ_FILE_U32, false);
}

static struct particles_head head_at(const uint8_t *bytes)
{
	return (struct particles_head) { head_number(bytes), head_number(bytes + 4) };
}

/* There is no magic word: the size must be that of the header's numbers. */
static bool recognise_liquid(const char *path, const struct gz_file_start *start)
{
	struct stat file;
	if (start->coding != GZ_CODING_PLAIN || start->size < HEAD_BYTES || stat(path, &file) != 0)
		return false;
	const struct particles_head head = head_at(start->bytes);
	if (head.steps < 1 || head.steps > GZ_TIME_POINTS_MAX || head.particles < 1)
		return false;
	return (uint64_t)file.st_size == HEAD_BYTES + PARTICLE_BYTES * head.particles * head.steps;
}

static double real_at(const uint8_t *bytes, size_t at)
{
	return gz_file_number_at(bytes + at, GZ_FILE_F32, false);
}

static double value_of(const uint8_t *bytes, enum gz_particle_value value)
{
	const double vx = real_at(bytes, AT_VELOCITY), vy = real_at(bytes, AT_VELOCITY + 4),
		     vz = real_at(bytes, AT_VELOCITY + 8);
	switch (value) {
	case GZ_PARTICLE_DENSITY:
		return real_at(bytes, AT_DENSITY);
	case GZ_PARTICLE_PRESSURE:
		return real_at(bytes, AT_PRESSURE);
	case GZ_PARTICLE_SPEED:
		return sqrt(vx * vx + vy * vy + vz * vz);
	case GZ_PARTICLE_FILL:
	case GZ_PARTICLE_VALUE_COUNT:
		break;
	}
	return 1;
}

/* The steps that the file holds whole. Compressed bytes are not counted ahead. */
static enum gz_result check_steps(struct gz_particle_reader *reader, struct particles_head *head)
{
	const struct gz_particle_request *request = reader->request;
	const uint64_t step_bytes = PARTICLE_BYTES * head->particles;
	if (head->steps < 1 || head->steps > GZ_TIME_POINTS_MAX)
		return gz_particle_refuse(reader, "%" PRIu64 " time steps; 1 to %d are read",
					  head->steps, GZ_TIME_POINTS_MAX);
	const enum gz_result result =
		gz_particle_check_claim(reader, head->particles, PARTICLE_BYTES, "particles");
	if (result != GZ_OK)
		return result;
	const uint64_t bytes = gz_byte_stream_bound(reader->stream) - HEAD_BYTES;
	const uint64_t whole = step_bytes > 0 ? bytes / step_bytes : head->steps;
	if (whole < head->steps) {
		gz_warn(request->log,
			"%s: truncated: of %" PRIu64 " time steps only the first %" PRIu64
			" are there, and shown",
			request->path, head->steps, whole);
		head->steps = whole;
	}
	if ((uint64_t)request->time_point < head->steps)
		return GZ_OK;
	gz_err(request->log, "%s: has no time point %d; it has %" PRIu64, request->path,
	       request->time_point + 1, head->steps);
	return GZ_ERR_INVAL;
}

static enum gz_result add_step(struct gz_particle_reader *reader, uint64_t particles)
{
	uint8_t bytes[PARTICLE_BYTES];
	enum gz_result result = GZ_OK;
	for (uint64_t i = 0; i < particles && result == GZ_OK; i++) {
		result = gz_particle_take(reader, bytes, sizeof bytes);
		const double position[3] = { real_at(bytes, AT_POSITION),
					     real_at(bytes, AT_POSITION + 4),
					     real_at(bytes, AT_POSITION + 8) };
		if (result == GZ_OK)
			result = gz_particle_add(reader, position,
						 value_of(bytes, reader->request->value));
	}
	return result;
}

/* Widen the range by the values of a step that is not shown. */
static enum gz_result scan_step(struct gz_particle_reader *reader, uint64_t particles)
{
	uint8_t bytes[PARTICLE_BYTES];
	double *range = reader->particles.value_range;
	for (uint64_t i = 0; i < particles; i++) {
		const enum gz_result result = gz_particle_take(reader, bytes, sizeof bytes);
		if (result != GZ_OK)
			return result;
		const double value = (double)(float)value_of(bytes, reader->request->value);
		if (fabs(value) <= GZ_PARTICLE_VALUE_MAX) {
			range[0] = fmin(range[0], value);
			range[1] = fmax(range[1], value);
		}
	}
	return GZ_OK;
}

static enum gz_result read_steps(struct gz_particle_reader *reader,
				 const struct particles_head *head)
{
	const struct gz_particle_request *request = reader->request;
	const bool scan = !request->range_known && request->value != GZ_PARTICLE_FILL;
	const uint64_t shown = (uint64_t)request->time_point;
	enum gz_result result = GZ_OK;
	if (!scan)
		result = gz_particle_take(reader, NULL, shown * PARTICLE_BYTES * head->particles);
	for (uint64_t step = scan ? 0 : shown; step < head->steps && result == GZ_OK; step++) {
		if (step != shown && !scan)
			break;
		result = step == shown ? add_step(reader, head->particles)
				       : scan_step(reader, head->particles);
	}
	return result;
}

static enum gz_result load_liquid(const struct gz_particle_request *request,
				  struct gz_particles *out_particles)
{
	struct gz_particle_reader *reader = NULL;
	struct particles_head head = { 0 };
	uint8_t bytes[HEAD_BYTES];
	enum gz_result result = gz_particle_reader_open(request, &reader);
	if (result == GZ_OK)
		result = gz_particle_take(reader, bytes, sizeof bytes);
	if (result == GZ_OK) {
		head = head_at(bytes);
		result = check_steps(reader, &head);
	}
	if (result == GZ_OK) {
		struct gz_particles *particles = &reader->particles;
		particles->has_box = true;
		for (int i = 0; i < 3; i++)
			particles->box_greatest[i] = 1;
		particles->time_points = (int)head.steps;
		particles->time_point = request->time_point;
		result = read_steps(reader, &head);
	}
	return gz_particle_reader_close(&reader, result, out_particles);
}

const struct gz_particle_format gz_particle_format_particles = {
	.name = "particles of a liquid over time",
	.endings = { ".particles", ".particles.gz", ".particles.zst" },
	.recognise = recognise_liquid,
	.load = load_liquid,
	.limits = "positions from 0 to 1, density, pressure and velocity; normals are not used",
};
