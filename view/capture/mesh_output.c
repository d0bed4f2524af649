#include "view/capture/mesh_output.h"

#include <stdlib.h>
#include <string.h>

#include "base/workers.h"
#include "render/mesh/isosurface.h"

#define GZ_LOG_MODULE "gazeview"

enum gz_result gz_mesh_output_make(const struct gz_volume *volume, double isovalue, int threads,
				   const struct gz_log *log, struct gz_mesh *out_mesh)
{
	const struct gz_isosurface_request request = { .volume = volume, .isovalue = isovalue };
	struct gz_workers *workers = NULL;
	/* Without further threads the calling one does all. */
	(void)gz_workers_create(threads, &workers);
	const enum gz_result r = gz_isosurface_make(&request, workers, log, out_mesh);
	gz_workers_destroy(&workers);
	return r;
}

static size_t count_labels(const struct gz_scene *scene)
{
	size_t count = 0;
	for (size_t i = 0; scene->labels && i < scene->settings.objects.count; i++)
		count += scene->labels[i].count;
	return count;
}

enum gz_result gz_mesh_output_parts(const struct gz_scene *scene, const struct gz_log *log,
				    struct gz_mesh_part **out_parts, size_t *out_count)
{
	size_t count = 0;
	struct gz_mesh_part *parts = calloc(count_labels(scene) + 1, sizeof *parts);
	if (!parts) {
		gz_err(log, "no memory for the scene's labels");
		return GZ_ERR_NO_MEM;
	}
	for (size_t i = 0; scene->labels && i < scene->settings.objects.count; i++)
		for (size_t k = 0; k < scene->labels[i].count; k++) {
			const struct gz_label_surface *label = &scene->labels[i].items[k];
			struct gz_mesh_part *part = &parts[count++];
			part->mesh = &label->mesh;
			part->label = label->number;
			memcpy(part->colour, label->colour, sizeof part->colour);
		}
	*out_parts = parts;
	*out_count = count;
	return GZ_OK;
}
