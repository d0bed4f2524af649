/**
 * @file
 * What the formats of particles share: the bytes of a file as numbers, words and lines, and the
 * list that particles are added to. Inside this room only.
 */
#ifndef GZ_RENDER_PARTICLES_PARTICLE_READER_H
#define GZ_RENDER_PARTICLES_PARTICLE_READER_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "render/data/byte_stream.h"
#include "render/data/file_start.h"
#include "render/particles/particles.h"

/** How the numbers of a file are written. */
enum gz_particle_coding {
	GZ_PARTICLE_TEXT, /**< decimal, separated by blanks, ends of lines or commas */
	GZ_PARTICLE_LITTLE_ENDIAN,
	GZ_PARTICLE_BIG_ENDIAN,
};

/** Longest line of a header or a word of text, bytes with the NUL. Chosen: more than any writer
 *  makes. */
#define GZ_PARTICLE_LINE_MAX 1024

/** A file that is being read, and the particles found so far. */
struct gz_particle_reader {
	const struct gz_particle_request *request;
	struct gz_byte_stream *stream;
	enum gz_particle_coding coding; /**< of gz_particle_read_numbers(); set by the format */
	uint64_t taken;                 /**< bytes read by the format so far */
	struct gz_particles particles;
	size_t room;          /**< particles that fit */
	size_t lost, outside; /**< left out: not finite, outside the box */
	size_t reported;      /**< particles when progress was last reported */
	size_t size, at;      /**< of bytes: read, used */
	bool ended;           /**< the stream has no more than these bytes */
	uint8_t bytes[(size_t)64 << 10];
};

/** Open the request's file. The caller ends it with gz_particle_reader_close(), on failure too. Too
 *  large for a stack. Errors of gz_byte_stream_open(), and GZ_ERR_NO_MEM; logged. */
enum gz_result gz_particle_reader_open(const struct gz_particle_request *request,
				       struct gz_particle_reader **out_reader);

/**
 * Close the file and free the reader. If @p result is GZ_OK, its particles are handed over, after a
 * line about those that were left out.
 *
 * @param[out] out_particles  written if GZ_OK is returned
 * @return @p result; or GZ_ERR_FORMAT if there is no particle; logged
 */
enum gz_result gz_particle_reader_close(struct gz_particle_reader **reader, enum gz_result result,
					struct gz_particles *out_particles);

/** Log "path: what" and return GZ_ERR_FORMAT. */
__attribute__((format(printf, 2, 3))) enum gz_result gz_particle_refuse(
	const struct gz_particle_reader *reader, const char *format, ...);

/** Read exactly @p size bytes; @p buffer NULL passes over them. GZ_ERR_FORMAT if there are fewer;
 *  logged. */
enum gz_result gz_particle_take(struct gz_particle_reader *reader, void *buffer, uint64_t size);

/** Read a line without its end (LF or CR LF). @return GZ_OK, or GZ_ERR_NOT_FOUND at the end of the
 *  file, not logged; GZ_ERR_FORMAT if the line is too long; logged */
enum gz_result gz_particle_take_line(struct gz_particle_reader *reader,
				     char line[GZ_PARTICLE_LINE_MAX]);

/** Read a word of text as a number; "nan" and "inf" give NaN. Returns false for anything else. */
bool gz_particle_word_number(const char *word, double *out_number);

/**
 * Read @p count numbers in the reader's coding.
 *
 * @param type        of binary numbers
 * @param out_numbers NULL passes over them
 * @retval GZ_ERR_FORMAT  the file ends, or a word is no number; logged
 */
enum gz_result gz_particle_read_numbers(struct gz_particle_reader *reader, enum gz_file_number type,
					double *out_numbers, uint64_t count);

/**
 * Refuse a number of items that the rest of the file cannot hold, before anything is allocated.
 *
 * @param what      the items, such as "particles"
 * @param each      least bytes of one item in the file; 1 or more
 * @retval GZ_ERR_FORMAT  logged
 */
enum gz_result gz_particle_check_claim(const struct gz_particle_reader *reader, uint64_t count,
				       uint64_t each, const char *what);

/**
 * Add a particle. One without a finite position or value, or outside the box of the format, is
 * counted and left out.
 *
 * @param value  ignored for GZ_PARTICLE_FILL
 * @retval GZ_ERR_NO_MEM     logged
 * @retval GZ_ERR_FORMAT     more than GZ_PARTICLES_MAX; logged
 * @retval GZ_ERR_CANCELLED  the request's loading says so
 */
enum gz_result gz_particle_add(struct gz_particle_reader *reader, const double position[3],
			       double value);

/** Check that the request asks for the only time point that a file has. @return GZ_OK, or
 *  GZ_ERR_INVAL; logged */
enum gz_result gz_particle_one_step(const struct gz_particle_reader *reader);

/** Refuse the value that the request asks for. @param there  bits of the values that the file has,
 *  by enum gz_particle_value. @return GZ_ERR_UNSUPPORTED; logged */
enum gz_result gz_particle_refuse_value(const struct gz_particle_reader *reader, unsigned there);

/** The value that an array called @p name gives: density, pressure, or velocity, also called v;
 *  GZ_PARTICLE_FILL for any other. Case does not matter. */
enum gz_particle_value gz_particle_value_named(const char *name);

/** The rows. */
extern const struct gz_particle_format gz_particle_format_bgeo, gz_particle_format_particles,
	gz_particle_format_ply, gz_particle_format_vtk, gz_particle_format_xyz;

#endif
