#include "render/opengl/gl_device.h"

#include <stdio.h>
#include <string.h>
#include <strings.h>
#include <unistd.h>

#include <GL/glew.h>

#include "base/clock.h"

/* Names that processors doing a GPU's work go by. */
static bool is_software(const char *renderer)
{
	static const char *const names[] = { "llvmpipe", "softpipe", "swrast",
					     "Software Rasterizer", "SwiftShader" };
	for (size_t i = 0; i < sizeof names / sizeof names[0]; i++)
		if (strstr(renderer, names[i]))
			return true;
	return false;
}

static int64_t limit_of(GLenum name)
{
	GLint64 value = 0;
	glGetInteger64v(name, &value);
	return value;
}

/* What the driver says is free, bytes; 0 where it says nothing. Both extensions count in KiB. */
static int64_t free_memory(void)
{
	GLint kib[4] = { 0 };
	if (GLEW_NVX_gpu_memory_info)
		glGetIntegerv(GL_GPU_MEMORY_INFO_CURRENT_AVAILABLE_VIDMEM_NVX, kib);
	else if (GLEW_ATI_meminfo)
		glGetIntegerv(GL_TEXTURE_FREE_MEMORY_ATI, kib);
	return (int64_t)kib[0] * 1024;
}

static void find_memory(struct gz_gl_device *device)
{
	const long pages = sysconf(_SC_PHYS_PAGES), page = sysconf(_SC_PAGESIZE);
	const int64_t told = device->software ? 0 : free_memory();
	device->memory_told = told > 0;
	device->memory_max = told / 4 * 3;
	if (told <= 0)
		device->memory_max =
			pages > 0 && page > 0 ? (int64_t)pages / 4 * page : (int64_t)1 << 30;
}

enum gz_result gz_gl_device_open(struct gz_gl_device *out_device, char *reason, size_t size)
{
	struct gz_gl_device device = { 0 };
	glewExperimental = GL_TRUE; /* core profiles hide the old extension list */
	const GLenum failure = glewInit();
	/* Without an X display GLEW misses GLX after it has loaded all of OpenGL. */
	if (failure != GLEW_OK && failure != GLEW_ERROR_NO_GLX_DISPLAY) {
		snprintf(reason, size, "%s", (const char *)glewGetErrorString(failure));
		return GZ_ERR_UNSUPPORTED;
	}
	const char *renderer = (const char *)glGetString(GL_RENDERER);
	GLint major = 0, minor = 0;
	glGetIntegerv(GL_MAJOR_VERSION, &major);
	glGetIntegerv(GL_MINOR_VERSION, &minor);
	renderer = renderer ? renderer : "unknown";
	if (major < 4 || (major == 4 && minor < 3)) {
		snprintf(reason, size, "%.100s has OpenGL %d.%d, not 4.3", renderer, major, minor);
		return GZ_ERR_UNSUPPORTED;
	}
	snprintf(device.description, sizeof device.description, "gl: %.120s, %d.%d", renderer,
		 major, minor);
	device.software = is_software(renderer);
	device.tells_loss = GLEW_ARB_robustness && glGetGraphicsResetStatusARB;
	device.texture_edge_max = (int)limit_of(GL_MAX_3D_TEXTURE_SIZE);
	device.volume_edge_max = device.texture_edge_max;
	device.storage_max = limit_of(GL_MAX_SHADER_STORAGE_BLOCK_SIZE);
	find_memory(&device);
	GLint groups =
		65535; /* the least that OpenGL 4.3 allows; stays where the context is lost */
	glGetIntegeri_v(GL_MAX_COMPUTE_WORK_GROUP_COUNT, 0, &groups);
	device.groups_max = groups;
	while (glGetError() != GL_NO_ERROR) /* of GLEW's questions */
		;
	*out_device = device;
	return GZ_OK;
}

