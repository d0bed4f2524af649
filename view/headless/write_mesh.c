/* gazeview --write-mesh. */
#include <inttypes.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>

#include "render/mesh/mesh_file.h"
#include "render/mesh/mesh_measure.h"
#include "render/scene/scene_settings.h"
#include "render/surface/isosurface_technique.h"
#include "view/capture/mesh_output.h"
#include "view/capture/output.h"
#include "view/headless/headless.h"

#define GZ_LOG_MODULE "gazeview"

/* What is known about the mesh that was written. An open one encloses no volume; one that is closed
 * because of how it was made does even if it touches itself. */
static void print_mesh(const char *path, const struct gz_mesh *mesh, bool made_closed)
{
	struct gz_mesh_measures measures;
	printf("%s vertices %zu triangles %zu", path, mesh->vertex_count, mesh->triangle_count);
	if (gz_mesh_measure(mesh, &measures) != GZ_OK) {
		putchar('\n');
		return;
	}
	printf(" area %.6g mm2 volume ", measures.area);
	if (made_closed || gz_mesh_closed(&measures))
		printf("%.6g mm3", measures.volume);
	else
		putchar('-');
	printf(" euler %" PRId64 " border %zu\n", measures.euler, measures.border_edges);
}

/* ---- labels ---- */

/* A line for each label, and the file. */
static enum gz_result write_parts(const struct gz_mesh_part *parts, size_t count, const char *path,
				  const struct gz_log *log)
{
	const enum gz_result r = gz_mesh_write_parts(parts, count, path, log);
	char name[64];
	for (size_t i = 0; i < count && r == GZ_OK; i++) {
		snprintf(name, sizeof name, "label %" PRId32, parts[i].label);
		print_mesh(name, parts[i].mesh, true);
	}
	if (r == GZ_OK)
		printf("%s labels %zu\n", path, count);
	return r;
}

/* All labels of all objects in one file. */
static enum gz_result write_labels(const struct gz_scene *scene, const char *path,
				   const struct gz_log *log)
{
	struct gz_mesh_part *parts = NULL;
	size_t count = 0;
	enum gz_result r = gz_mesh_output_parts(scene, log, &parts, &count);
	if (r == GZ_OK)
		r = write_parts(parts, count, path, log);
	free(parts);
	return r;
}

/* ---- a surface ---- */

static enum gz_result write_surface(const struct gz_view_options *options,
				    const struct gz_scene *scene, const struct gz_log *log)
{
	struct gz_mesh mesh;
	const bool given = gz_view_option_given(options, "isovalue");
	if (!given && !gz_scene_draws_by(&scene->settings, &gz_isosurface_technique)) {
		gz_err(log, "--write-mesh: --isovalue is missing; give the data value where the "
			    "surface lies");
		return GZ_ERR_INVAL;
	}
	const double isovalue = given ? options->isovalue : scene->settings.rays.surface.isovalue;
	enum gz_result r =
		gz_mesh_output_make(&scene->volume, isovalue, options->threads, log, &mesh);
	if (r != GZ_OK)
		return r;
	r = gz_mesh_write(&mesh, options->write_mesh, log);
	if (r == GZ_OK)
		print_mesh(options->write_mesh, &mesh, false);
	gz_mesh_free(&mesh);
	return r;
}

enum gz_result gz_view_write_mesh(const struct gz_view_options *options, const struct gz_log *log)
{
	struct gz_scene scene;
	if (!gz_mesh_file_named(options->write_mesh)) {
		gz_err(log, "--write-mesh %s: unknown ending; use " GZ_MESH_ENDINGS,
		       options->write_mesh);
		return GZ_ERR_UNSUPPORTED;
	}
	enum gz_result r = gz_output_check(options, log);
	if (r == GZ_OK)
		r = gz_view_load_volume(options, NULL, log, &scene);
	if (r != GZ_OK)
		return r;
	r = scene.labels ? write_labels(&scene, options->write_mesh, log)
			 : write_surface(options, &scene, log);
	gz_scene_free(&scene);
	return r;
}
