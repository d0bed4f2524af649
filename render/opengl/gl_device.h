/**
 * @file
 * Setting up OpenGL for a backend: a context (a window's or one without a window), what its device
 * can do, the device's buffers and textures, and timers. Every backend that draws on a graphics
 * device starts with gz_gl_device_create().
 *
 * Except where noted, the device's context must be current (gz_gl_device_enter()).
 */
#ifndef GZ_RENDER_OPENGL_GL_DEVICE_H
#define GZ_RENDER_OPENGL_GL_DEVICE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/log.h"
#include "base/result.h"

struct gz_gl_context;

/** What a context must provide. Every table is const and has static storage. */
struct gz_gl_context_ops {
	/** Make the context current on the calling thread, where it may be already.
	 *  GZ_ERR_NO_DEVICE: the context is lost. */
	enum gz_result (*make_current)(struct gz_gl_context *context);
	/** A backend's call ends. A context without a window leaves the thread, so that the next
	 *  call may come from another thread. A window's context stays: its window draws next. */
	void (*release)(struct gz_gl_context *context);
	/** Optional. Free the context, which is current nowhere. */
	void (*destroy)(struct gz_gl_context *context);
};

/**
 * Common head of every context. Its maker destroys it, after all backends that use it.
 *
 * A program with a window lends the window's own context, because a thread has at most one current
 * context and EGL and GLX do not share one. The picture then is a texture that the window draws
 * without a copy.
 */
struct gz_gl_context {
	const struct gz_gl_context_ops *ops;
};

/**
 * Make a core context of OpenGL 4.3 or later without a window: on the first GPU that EGL lists
 * (EGL_EXT_platform_device, which NVIDIA's and Mesa's drivers have), else on Mesa's software
 * (EGL_MESA_platform_surfaceless).
 *
 * @param hardware_only     refuse software renderers before they are loaded
 * @param[out] out_context  owned by the caller: gz_gl_context_destroy(); current nowhere
 * @param[out] reason       on failure: one phrase, cut to @p size
 * @retval GZ_ERR_NO_DEVICE    no EGL, or no device that EGL can use
 * @retval GZ_ERR_UNSUPPORTED  a device, but with less than OpenGL 4.3
 * @retval GZ_ERR_NO_MEM       out of memory
 *
 * EGL's displays are initialised once a process and never terminated, since other contexts may use
 * them. Threads: any.
 */
enum gz_result gz_gl_context_egl(bool hardware_only, struct gz_gl_context **out_context,
				 char *reason, size_t size);

/** Destroy @p *context and set it to NULL. Accepts a pointer to NULL. */
void gz_gl_context_destroy(struct gz_gl_context **context);

/** A context and what its OpenGL can do. Zero-initialised is none. */
struct gz_gl_device {
	struct gz_gl_context *context;
	struct gz_gl_context
		*own_context;  /**< @p context if the device made it; NULL if it is lent */
	char description[160]; /**< "gl: llvmpipe (LLVM 15.0.6, 256 bits), 4.5" */
	bool software;         /**< a processor does the device's work */
	bool reports_loss;     /**< the driver reports a lost context */
	int texture_edge_max;  /**< longest edge of a 3D texture, texels */
	int volume_edge_max;   /**< longest edge of a volume in one texture; a test may lower it */
	int64_t storage_max;   /**< largest storage buffer, bytes */
	/** Most bytes for voxels: three quarters of the free memory that the driver reports;
	 * without such a report a quarter of the machine's memory, which such a GPU mostly shares.
	 */
	int64_t memory_max;
	bool memory_known; /**< @p memory_max is no guess, so more is not tried */
	int groups_max;    /**< work-groups of one dispatch along x */
};

/** Which context a backend wants. */
struct gz_gl_setup {
	struct gz_gl_context *lent; /**< borrowed, outlives the device; NULL = one made by EGL */
	bool hardware_only;         /**< refuse OpenGL whose work a processor does */
	size_t memory_bytes;        /**< most memory for voxels; 0 = what the driver has */
};