unsigned gz_gl_texture(unsigned target)
{
	GLuint texture = 0;
	glGenTextures(1, &texture);
	glBindTexture(target, texture);
	glTexParameteri(target, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
	glTexParameteri(target, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
	glTexParameteri(target, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
	glTexParameteri(target, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
	glTexParameteri(target, GL_TEXTURE_WRAP_R, GL_CLAMP_TO_EDGE);
	return texture;
}

enum gz_result gz_gl_device_errors(const struct gz_gl_device *device)
{
	enum gz_result result = GZ_OK;
	if (device->tells_loss && glGetGraphicsResetStatusARB() != GL_NO_ERROR)
		return GZ_ERR_NO_DEVICE;
	/* A lost context may report errors for ever: look at a few. */
	for (int i = 0; i < 16; i++) {
		const GLenum error = glGetError();
		if (error == GL_NO_ERROR)
			return result;
		if (error == GL_CONTEXT_LOST)
			return GZ_ERR_NO_DEVICE;
		if (error == GL_OUT_OF_MEMORY)
			result = GZ_ERR_NO_MEM;
		else if (result == GZ_OK)
			result = GZ_ERR_UNSUPPORTED;
	}
	return GZ_ERR_NO_DEVICE;
}

void gz_gl_buffer_reserve(struct gz_gl_buffer *buffer, size_t size, unsigned usage)
{
	if (!buffer->name)
		glGenBuffers(1, &buffer->name);
	if (size <= buffer->size)
		return;
	glBindBuffer(GL_SHADER_STORAGE_BUFFER, buffer->name);
	glBufferData(GL_SHADER_STORAGE_BUFFER, (GLsizeiptr)size, NULL, usage);
	buffer->size = size;
}

void *gz_gl_buffer_map_new(struct gz_gl_buffer *buffer, size_t size)
{
	gz_gl_buffer_reserve(buffer, size, GL_STATIC_DRAW); /* many frames may read it */
	glBindBuffer(GL_SHADER_STORAGE_BUFFER, buffer->name);
	void *memory = glMapBufferRange(GL_SHADER_STORAGE_BUFFER, 0, (GLsizeiptr)size,
					GL_MAP_WRITE_BIT | GL_MAP_INVALIDATE_BUFFER_BIT);
	if (!memory)
		buffer->size = 0;
	return memory;
}

void gz_gl_buffer_bring(const struct gz_gl_device *device, const struct gz_gl_buffer *source,
			size_t bytes, struct gz_gl_buffer *staging)
{
	if (!device->software) {
		gz_gl_buffer_reserve(staging, bytes, GL_STREAM_READ);
		glBindBuffer(GL_COPY_READ_BUFFER, source->name);
		glBindBuffer(GL_COPY_WRITE_BUFFER, staging->name);
		glCopyBufferSubData(GL_COPY_READ_BUFFER, GL_COPY_WRITE_BUFFER, 0, 0,
				    (GLsizeiptr)bytes);
		source = staging;
	}
	glBindBuffer(GL_COPY_READ_BUFFER, source->name);
}

void gz_gl_buffer_free(struct gz_gl_buffer *buffer)
{
	if (buffer->name)
		glDeleteBuffers(1, &buffer->name);
	*buffer = (struct gz_gl_buffer) { 0 };
}

void gz_gl_timer_mark(struct gz_gl_timer *timer, const struct gz_gl_device *device, int mark)
{
	if (device->software) {
		glFinish();
		timer->marks_ns[mark] = gz_clock_now_ns();
		return;
	}
	if (!timer->queries[0])
		glGenQueries(GZ_GL_MARKS_MAX, timer->queries);
	glQueryCounter(timer->queries[mark], GL_TIMESTAMP);
}

static int64_t mark_ns(const struct gz_gl_timer *timer, const struct gz_gl_device *device, int mark)
{
	GLint64 ns = 0;
	if (device->software)
		return timer->marks_ns[mark];
	glGetQueryObjecti64v(timer->queries[mark], GL_QUERY_RESULT, &ns);
	return ns;
}

double gz_gl_timer_ms(const struct gz_gl_timer *timer, const struct gz_gl_device *device, int from,
		      int to)
{
	return gz_ns_to_ms(mark_ns(timer, device, to) - mark_ns(timer, device, from));
}

void gz_gl_timer_free(struct gz_gl_timer *timer)
{
	if (timer->queries[0])
		glDeleteQueries(GZ_GL_MARKS_MAX, timer->queries);
	*timer = (struct gz_gl_timer) { 0 };
}
