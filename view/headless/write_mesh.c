/* gazeview --write-mesh. */
#include <inttypes.h>
#include <stdio.h>

#include "base/workers.h"
#include "render/mesh/isosurface.h"
#include "render/mesh/mesh_file.h"
#include "render/mesh/mesh_measure.h"
#include "view/capture/output.h"
#include "view/headless/headless.h"

#define GZ_LOG_MODULE "gazeview"

/* What is known about the mesh that was written. An open one encloses no volume. */
static void print_mesh(const char *path, const struct gz_mesh *mesh)
{
	struct gz_mesh_measures measures;
	printf("%s vertices %zu triangles %zu", path, mesh->vertex_count, mesh->triangle_count);
	if (gz_mesh_measure(mesh, &measures) != GZ_OK) {
		putchar('\n');
		return;
	}
	printf(" area %.6g mm2 volume ", measures.area);
	if (gz_mesh_closed(&measures))
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

enum gz_result gz_view_write_mesh(const struct gz_view_options *options, const struct gz_log *log)
{
	struct gz_scene scene;
	struct gz_mesh mesh;
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
	r = make_mesh(options, &scene.volume, log, &mesh);
	if (r == GZ_OK) {
		r = gz_mesh_write(&mesh, options->write_mesh, log);
		if (r == GZ_OK)
			print_mesh(options->write_mesh, &mesh);
		gz_mesh_free(&mesh);
	}
	gz_scene_free(&scene);
	return r;
}
