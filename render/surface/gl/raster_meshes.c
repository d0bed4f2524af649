#include "render/surface/gl/raster_meshes.h"

#include <math.h>
#include <stdlib.h>

#include <GL/glew.h>

#include "render/mesh/mesh_read.h"

#define GZ_LOG_MODULE "isosurface"

enum { POSITIONS, BESIDE, TRIANGLES, BUFFERS };

static const struct gz_raster_field normal_field = { GZ_RASTER_NORMAL, 3, GL_FLOAT, 0 };

/* What vertices are beside their positions unless the caller has something else. */
static const struct gz_raster_vertices plain_vertices = { &normal_field, 1, sizeof(float[3]),
							  NULL };

static size_t triangle_bytes(const struct gz_mesh *mesh)
{
	return mesh->triangle_count * sizeof mesh->triangles[0];
}

static size_t mesh_bytes(const struct gz_mesh *mesh, const struct gz_raster_vertices *vertices)
{
	return mesh->vertex_count * (sizeof mesh->positions[0] + vertices->stride) +
	       triangle_bytes(mesh);
}

static void upload_buffer(GLenum kind, unsigned buffer, size_t bytes, const void *data)
{
	glBindBuffer(kind, buffer);
	glBufferData(kind, (GLsizeiptr)bytes, data, GL_STATIC_DRAW);
}

static void point_to_field(const struct gz_raster_field *field, size_t stride)
{
	glVertexAttribPointer(field->location, field->components, field->type, GL_TRUE,
			      (GLsizei)stride, (const void *)field->offset);
	glEnableVertexAttribArray(field->location);
}

/* Make the clusters of a mesh, and its triangles in their order: the caller's. NULL: no memory. */
static uint32_t (*sort_into_clusters(const struct gz_mesh *mesh, struct gz_raster_mesh *item))[3]
{
	uint32_t(*triangles)[3] = malloc(triangle_bytes(mesh));
	if (!triangles)
		return NULL;
	if (gz_raster_clusters_make(mesh, triangles, &item->clusters) == GZ_OK) {
		const size_t count = item->clusters.count;
		item->runs = malloc(count * sizeof *item->runs);
		item->run_corners = malloc(count * sizeof *item->run_corners);
		item->run_offsets = malloc(count * sizeof *item->run_offsets);
		if (item->runs && item->run_corners && item->run_offsets)
			return triangles;
	}
	free(triangles);
	return NULL;
}

/* GZ_ERR_NO_MEM: no memory on the host. */
static enum gz_result upload_mesh(struct gz_raster_mesh *item, const struct gz_mesh *mesh,
				  const struct gz_raster_vertices *vertices, const void *beside)
{
	static const struct gz_raster_field position = { GZ_RASTER_POSITION, 3, GL_FLOAT, 0 };
	if (mesh->triangle_count == 0)
		return GZ_OK;
	uint32_t(*triangles)[3] = sort_into_clusters(mesh, item);
	if (!triangles)
		return GZ_ERR_NO_MEM;
	glGenVertexArrays(1, &item->vertices);
	glGenBuffers(BUFFERS, item->buffers);
	glBindVertexArray(item->vertices);
	upload_buffer(GL_ARRAY_BUFFER, item->buffers[POSITIONS],
		      mesh->vertex_count * sizeof mesh->positions[0], mesh->positions);
	point_to_field(&position, sizeof mesh->positions[0]);
	upload_buffer(GL_ARRAY_BUFFER, item->buffers[BESIDE], mesh->vertex_count * vertices->stride,
		      beside);
	for (int i = 0; i < vertices->count; i++)
		point_to_field(&vertices->fields[i], vertices->stride);
	upload_buffer(GL_ELEMENT_ARRAY_BUFFER, item->buffers[TRIANGLES], triangle_bytes(mesh),
		      triangles);
	glBindVertexArray(0);
	glBindBuffer(GL_ARRAY_BUFFER, 0);
	item->corners = (int)(3 * mesh->triangle_count);
	free(triangles);
	return GZ_OK;
}

/* The box around the vertices of a mesh. Those of no triangle, which files may have, count too. */
static struct gz_raster_box find_box(const struct gz_mesh *mesh)
{
	struct gz_raster_box box = { { INFINITY, INFINITY, INFINITY },
				     { -INFINITY, -INFINITY, -INFINITY } };
	gz_mesh_bound(mesh, box.least, box.greatest);
	return box;
}

static void join_box(const struct gz_raster_box *more, struct gz_raster_box *box)
{
	for (int axis = 0; axis < 3; axis++) {
		box->least[axis] = fmin(box->least[axis], more->least[axis]);
		box->greatest[axis] = fmax(box->greatest[axis], more->greatest[axis]);
	}
}

