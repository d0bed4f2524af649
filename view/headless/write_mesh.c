/* gazeview --write-mesh. */
#include <inttypes.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/workers.h"
#include "render/mesh/isosurface.h"
#include "render/mesh/mesh_file.h"
#include "render/mesh/mesh_measure.h"
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

static enum gz_result make_mesh(const struct gz_view_options *options,
				const struct gz_volume *volume, const struct gz_log *log,
				struct gz_mesh *out_mesh)
{
	const struct gz_isosurface_request request = {
		.volume = volume,
		.isovalue = options->isovalue,
	};
	struct gz_workers *workers = NULL;
	/* Without further threads the calling one does all. */
	(void)gz_workers_create(options->threads, &workers);
	const enum gz_result r = gz_isosurface_make(&request, workers, log, out_mesh);
	gz_workers_destroy(&workers);
	return r;
}

/* ---- labels ---- */

static size_t count_labels(const struct gz_scene *scene)
{
	size_t count = 0;
	for (size_t i = 0; scene->labels && i < scene->settings.objects.count; i++)
		count += scene->labels[i].count;
	return count;
}

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
	size_t count = 0;
	struct gz_mesh_part *parts = calloc(count_labels(scene) + 1, sizeof *parts);
	if (!parts) {
		gz_err(log, "%s: no memory for its labels", path);
		return GZ_ERR_NO_MEM;
	}
	for (size_t i = 0; i < scene->settings.objects.count; i++)
		for (size_t k = 0; k < scene->labels[i].count; k++) {
			const struct gz_label_surface *label = &scene->labels[i].items[k];
			struct gz_mesh_part *part = &parts[count++];
			part->mesh = &label->mesh;
			part->label = label->number;
			memcpy(part->colour, label->colour, sizeof part->colour);
		}
	const enum gz_result r = write_parts(parts, count, path, log);
	free(parts);
	return r;
}

/* ---- a surface ---- */

static enum gz_result write_surface(const struct gz_view_options *options,
				    const struct gz_scene *scene, const struct gz_log *log)
{
	struct gz_mesh mesh;
	if (!gz_view_option_given(options, "isovalue")) {
		gz_err(log, "--write-mesh: --isovalue is missing; give the data value where the "
			    "surface lies");
		return GZ_ERR_INVAL;
	}
	enum gz_result r = make_mesh(options, &scene->volume, log, &mesh);
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
