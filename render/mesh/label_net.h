/**
 * @file
 * The net of vertices and faces that all labels of a volume share. For label_surfaces.c alone.
 */
#ifndef GZ_RENDER_MESH_LABEL_NET_H
#define GZ_RENDER_MESH_LABEL_NET_H

#include "base/workers.h"
#include "render/mesh/label_index.h"
#include "render/mesh/label_surfaces.h"

/** Stands for no neighbour. */
#define GZ_LABEL_NO_VERTEX UINT32_MAX

/** A face between two voxels. */
struct gz_label_face {
	uint32_t corners[4]; /**< vertices, counter-clockwise seen from the side of labels[1] */
	uint16_t labels[2];  /**< places as in gz_label_index.labels: on the lower side of its
				  axis, and on the upper side */
};

/** A net. Places are in voxels: corner (i, j, k) lies at (i, j, k), from 0 to dims. */
struct gz_label_net {
	size_t vertex_count, face_count;
	int32_t (*corners)[3]; /**< of each vertex: by rising z, then y, then x */
	float (*places)[3];    /**< of each vertex */
	/** Of each vertex, along -x +x -y +y -z +z: those that smoothing draws it to. */
	uint32_t (*neighbours)[6];
	struct gz_label_face *faces;
};

/**
 * Make the net of a volume's labels, unsmoothed.
 *
 * @param elements_max  most vertices, and most faces; at most GZ_MESH_COUNT_MAX
 * @param[out] out_net  written on GZ_OK; gz_label_net_free()
 * @retval GZ_ERR_FULL    more vertices or faces; logged
 * @retval GZ_ERR_NO_MEM  not logged
 */
enum gz_result gz_label_net_make(const struct gz_label_index *index, uint64_t elements_max,
				 struct gz_workers *workers, const struct gz_log *log,
				 struct gz_label_net *out_net);

/** Smooth it as label_surfaces.h describes. Takes 72 bytes more for each vertex meanwhile.
 *  GZ_ERR_NO_MEM: not logged. */
enum gz_result gz_label_net_smooth(struct gz_label_net *net, const int dims[3],
				   const struct gz_label_look *look, struct gz_workers *workers);

/** Free what it holds and zero it. */
void gz_label_net_free(struct gz_label_net *net);

#endif