static enum gz_result check_room(const struct gz_gl_device *device,
				 const struct gz_surface_meshes *listed,
				 const struct gz_raster_vertices *vertices,
				 const struct gz_log *log)
{
	size_t bytes = 0;
	for (size_t i = 0; i < listed->count; i++)
		bytes += mesh_bytes(&listed->shown[i], vertices);
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
				       const struct gz_raster_vertices *vertices,
				       const struct gz_log *log)
{
	gz_raster_meshes_free(meshes);
	if (!vertices)
		vertices = &plain_vertices;
	enum gz_result result = check_room(device, listed, vertices, log);
	if (result != GZ_OK)
		return result;
	meshes->items = calloc(listed->count, sizeof *meshes->items);
	if (!meshes->items)
		return GZ_ERR_NO_MEM;
	meshes->count = listed->count;
	for (size_t i = 0; i < listed->count && result == GZ_OK; i++) {
		meshes->items[i].id = listed->items[i].object.id;
		meshes->items[i].box = find_box(&listed->shown[i]);
		result = upload_mesh(&meshes->items[i], &listed->shown[i], vertices,
				     vertices->data ? vertices->data[i] : listed->shown[i].normals);
	}
	if (result == GZ_OK)
		result = gz_gl_device_errors(device);
	if (result != GZ_OK) {
		gz_err(log,
		       "the graphics device does not take %zu triangles: %s; take --backend cpu",
		       gz_surface_meshes_triangles(listed), gz_result_text(result));
		gz_raster_meshes_free(meshes);
		return result;
	}
	meshes->box = meshes->items[0].box;
	for (size_t i = 1; i < meshes->count; i++)
		join_box(&meshes->items[i].box, &meshes->box);
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

/* Draw what a lattice may show of the clusters [from, to). */
static void draw_clusters(const struct gz_raster_mesh *mesh, size_t from, size_t to,
			  const struct gz_raster_view *view, const struct gz_raster_layer *lattice)
{
	const size_t count =
		gz_raster_clusters_choose(&mesh->clusters, from, to, view, lattice, mesh->runs);
	for (size_t i = 0; i < count; i++) {
		mesh->run_corners[i] = (int)mesh->runs[i].corners;
		mesh->run_offsets[i] = (const void *)(mesh->runs[i].first * sizeof(uint32_t));
	}
	if (count > 0)
		glMultiDrawElements(GL_TRIANGLES, mesh->run_corners, GL_UNSIGNED_INT,
				    (const GLvoid *const *)mesh->run_offsets, (GLsizei)count);
}

/* Row 0 is on top, so the picture is mirrored for OpenGL: fronts are clockwise. */
static void draw_shared(const struct gz_raster_mesh *mesh, const struct gz_raster_view *view,
			const struct gz_raster_layer *lattice)
{
	const struct gz_raster_clusters *clusters = &mesh->clusters;
	if (clusters->own_count == clusters->count)
		return;
	glEnable(GL_CULL_FACE);
	glFrontFace(GL_CW);
	draw_clusters(mesh, clusters->own_count, clusters->count, view, lattice);
	glFrontFace(GL_CCW);
	glDisable(GL_CULL_FACE);
}

bool gz_raster_mesh_in_view(const struct gz_raster_mesh *mesh, const struct gz_raster_view *view,
			    const struct gz_raster_layer *lattice)
{
	double from[2], to[2];
	for (int axis = 0; axis < 2; axis++) {
		from[axis] = lattice->from[axis] - lattice->spacing;
		to[axis] = lattice->from[axis] + (double)lattice->points[axis] * lattice->spacing;
	}
	return mesh->vertices && gz_raster_view_shows(view, &mesh->box, from, to);
}

void gz_raster_mesh_draw_seen(const struct gz_raster_mesh *mesh, const struct gz_raster_view *view,
			      const struct gz_raster_layer *lattice)
{
	glBindVertexArray(mesh->vertices);
	draw_clusters(mesh, 0, mesh->clusters.own_count, view, lattice);
	draw_shared(mesh, view, lattice);
}

void gz_raster_meshes_draw_seen(const struct gz_raster_meshes *meshes,
				const struct gz_surface_meshes *listed,
				const struct gz_surface_look *look,
				const struct gz_raster_view *view,
				const struct gz_raster_layer *lattice,
				struct gz_raster_locations locations)
{
	for (size_t i = 0; i < meshes->count; i++) {
		const struct gz_raster_mesh *mesh = &meshes->items[i];
		float colour[3];
		if (!gz_raster_mesh_in_view(mesh, view, lattice))
			continue;
		gz_surface_colour(&listed->items[i], look, colour);
		glUniform1ui(locations.id, mesh->id);
		glUniform3fv(locations.colour, 1, colour);
		gz_raster_mesh_draw_seen(mesh, view, lattice);
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
	for (size_t i = 0; i < meshes->count; i++) {
		gz_raster_clusters_free(&meshes->items[i].clusters);
		free(meshes->items[i].runs);
		free(meshes->items[i].run_corners);
		free(meshes->items[i].run_offsets);
	}
	free(meshes->items);
	*meshes = (struct gz_raster_meshes) { .serial = meshes->serial };
}