/**
 * Get a context, load OpenGL's entry points and find the device's limits. The context is current
 * nowhere before and after.
 *
 * @param[out] out_device  written only on success; gz_gl_device_destroy() ends it
 * @retval GZ_ERR_NO_DEVICE    no device, or the lent context is lost
 * @retval GZ_ERR_UNSUPPORTED  less than OpenGL 4.3, or software where hardware is wanted
 * @retval GZ_ERR_NO_MEM       out of memory
 *
 * Failures are logged: as errors, or where only hardware would do as debug messages, since such a
 * caller tries and falls back. GLEW's pointers belong to the process: contexts of different drivers
 * in one process need libglvnd, which both supported distributions have. Once those of 4.3 are
 * loaded they stay, so that any thread may call this while another one draws.
 */
enum gz_result gz_gl_device_create(const struct gz_gl_setup *setup, const struct gz_log *log,
				   struct gz_gl_device *out_device);

/** Make the context current until gz_gl_device_leave(). GZ_ERR_NO_DEVICE: it is lost; not logged.
 */
enum gz_result gz_gl_device_enter(const struct gz_gl_device *device);

/** End what gz_gl_device_enter() began. */
void gz_gl_device_leave(const struct gz_gl_device *device);

/** Destroy the context if the device made it, and zero the struct. The context must not be
 *  current. */
void gz_gl_device_destroy(struct gz_gl_device *device);

/** What went wrong since the last call: GZ_OK; GZ_ERR_NO_MEM; GZ_ERR_NO_DEVICE if the context is
 *  lost; GZ_ERR_UNSUPPORTED for any other OpenGL error, none of which is expected. */
enum gz_result gz_gl_device_errors(const struct gz_gl_device *device);

/** Make a texture without filtering or levels and bind it to @p target, one of OpenGL's. */
unsigned gz_gl_texture(unsigned target);

/** A buffer on the device. Zero-initialised is none. */
struct gz_gl_buffer {
	unsigned name; /**< OpenGL's */
	size_t size;   /**< bytes */
};

/** Make room for @p size bytes. The content is lost if the buffer grows. @p usage is one of
 *  OpenGL's. Failures show in gz_gl_device_errors(). */
void gz_gl_buffer_reserve(struct gz_gl_buffer *buffer, size_t size, unsigned usage);

/** Map new device memory of @p size bytes for writing until
 *  glUnmapBuffer(GL_SHADER_STORAGE_BUFFER). The old content is lost, but commands that still read
 *  it keep it. NULL if the device has no room; the buffer is empty then. */
void *gz_gl_buffer_map_new(struct gz_gl_buffer *buffer, size_t size);

/** Bind @p bytes of @p source to GL_COPY_READ_BUFFER in memory that the host reads quickly: a
 *  graphics device copies them to @p staging; a software device's buffer is in host memory already.
 *
 * @param from  the first of these bytes
 * @return where they are in the bound buffer
 */
size_t gz_gl_buffer_bring(const struct gz_gl_device *device, const struct gz_gl_buffer *source,
			  size_t from, size_t bytes, struct gz_gl_buffer *staging);

/** Delete and zero. Accepts a zeroed one. */
void gz_gl_buffer_free(struct gz_gl_buffer *buffer);

/** Most marks of a frame. */
#define GZ_GL_MARKS_MAX 3

/** Moments of a frame. Zero-initialised has no marks. */
struct gz_gl_timer {
	unsigned queries[GZ_GL_MARKS_MAX]; /**< 0: none made yet */
	int64_t marks_ns[GZ_GL_MARKS_MAX]; /**< software only */
};

/** Mark the moment at which all commands so far are done. For software this waits, because its
 *  timestamps say when commands were accepted and not when they were done. */
void gz_gl_timer_mark(struct gz_gl_timer *timer, const struct gz_gl_device *device, int mark);

/** Milliseconds from mark @p from to mark @p to; waits until the device has passed both. */
double gz_gl_timer_ms(const struct gz_gl_timer *timer, const struct gz_gl_device *device, int from,
		      int to);

/** Delete the queries and zero the struct. */
void gz_gl_timer_free(struct gz_gl_timer *timer);

#endif
