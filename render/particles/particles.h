/**
 * @file
 * Particles of a simulated liquid, or any other points in space, and the files that hold them. The
 * content of a file decides which format it has; only files that begin like nothing known are
 * chosen by their names.
 */
#ifndef GZ_RENDER_PARTICLES_PARTICLES_H
#define GZ_RENDER_PARTICLES_PARTICLES_H

#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

#include "base/log.h"
#include "base/result.h"
#include "render/data/volume.h"

/** Most particles of one time step. Chosen: their positions take 3 GiB. */
#define GZ_PARTICLES_MAX ((size_t)1 << 27)

/** Largest coordinate. Chosen: squares of differences stay finite in single precision's range of
 *  exponents once positions are scaled to the box. */
#define GZ_PARTICLE_COORDINATE_MAX 1e30

/** Largest value of a particle. Chosen: sums of as many as there may be stay finite floats. */
#define GZ_PARTICLE_VALUE_MAX 1e30

/** A quantity that particles carry: scene key particles.value. */
enum gz_particle_value {
	GZ_PARTICLE_FILL,     /**< 1 for each particle: where the liquid is. Needs no data */
	GZ_PARTICLE_DENSITY,  /**< in the file's unit */
	GZ_PARTICLE_PRESSURE, /**< in the file's unit */
	GZ_PARTICLE_SPEED,    /**< length of the velocity, in the file's unit */
	GZ_PARTICLE_VALUE_COUNT,
};

/** "fill", "density", "pressure", "speed"; NULL-terminated, in the order of the enum. */
extern const char *const gz_particle_value_names[];

/** The particles of one time step. Read-only once loaded; threads may share them. */
struct gz_particles {
	size_t count;           /**< 1 or more */
	double (*positions)[3]; /**< x, y, z in the file's unit; |each| is at most
				   GZ_PARTICLE_COORDINATE_MAX */
	float *values;          /**< one for each, |it| is at most GZ_PARTICLE_VALUE_MAX; NULL for
				   GZ_PARTICLE_FILL */
	size_t left_out; /**< particles of the file that are not here: without a finite position or
			    value, or outside the box that the format promises */
	bool has_box;    /**< the format promises where particles are */
	double box_least[3], box_greatest[3]; /**< corners of that box */
	int time_points;                      /**< of the file; 1 or more */
	int time_point;                       /**< which of them this is, from 0 */
	double value_range[2]; /**< least and greatest value of all time points; 1, 1 for
				  GZ_PARTICLE_FILL */
};

/** What to load. All pointers are borrowed until the call returns. */
struct gz_particle_request {
	const char *path;
	enum gz_particle_value value;
	int time_point;                   /**< from 0 */
	bool range_known;                 /**< value_range need not cover other time points */
	const struct gz_loading *loading; /**< its report only; may be NULL */
	const struct gz_log *log;         /**< may be NULL */
};

/** Most endings of a format's file names. */
#define GZ_PARTICLE_ENDINGS_MAX 4

struct gz_file_start;

/** One format. Rows are const and have static storage. */
struct gz_particle_format {
	const char *name; /**< "PLY" */
	/** Endings of file names, ".ply"; unused ones are NULL. Case does not matter. */
	const char *endings[GZ_PARTICLE_ENDINGS_MAX];
	/** Whether a file at @p path that begins so is of the format. Must be sure. */
	bool (*recognise)(const char *path, const struct gz_file_start *start);
	/** Load particles. Logs each failure except GZ_ERR_CANCELLED. Results of
	 *  gz_particles_load(). */
	enum gz_result (*load)(const struct gz_particle_request *request,
			       struct gz_particles *out_particles);
	const char *limits; /**< what is read, for people */
};

/** The format of a file by the ending of its name; NULL if none has it. */
const struct gz_particle_format *gz_particle_format_by_name(const char *path);

/** The format of a file by its first bytes and its size; NULL if none recognises it. Opens the
 *  file. Logs nothing. */
const struct gz_particle_format *gz_particle_format_by_content(const char *path);

/**
 * Whether a file holds particles: by its content, and, if neither a format of particles nor one of
 * volumes recognises that, by its name.
 */
const struct gz_particle_format *gz_particle_format_of(const char *path);

/** Print all formats for people: names, endings and what is read of each. */
void gz_particle_formats_print(FILE *out);

/**
 * Load the particles of a file. One line tells how many were left out, and why.
 *
 * @param[out] out_particles  written on GZ_OK; the caller frees it with gz_particles_free()
 * @retval GZ_ERR_INVAL        there is no such time point; logged
 * @retval GZ_ERR_NOT_FOUND    no such file; logged
 * @retval GZ_ERR_IO           it cannot be read; logged
 * @retval GZ_ERR_FORMAT       truncated, contradictory, or without any particle; logged
 * @retval GZ_ERR_UNSUPPORTED  another format, an encoding that is not read, or the file has no such
 *                             value; logged
 * @retval GZ_ERR_NO_MEM       logged
 * @retval GZ_ERR_CANCELLED    the request's loading stopped it; not logged
 *
 * Memory grows with the particles that are read, whatever number of them the file claims.
 */
enum gz_result gz_particles_load(const struct gz_particle_request *request,
				 struct gz_particles *out_particles);

/** Free the particles and zero the struct. Accepts a zero-initialised one. */
void gz_particles_free(struct gz_particles *particles);

#endif
