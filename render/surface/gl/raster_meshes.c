#include "render/surface/gl/raster_meshes.h"

#include <math.h>
#include <stdlib.h>

#include <GL/glew.h>

#define GZ_LOG_MODULE "isosurface"

enum { POSITIONS, NORMALS, TRIANGLES, BUFFERS };

static size_t vertex_bytes(const struct gz_mesh *mesh)
{
	return mesh->vertex_count * sizeof mesh->positions[0];
}

static size_t triangle_bytes(const struct gz_mesh *mesh)
{
	return mesh->triangle_count * sizeof mesh->triangles[0];
}

static void upload_vertices(unsigned buffer, enum gz_raster_attribute attribute, size_t bytes,
			    const void *vertices)
{
	glBindBuffer(GL_ARRAY_BUFFER, buffer);
	glBufferData(GL_ARRAY_BUFFER, (GLsizeiptr)bytes, vertices, GL_STATIC_DRAW);
	glVertexAttribPointer(attribute, 3, GL_FLOAT, GL_FALSE, 0, NULL);
	glEnableVertexAttribArray(attribute);
}

static void upload_mesh(struct gz_raster_mesh *item, const struct gz_mesh *mesh)
{
	if (mesh->triangle_count == 0)
		return;
	glGenVertexArrays(1, &item->vertices);
	glGenBuffers(BUFFERS, item->buffers);
	glBindVertexArray(item->vertices);
	upload_vertices(item->buffers[POSITIONS], GZ_RASTER_POSITION, vertex_bytes(mesh),
			mesh->positions);
	upload_vertices(item->buffers[NORMALS], GZ_RASTER_NORMAL, vertex_bytes(mesh),
			mesh->normals);
	glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, item->buffers[TRIANGLES]);
	glBufferData(GL_ELEMENT_ARRAY_BUFFER, (GLsizeiptr)triangle_bytes(mesh), mesh->triangles,
		     GL_STATIC_DRAW);
	glBindVertexArray(0);
	glBindBuffer(GL_ARRAY_BUFFER, 0);
	item->corners = (int)(3 * mesh->triangle_count);
	item->own_corners = (int)(3 * (mesh->triangle_count - mesh->shared_count));
}

/* The box around all vertices. Those of no triangle, which files may have, count too. */
static struct gz_raster_box find_box(const struct gz_surface_meshes *listed)
{
	struct gz_raster_box box = { { INFINITY, INFINITY, INFINITY },
				     { -INFINITY, -INFINITY, -INFINITY } };
	for (size_t i = 0; i < listed->count; i++)
		for (size_t k = 0; k < listed->shown[i].vertex_count; k++)
			for (int axis = 0; axis < 3; axis++) {
				const double at = (double)listed->shown[i].positions[k][axis];
				box.least[axis] = at < box.least[axis] ? at : box.least[axis];
				box.greatest[axis] =
					at > box.greatest[axis] ? at : box.greatest[axis];
			}
	return box;
}

static enum gz_result check_room(const struct gz_gl_device *device,
				 const struct gz_surface_meshes *listed, const struct gz_log *log)
{
	size_t bytes = 0;
	for (size_t i = 0; i < listed->count; i++)
		bytes += 2 * vertex_bytes(&listed->shown[i]) + triangle_bytes(&listed->shown[i]);
	if (!device->memory_known || bytes <= (size_t)device->memory_max)
		return GZ_OK;
	gz_err(log,
	       "%zu triangles take %zu bytes of graphics memory, and there are %lld; take "
	       "--backend cpu",
	       gz_surface_meshes_triangles(listed), bytes, (long long)device->memory_max);
	return GZ_ERR_NO_MEM;
}

enum gz_result gz_raster_meshes_upload(struct gz_raster_meshes *meshes,
				       const struct gz_gl_device *device,
				       const struct gz_surface_meshes *listed,
				       const struct gz_log *log)
{
	gz_raster_meshes_free(meshes);
	enum gz_result result = check_room(device, listed, log);
	if (result != GZ_OK)
		return result;
	meshes->items = calloc(listed->count, sizeof *meshes->items);
	if (!meshes->items)
		return GZ_ERR_NO_MEM;
	meshes->count = listed->count;
	for (size_t i = 0; i < listed->count; i++) {
		meshes->items[i].id = listed->items[i].object.id;
		upload_mesh(&meshes->items[i], &listed->shown[i]);
	}
	result = gz_gl_device_errors(device);
	if (result != GZ_OK) {
		gz_err(log,
		       "the graphics device does not take %zu triangles: %s; take --backend cpu",
		       gz_surface_meshes_triangles(listed), gz_result_text(result));
		gz_raster_meshes_free(meshes);
		return result;
	}
	meshes->box = find_box(listed);
	meshes->serial++;
	meshes->uploaded = true;
	return GZ_OK;
}

void gz_raster_meshes_draw(const struct gz_raster_meshes *meshes)
{
	for (size_t i = 0; i < meshes->count; i++) {
		const struct gz_raster_mesh *mesh = &meshes->items[i];
		if (!mesh->vertices)
			continue;
		glBindVertexArray(mesh->vertices);
		glDrawElements(GL_TRIANGLES, mesh->corners, GL_UNSIGNED_INT, NULL);
	}
}

/* Row 0 is on top, so the picture is mirrored for OpenGL: fronts are clockwise. */
static void draw_shared(const struct gz_raster_mesh *mesh)
{
	const size_t first = (size_t)mesh->own_corners * sizeof(uint32_t);
	if (mesh->own_corners == mesh->corners)
		return;
	glEnable(GL_CULL_FACE);
	glFrontFace(GL_CW);
	glDrawElements(GL_TRIANGLES, mesh->corners - mesh->own_corners, GL_UNSIGNED_INT,
		       (const void *)first);
	glFrontFace(GL_CCW);
	glDisable(GL_CULL_FACE);
}

void gz_raster_meshes_draw_seen(const struct gz_raster_meshes *meshes,
				const struct gz_surface_meshes *listed,
				const struct gz_surface_look *look,
				struct gz_raster_locations locations)
{
	for (size_t i = 0; i < meshes->count; i++) {
		const struct gz_raster_mesh *mesh = &meshes->items[i];
		float colour[3];
		if (!mesh->vertices)
			continue;
		gz_surface_colour(&listed->items[i], look, colour);
		glUniform1ui(locations.id, mesh->id);
		glUniform3fv(locations.colour, 1, colour);
		glBindVertexArray(mesh->vertices);
		glDrawElements(GL_TRIANGLES, mesh->own_corners, GL_UNSIGNED_INT, NULL);
		draw_shared(mesh);
	}
}

void gz_raster_meshes_free(struct gz_raster_meshes *meshes)
{
	for (size_t i = 0; i < meshes->count; i++) {
		if (!meshes->items[i].vertices)
			continue;
		glDeleteVertexArrays(1, &meshes->items[i].vertices);
		glDeleteBuffers(BUFFERS, meshes->items[i].buffers);
	}
	gz_raster_meshes_forget(meshes);
}

void gz_raster_meshes_forget(struct gz_raster_meshes *meshes)
{
	free(meshes->items);
	*meshes = (struct gz_raster_meshes) { .serial = meshes->serial };
}
