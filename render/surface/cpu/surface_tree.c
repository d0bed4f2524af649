#include "render/surface/cpu/surface_tree.h"

#include <stdio.h>

#define GZ_LOG_MODULE "isosurface"

static bool count_bytes(void *user, ssize_t bytes, bool post)
{
	struct gz_surface_tree *tree = user;
	(void)post;
	tree->bytes += bytes;
	return true;
}

enum gz_result gz_surface_tree_open(struct gz_surface_tree *tree, const char *isa,
				    const struct gz_log *log)
{
	char configuration[64];
	snprintf(configuration, sizeof configuration, "threads=1,isa=%s", isa);
	*tree = (struct gz_surface_tree) { .log = log };
	tree->device = rtcNewDevice(configuration);
	if (!tree->device) {
		gz_err(log, "Embree does not start with %s (error %d); try another --simd", isa,
		       (int)rtcGetDeviceError(NULL));
		return GZ_ERR_UNSUPPORTED;
	}
	rtcSetDeviceMemoryMonitorFunction(tree->device, count_bytes, tree);
	return GZ_OK;
}

static void drop_scene(struct gz_surface_tree *tree)
{
	if (tree->scene)
		rtcReleaseScene(tree->scene);
	tree->scene = NULL;
}

/* The arrays of a mesh have the padding that Embree asks for. */
static void attach_mesh(struct gz_surface_tree *tree, const struct gz_mesh *mesh, unsigned number)
{
	RTCGeometry geometry = rtcNewGeometry(tree->device, RTC_GEOMETRY_TYPE_TRIANGLE);
	if (!geometry)
		return;
	rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
				   mesh->positions, 0, sizeof mesh->positions[0],
				   mesh->vertex_count);
	rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
				   mesh->triangles, 0, sizeof mesh->triangles[0],
				   mesh->triangle_count);
	rtcCommitGeometry(geometry);
	rtcAttachGeometryByID(tree->scene, geometry, number);
	rtcReleaseGeometry(geometry);
}

enum gz_result gz_surface_tree_build(struct gz_surface_tree *tree, const struct gz_mesh meshes[],
				     size_t count)
{
	drop_scene(tree);
	(void)rtcGetDeviceError(tree->device); /* forgets an earlier one */
	tree->scene = rtcNewScene(tree->device);
	if (tree->scene) {
		for (size_t i = 0; i < count; i++)
			if (meshes[i].triangle_count > 0)
				attach_mesh(tree, &meshes[i], (unsigned)i);
		rtcCommitScene(tree->scene);
	}
	const enum RTCError error = rtcGetDeviceError(tree->device);
	if (tree->scene && error == RTC_ERROR_NONE)
		return GZ_OK;
	gz_err(tree->log,
	       "Embree cannot build the tree of triangles (error %d); close other "
	       "programs, or show less",
	       (int)error);
	drop_scene(tree);
	return GZ_ERR_NO_MEM;
}

void gz_surface_tree_close(struct gz_surface_tree *tree)
{
	drop_scene(tree);
	if (tree->device)
		rtcReleaseDevice(tree->device);
	*tree = (struct gz_surface_tree) { 0 };
}
