/**
 * @file
 * What the OpenGL of a context can do, what has gone wrong in it, its buffers, and when it was
 * done. All calls need the context current.
 */
#ifndef GZ_RENDER_OPENGL_GL_DEVICE_H
#define GZ_RENDER_OPENGL_GL_DEVICE_H

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

/** A buffer of the device; zero-initialised is none. */
struct gz_gl_buffer {
	unsigned name; /**< OpenGL's */
	size_t size;   /**< bytes */
};

/** Make room for @p size bytes. What was there is lost if it grows. @p usage is one of OpenGL's.
 * What goes wrong shows in gz_gl_device_errors(). */
void gz_gl_buffer_reserve(struct gz_gl_buffer *buffer, size_t size, unsigned usage);

/** Memory to write @p size bytes of the device's own into, until
 *  glUnmapBuffer(GL_SHADER_STORAGE_BUFFER). What was there is lost, and commands that still read it
 *  keep theirs. NULL where the device has no room; the buffer is empty then. */
void *gz_gl_buffer_map_new(struct gz_gl_buffer *buffer, size_t size);

/** Bind the first @p bytes of @p source to GL_COPY_READ_BUFFER where the host reads them quickly:
 *  copied to @p staging by a graphics device; a processor's buffers are in its memory already. */
void gz_gl_buffer_bring(const struct gz_gl_device *device, const struct gz_gl_buffer *source,
			size_t bytes, struct gz_gl_buffer *staging);

/** Delete and zero. Accepts a zeroed one. */
void gz_gl_buffer_free(struct gz_gl_buffer *buffer);

/** Most marks of a frame. */
#define GZ_GL_MARKS_MAX 3

/** Zero-initialised has no marks. */
struct gz_gl_timer {
	unsigned queries[GZ_GL_MARKS_MAX]; /**< 0: none made yet */
	int64_t marks_ns[GZ_GL_MARKS_MAX]; /**< software */
};

/** Mark the moment at which all commands so far are done. Where a processor does the work, whose
 *  timestamps tell when commands were taken and not when they were done, it waits for them. */
void gz_gl_timer_mark(struct gz_gl_timer *timer, const struct gz_gl_device *device, int mark);

/** Milliseconds from mark @p from to mark @p to; waits until the device has passed both. */
double gz_gl_timer_ms(const struct gz_gl_timer *timer, const struct gz_gl_device *device, int from,
		      int to);

/** Delete the queries and zero the struct. */
void gz_gl_timer_free(struct gz_gl_timer *timer);

#endif
