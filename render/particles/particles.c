#include "render/particles/particles.h"

#include <stdlib.h>

#include "base/file.h"
#include "render/data/format.h"
#include "render/particles/particle_reader.h"

#define GZ_LOG_MODULE "particles"

const char *const gz_particle_value_names[] = { "fill", "density", "pressure", "speed", NULL };

static const struct gz_particle_format *const particle_formats[] = {
	&gz_particle_format_bgeo,      &gz_particle_format_vtk, &gz_particle_format_ply,
	&gz_particle_format_particles, &gz_particle_format_xyz,
};

enum { FORMATS = sizeof particle_formats / sizeof particle_formats[0] };

const struct gz_particle_format *gz_particle_format_by_name(const char *path)
{
	for (size_t i = 0; i < FORMATS; i++)
		for (size_t k = 0; k < GZ_PARTICLE_ENDINGS_MAX && particle_formats[i]->endings[k];
		     k++)
			if (gz_path_ends(path, particle_formats[i]->endings[k]))
				return particle_formats[i];
	return NULL;
}

const struct gz_particle_format *gz_particle_format_by_content(const char *path)
{
	struct gz_file_start start;
	if (!gz_file_start_read(path, &start))
		return NULL;
	for (size_t i = 0; i < FORMATS; i++)
		if (particle_formats[i]->recognise(path, &start))
			return particle_formats[i];
	return NULL;
}

const struct gz_particle_format *gz_particle_format_of(const char *path)
{
	const struct gz_particle_format *found = gz_particle_format_by_content(path);
	const struct gz_particle_format *named = gz_particle_format_by_name(path);
	return found || !named || gz_volume_format_by_content(path) ? found : named;
}

void gz_particle_formats_print(FILE *out)
{
	for (size_t i = 0; i < FORMATS; i++) {
		fprintf(out, "%s", particle_formats[i]->name);
		for (size_t k = 0; k < GZ_PARTICLE_ENDINGS_MAX && particle_formats[i]->endings[k];
		     k++)
			fprintf(out, " %s", particle_formats[i]->endings[k]);
		fprintf(out, "\n    %s\n", particle_formats[i]->limits);
	}
}

enum gz_result gz_particles_load(const struct gz_particle_request *request,
				 struct gz_particles *out_particles)
{
	const struct gz_particle_format *format = gz_particle_format_of(request->path);
	const struct gz_particle_format *named = gz_particle_format_by_name(request->path);
	if (!format) {
		gz_err(request->log,
		       "%s: unknown kind of particles; .particles, .bgeo, legacy .vtk, .ply and "
		       ".xyz are read",
		       request->path);
		return GZ_ERR_UNSUPPORTED;
	}
	if (named && named != format)
		gz_info(request->log, "%s: named as %s; its content is %s, so it is opened as that",
			request->path, named->name, format->name);
	return format->load(request, out_particles);
}

void gz_particles_free(struct gz_particles *particles)
{
	free(particles->positions);
	free(particles->values);
	*particles = (struct gz_particles) { 0 };
}
