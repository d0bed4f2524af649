/**
 * @file
 * What the OpenGL of a context can do, and what has gone wrong in it. All calls need it current.
 */
#ifndef GZ_RENDER_GL_GL_DEVICE_H
#define GZ_RENDER_GL_GL_DEVICE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/result.h"

/** Limits and names of an OpenGL implementation. */
struct gz_gl_device {
	char description[160]; /**< "gl: llvmpipe (LLVM 15.0.6, 256 bits), 4.5" */
	bool software;         /**< a processor does the work */
	bool tells_loss;       /**< the driver says when the context is lost */
	int texture_edge_max;  /**< of a 3D texture, texels */
	int volume_edge_max;   /**< of one with voxels: that, or what a test sets it to */
	int64_t storage_max;   /**< of a storage buffer, bytes */
	/** Bytes that voxels may take: three quarters of what the driver says is free; where it
	 *  says nothing, a quarter of the machine's memory, since such a GPU mostly shares it. */
	int64_t memory_max;
	bool memory_told; /**< the driver said, so more need not be tried */
	int groups_max;   /**< work-groups of one dispatch along x */
};

/**
 * Load OpenGL's entry points and ask for what is needed.
 *
 * @param[out] reason  why it will not do: one phrase, cut to @p size; written on failure
 * @retval GZ_ERR_UNSUPPORTED  less than OpenGL 4.3
 *
 * GLEW's pointers are the process's: contexts of different drivers in one process need libglvnd,
 * which both distributions have.
 */
enum gz_result gz_gl_device_open(struct gz_gl_device *out_device, char *reason, size_t size);

/** A texture without filtering or levels, bound to @p target, one of OpenGL's. */
unsigned gz_gl_texture(unsigned target);

/** What went wrong since the last call: GZ_OK; GZ_ERR_NO_MEM; GZ_ERR_NO_DEVICE where the context is
 * lost; GZ_ERR_UNSUPPORTED for any other error of OpenGL, of which there should be none. */
enum gz_result gz_gl_device_errors(const struct gz_gl_device *device);

#endif
