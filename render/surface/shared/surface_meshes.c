#include "render/surface/shared/surface_meshes.h"

#include <stdlib.h>

#include "render/mesh/isosurface.h"

#define GZ_LOG_MODULE "isosurface"

void gz_surface_meshes_free(struct gz_surface_meshes *meshes)
{
	for (size_t i = 0; i < meshes->count; i++)
		gz_mesh_free(&meshes->items[i].made);
	free(meshes->items);
	free(meshes->shown);
	*meshes = (struct gz_surface_meshes) { .log = meshes->log,
					       .without_volumes = meshes->without_volumes };
}

static enum gz_result check_surface_object(const struct gz_log *log, const struct gz_object *object)
{
	if (!object->volume) {
		gz_err(log, "isosurface shows volumes and meshes; object %u is neither",
		       (unsigned)object->id);
		return GZ_ERR_UNSUPPORTED;
	}
	if (!object->mesh && object->volume->bricks) {
		gz_err(log, "isosurface does not show volumes stored in bricks; show the "
			    "file that they were made from, or take the technique raycast");
		return GZ_ERR_UNSUPPORTED;
	}
	return GZ_OK;
}

/* The longest edge of a volume's box, mm. */
static double world_mm_of(const struct gz_volume *volume)
{
	double half[3];
	gz_volume_half_extent(volume, half);
	return volume->dims[0] * volume->spacing[0] / (2 * half[0]);
}

/* Take what is already made for the same data from the present list. */
static void take_made(struct gz_surface_meshes *meshes, struct gz_surface_item *item)
{
	for (size_t i = 0; i < meshes->count; i++) {
		struct gz_surface_item *old = &meshes->items[i];
		if (!old->current || old->object.volume != item->object.volume ||
		    old->object.data_revision != item->object.data_revision ||
		    old->object.mesh != item->object.mesh)
			continue;
		const struct gz_object object = item->object;
		*item = *old;
		item->object = object;
		*old = (struct gz_surface_item) { 0 };
		return;
	}
}

enum gz_result gz_surface_meshes_show(struct gz_surface_meshes *meshes,
				      const struct gz_object *objects, size_t count)
{
	enum gz_result result = count > 0 ? GZ_OK : GZ_ERR_INVAL;
	for (size_t i = 0; i < count && result == GZ_OK; i++)
		result = check_surface_object(meshes->log, &objects[i]);
	if (result != GZ_OK)
		return result;
	struct gz_surface_item *items = calloc(count, sizeof *items);
	struct gz_mesh *shown = calloc(count, sizeof *shown);
	if (!items || !shown) {
		free(items);
		free(shown);
		return GZ_ERR_NO_MEM;
	}
	for (size_t i = 0; i < count; i++) {
		items[i].object = objects[i];
		take_made(meshes, &items[i]);
	}
	gz_surface_meshes_free(meshes);
	meshes->items = items;
	meshes->shown = shown;
	meshes->count = count;
	meshes->world_mm = world_mm_of(objects[0].volume);
	return GZ_OK;
}

/* Make the mesh of an object if it is not there. */
static enum gz_result make_surface(struct gz_surface_meshes *meshes, struct gz_surface_item *item,
				   double isovalue, struct gz_workers *workers)
{
	if (item->object.mesh || meshes->without_volumes ||
	    (item->current && item->isovalue == isovalue))
		return GZ_OK;
	const struct gz_isosurface_request request = {
		.volume = item->object.volume,
		.isovalue = isovalue,
	};
	meshes->listed = false;
	item->current = false;
	gz_mesh_free(&item->made);
	const enum gz_result result =
		gz_isosurface_make(&request, workers, meshes->log, &item->made);
	if (result != GZ_OK)
		return result;
	item->isovalue = isovalue;
	item->current = true;
	return GZ_OK;
}

static enum gz_result list_mesh(struct gz_surface_meshes *meshes, size_t index)
{
	const struct gz_surface_item *item = &meshes->items[index];
	static const struct gz_mesh none = { 0 };
	const struct gz_mesh *made = meshes->without_volumes ? &none : &item->made;
	const struct gz_mesh *mesh = item->object.mesh ? item->object.mesh : made;
	if (mesh->vertex_count > GZ_SURFACE_ELEMENTS_MAX ||
	    mesh->triangle_count > GZ_SURFACE_ELEMENTS_MAX) {
		gz_err(meshes->log,
		       "isosurface draws at most %zu vertices and triangles of an object, not %zu "
		       "and %zu; write the mesh to a file instead (gazeview --write-mesh)",
		       GZ_SURFACE_ELEMENTS_MAX, mesh->vertex_count, mesh->triangle_count);
		return GZ_ERR_FULL;
	}
	meshes->shown[index] = *mesh;
	return GZ_OK;
}

enum gz_result gz_surface_meshes_make(struct gz_surface_meshes *meshes, double isovalue,
				      struct gz_workers *workers, bool *out_new)
{
	enum gz_result result = GZ_OK;
	*out_new = false;
	for (size_t i = 0; i < meshes->count && result == GZ_OK; i++)
		result = make_surface(meshes, &meshes->items[i], isovalue, workers);
	if (result != GZ_OK || meshes->listed)
		return result;
	for (size_t i = 0; i < meshes->count && result == GZ_OK; i++)
		result = list_mesh(meshes, i);
	meshes->listed = *out_new = result == GZ_OK;
	return result;
}

void gz_surface_meshes_without_volumes(struct gz_surface_meshes *meshes, bool without)
{
	meshes->listed = meshes->listed && meshes->without_volumes == without;
	meshes->without_volumes = without;
}

static bool made_of_same_data(const struct gz_surface_item *item,
			      const struct gz_surface_item *from)
{
	return from->current && !from->object.mesh && !item->object.mesh &&
	       from->object.volume == item->object.volume &&
	       from->object.data_revision == item->object.data_revision;
}

void gz_surface_meshes_take(struct gz_surface_meshes *meshes, struct gz_surface_meshes *from)
{
	for (size_t i = 0; i < meshes->count && i < from->count; i++) {
		struct gz_surface_item *item = &meshes->items[i], *other = &from->items[i];
		if (!made_of_same_data(item, other))
			continue;
		gz_mesh_free(&item->made);
		item->made = other->made;
		item->isovalue = other->isovalue;
		item->current = true;
		other->made = (struct gz_mesh) { 0 };
		other->current = false;
		meshes->listed = from->listed = false;
	}
}

size_t gz_surface_meshes_bytes(const struct gz_surface_meshes *meshes)
{
	size_t bytes = 0;
	for (size_t i = 0; meshes->listed && i < meshes->count; i++) {
		const struct gz_mesh *made = &meshes->items[i].made;
		bytes +=
			made->vertex_count * (sizeof made->positions[0] + sizeof made->normals[0]) +
			made->triangle_count * sizeof made->triangles[0];
	}
	return bytes;
}

size_t gz_surface_meshes_triangles(const struct gz_surface_meshes *meshes)
{
	size_t triangles = 0;
	for (size_t i = 0; meshes->listed && i < meshes->count; i++)
		triangles += meshes->shown[i].triangle_count;
	return triangles;
}
