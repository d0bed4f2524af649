#include "render/surface/cpu/surface_tree.h"

#include <stdint.h>
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

/* Members of Embree's rays and hits of any number of lanes, as the inline functions of rtcore_ray.h
 * count them, which are for C++ alone: each has a word for every lane. */
enum { RAY_DIRECTION = 4, HIT_NORMAL = 0, HIT_TRIANGLE = 5 };

/* Refuse triangles that a neighbour has, too, where they are met from behind: the neighbour's lies
 * at the same place, and which of both a ray meets would be left to chance. Embree calls this for
 * what it has found in a mesh with shared triangles. */
static void refuse_shared_from_behind(const struct RTCFilterFunctionNArguments *arguments)
{
	const uint32_t first_shared = (uint32_t)(uintptr_t)arguments->geometryUserPtr;
	const float *directions = (const float *)arguments->ray;
	const float *normals = (const float *)arguments->hit;
	const uint32_t *triangles = (const uint32_t *)arguments->hit;
	const unsigned lanes = arguments->N;
	for (unsigned i = 0; i < lanes; i++) {
		float along = 0;
		for (unsigned axis = 0; axis < 3; axis++)
			along += directions[(RAY_DIRECTION + axis) * lanes + i] *
				 normals[(HIT_NORMAL + axis) * lanes + i];
		if (along > 0 && triangles[HIT_TRIANGLE * lanes + i] >= first_shared)
			arguments->valid[i] = 0;
	}
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
	if (mesh->shared_count > 0) {
		const size_t first_shared = mesh->triangle_count - mesh->shared_count;
		rtcSetGeometryUserData(geometry, (void *)(uintptr_t)first_shared);
		rtcSetGeometryIntersectFilterFunction(geometry, refuse_shared_from_behind);
	}
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
