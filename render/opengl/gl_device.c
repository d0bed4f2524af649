#include "render/opengl/gl_device.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <GL/glew.h>

#include <EGL/egl.h>
#include <EGL/eglext.h>

#include "base/clock.h"

#define GZ_LOG_MODULE "gl"

/* Most EGL devices that are tried. Chosen: more than a machine has. */
enum { DEVICES_MAX = 32 };

/* Room for the phrase that says why there is no device. */
enum { REASON_SIZE = 200 };

struct egl_context {
	struct gz_gl_context base;
	EGLDisplay display;
	EGLContext context;
};

static enum gz_result egl_make_current(struct gz_gl_context *base)
{
	const struct egl_context *egl = (struct egl_context *)base;
	return eglMakeCurrent(egl->display, EGL_NO_SURFACE, EGL_NO_SURFACE, egl->context)
		       ? GZ_OK
		       : GZ_ERR_NO_DEVICE;
}

static void egl_release(struct gz_gl_context *base)
{
	const struct egl_context *egl = (struct egl_context *)base;
	eglMakeCurrent(egl->display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
}

static void egl_destroy(struct gz_gl_context *base)
{
	struct egl_context *egl = (struct egl_context *)base;
	eglDestroyContext(egl->display, egl->context);
	free(egl);
}

static const struct gz_gl_context_ops egl_ops = {
	.make_current = egl_make_current,
	.release = egl_release,
	.destroy = egl_destroy,
};

/* Whether a space-separated list of extensions, which may be NULL, has this one. */
static bool lists_extension(const char *words, const char *word)
{
	const size_t length = strlen(word);
	for (const char *at = words; at && (at = strstr(at, word)); at += length)
		if ((at == words || at[-1] == ' ') && (at[length] == ' ' || !at[length]))
			return true;
	return false;
}

/* A core context of 4.3, which reports its loss if the driver can. */
static EGLContext make_egl_context(EGLDisplay display)
{
	const EGLint config_wishes[] = { EGL_RENDERABLE_TYPE, EGL_OPENGL_BIT, EGL_SURFACE_TYPE, 0,
					 EGL_NONE };
	EGLConfig config;
	EGLint configs = 0;
	if (!eglBindAPI(EGL_OPENGL_API) ||
	    !eglChooseConfig(display, config_wishes, &config, 1, &configs) || configs < 1)
		return EGL_NO_CONTEXT;
	EGLint wishes[16] = {
		EGL_CONTEXT_MAJOR_VERSION,
		4,
		EGL_CONTEXT_MINOR_VERSION,
		3,
		EGL_CONTEXT_OPENGL_PROFILE_MASK,
		EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT,
		EGL_CONTEXT_OPENGL_RESET_NOTIFICATION_STRATEGY,
		EGL_LOSE_CONTEXT_ON_RESET,
		EGL_NONE,
	};
	EGLContext context = eglCreateContext(display, config, EGL_NO_CONTEXT, wishes);
	if (context == EGL_NO_CONTEXT) {
		wishes[6] = EGL_NONE;
		context = eglCreateContext(display, config, EGL_NO_CONTEXT, wishes);
	}
	return context;
}

/* A search for a context over EGL's displays, and its result. */
struct egl_search {
	EGLDisplay display;
	EGLContext context;
	bool found_display;
};

static bool try_egl_display(struct egl_search *search, EGLenum platform, void *native)
{
	const PFNEGLGETPLATFORMDISPLAYEXTPROC get_display =
		(PFNEGLGETPLATFORMDISPLAYEXTPROC)(void *)eglGetProcAddress(
			"eglGetPlatformDisplayEXT");
	EGLDisplay display = get_display ? get_display(platform, native, NULL) : EGL_NO_DISPLAY;
	if (display == EGL_NO_DISPLAY || !eglInitialize(display, NULL, NULL) ||
	    !lists_extension(eglQueryString(display, EGL_EXTENSIONS),
			     "EGL_KHR_surfaceless_context"))
		return false;
	search->found_display = true;
	search->context = make_egl_context(display);
	search->display = display;
	return search->context != EGL_NO_CONTEXT;
}

/* GPUs: devices that do not call themselves software. */
static bool try_egl_gpus(struct egl_search *search)
{
	const PFNEGLQUERYDEVICESEXTPROC list =
		(PFNEGLQUERYDEVICESEXTPROC)(void *)eglGetProcAddress("eglQueryDevicesEXT");
	const PFNEGLQUERYDEVICESTRINGEXTPROC describe =
		(PFNEGLQUERYDEVICESTRINGEXTPROC)(void *)eglGetProcAddress(
			"eglQueryDeviceStringEXT");
	EGLDeviceEXT devices[DEVICES_MAX];
	EGLint count = 0;
	if (!list || !describe || !list(DEVICES_MAX, devices, &count))
		return false;
	for (EGLint i = 0; i < count; i++)
		if (!lists_extension(describe(devices[i], EGL_EXTENSIONS),
				     "EGL_MESA_device_software") &&
		    try_egl_display(search, EGL_PLATFORM_DEVICE_EXT, devices[i]))
			return true;
	return false;
}

static bool find_egl_context(struct egl_search *search, bool hardware_only)
{
	const char *client = eglQueryString(EGL_NO_DISPLAY, EGL_EXTENSIONS);
	if (lists_extension(client, "EGL_EXT_platform_device") && try_egl_gpus(search))
		return true;
	return !hardware_only && lists_extension(client, "EGL_MESA_platform_surfaceless") &&
	       try_egl_display(search, EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY);
}

enum gz_result gz_gl_context_egl(bool hardware_only, struct gz_gl_context **out_context,
				 char *reason, size_t size)
{
	struct egl_search search = { .context = EGL_NO_CONTEXT };
	if (!find_egl_context(&search, hardware_only)) {
		snprintf(reason, size, "%s",
			 search.found_display ? "EGL has no OpenGL 4.3"
			 : hardware_only      ? "EGL lists no GPU that can be used"
					      : "EGL has no display without a window");
		return search.found_display ? GZ_ERR_UNSUPPORTED : GZ_ERR_NO_DEVICE;
	}
	struct egl_context *egl = malloc(sizeof *egl);
	if (!egl) {
		snprintf(reason, size, "no memory");
		eglDestroyContext(search.display, search.context);
		return GZ_ERR_NO_MEM;
	}
	*egl = (struct egl_context) {
		.base = { .ops = &egl_ops },
		.display = search.display,
		.context = search.context,
	};
	*out_context = &egl->base;
	return GZ_OK;
}

void gz_gl_context_destroy(struct gz_gl_context **context)
{
	if (!*context)
		return;
	if ((*context)->ops->destroy)
		(*context)->ops->destroy(*context);
	*context = NULL;
}

/* Renderers that run on the processor, by the names they give themselves. */
static bool is_software_renderer(const char *renderer)
{
	static const char *const names[] = { "llvmpipe", "softpipe", "swrast",
					     "Software Rasterizer", "SwiftShader" };
	for (size_t i = 0; i < sizeof names / sizeof names[0]; i++)
		if (strstr(renderer, names[i]))
			return true;
	return false;
}

static int64_t gl_limit(GLenum name)
{
	GLint64 value = 0;
	glGetInteger64v(name, &value);
	return value;
}

/* Free device memory, bytes; 0 if the driver does not report it. Both extensions count in KiB. */
static int64_t free_device_memory(void)
{
	GLint kib[4] = { 0 };
	if (GLEW_NVX_gpu_memory_info)
		glGetIntegerv(GL_GPU_MEMORY_INFO_CURRENT_AVAILABLE_VIDMEM_NVX, kib);
	else if (GLEW_ATI_meminfo)
		glGetIntegerv(GL_TEXTURE_FREE_MEMORY_ATI, kib);
	return (int64_t)kib[0] * 1024;
}

static void find_device_memory(struct gz_gl_device *device)
{
	const long pages = sysconf(_SC_PHYS_PAGES), page = sysconf(_SC_PAGESIZE);
	const int64_t reported = device->software ? 0 : free_device_memory();
	device->memory_known = reported > 0;
	device->memory_max = reported / 4 * 3;
	if (reported <= 0)
		device->memory_max =
			pages > 0 && page > 0 ? (int64_t)pages / 4 * page : (int64_t)1 << 30;
}

/* Load OpenGL into the current context and find its limits. */
static enum gz_result find_limits(struct gz_gl_device *device, char *reason)
{
	/* Once all of them are loaded, they stay: another thread may be using them. */
	glewExperimental = GL_TRUE; /* core profiles hide the old extension list */
	const GLenum failure = GLEW_VERSION_4_3 ? GLEW_OK : glewInit();
	/* Without an X display GLEW misses GLX after it has loaded all of OpenGL. */
	if (failure != GLEW_OK && failure != GLEW_ERROR_NO_GLX_DISPLAY) {
		snprintf(reason, REASON_SIZE, "%s", (const char *)glewGetErrorString(failure));
		return GZ_ERR_UNSUPPORTED;
	}
	const char *renderer = (const char *)glGetString(GL_RENDERER);
	GLint major = 0, minor = 0;
	glGetIntegerv(GL_MAJOR_VERSION, &major);
	glGetIntegerv(GL_MINOR_VERSION, &minor);
	renderer = renderer ? renderer : "unknown";
	if (major < 4 || (major == 4 && minor < 3)) {
		snprintf(reason, REASON_SIZE, "%.100s has OpenGL %d.%d, not 4.3", renderer, major,
			 minor);
		return GZ_ERR_UNSUPPORTED;
	}
	snprintf(device->description, sizeof device->description, "gl: %.120s, %d.%d", renderer,
		 major, minor);
	device->software = is_software_renderer(renderer);
	device->reports_loss = GLEW_ARB_robustness && glGetGraphicsResetStatusARB;
	device->texture_edge_max = (int)gl_limit(GL_MAX_3D_TEXTURE_SIZE);
	device->volume_edge_max = device->texture_edge_max;
	device->storage_max = gl_limit(GL_MAX_SHADER_STORAGE_BLOCK_SIZE);
	find_device_memory(device);
	GLint groups = 65535; /* the least that OpenGL 4.3 allows; stays if the context is lost */
	glGetIntegeri_v(GL_MAX_COMPUTE_WORK_GROUP_COUNT, 0, &groups);
	device->groups_max = groups;
	while (glGetError() != GL_NO_ERROR) /* errors of GLEW's queries */
		;
	return GZ_OK;
}

static enum gz_result set_up_device(const struct gz_gl_setup *setup, struct gz_gl_device *device,
				    char *reason)
{
	enum gz_result result = GZ_OK;
	device->context = setup->lent;
	if (!setup->lent) {
		result = gz_gl_context_egl(setup->hardware_only, &device->own_context, reason,
					   REASON_SIZE);
		device->context = device->own_context;
	}
	if (result == GZ_OK)
		result = gz_gl_device_enter(device);
	if (result != GZ_OK)
		return result;
	result = find_limits(device, reason);
	gz_gl_device_leave(device);
	if (result == GZ_OK && device->software && setup->hardware_only) {
		snprintf(reason, REASON_SIZE, "%.120s is software", device->description);
		result = GZ_ERR_UNSUPPORTED;
	}
	if (setup->memory_bytes > 0) {
		device->memory_max = (int64_t)setup->memory_bytes;
		device->memory_known = true;
	}
	return result;
}

enum gz_result gz_gl_device_create(const struct gz_gl_setup *setup, const struct gz_log *log,
				   struct gz_gl_device *out_device)
{
	char reason[REASON_SIZE] = "its context cannot be made current";
	struct gz_gl_device device = { 0 };
	const enum gz_result result = set_up_device(setup, &device, reason);
	if (result == GZ_OK) {
		*out_device = device;
		return GZ_OK;
	}
	/* A caller that only tries takes cpu then; one that insists must be told what to do. */
	if (setup->hardware_only)
		gz_debug(log, "cpu casts the rays: %s", reason);
	else
		gz_err(log, "no OpenGL 4.3: %s; update the graphics driver, or take --backend cpu",
		       reason);
	gz_gl_device_destroy(&device);
	return result;
}

enum gz_result gz_gl_device_enter(const struct gz_gl_device *device)
{
	return device->context ? device->context->ops->make_current(device->context)
			       : GZ_ERR_NO_DEVICE;
}

void gz_gl_device_leave(const struct gz_gl_device *device)
{
	device->context->ops->release(device->context);
}

void gz_gl_device_destroy(struct gz_gl_device *device)
{
	gz_gl_context_destroy(&device->own_context);
	*device = (struct gz_gl_device) { 0 };
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
	if (device->reports_loss && glGetGraphicsResetStatusARB() != GL_NO_ERROR)
		return GZ_ERR_NO_DEVICE;
	/* A lost context may report errors for ever: read a few. */
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
	gz_gl_buffer_reserve(buffer, size, GL_STATIC_DRAW); /* read by many frames */
	glBindBuffer(GL_SHADER_STORAGE_BUFFER, buffer->name);
	void *memory = glMapBufferRange(GL_SHADER_STORAGE_BUFFER, 0, (GLsizeiptr)size,
					GL_MAP_WRITE_BIT | GL_MAP_INVALIDATE_BUFFER_BIT);
	if (!memory)
		buffer->size = 0;
	return memory;
}

size_t gz_gl_buffer_bring(const struct gz_gl_device *device, const struct gz_gl_buffer *source,
			  size_t from, size_t bytes, struct gz_gl_buffer *staging)
{
	if (device->software) {
		glBindBuffer(GL_COPY_READ_BUFFER, source->name);
		return from;
	}
	gz_gl_buffer_reserve(staging, bytes, GL_STREAM_READ);
	glBindBuffer(GL_COPY_READ_BUFFER, source->name);
	glBindBuffer(GL_COPY_WRITE_BUFFER, staging->name);
	glCopyBufferSubData(GL_COPY_READ_BUFFER, GL_COPY_WRITE_BUFFER, (GLintptr)from, 0,
			    (GLsizeiptr)bytes);
	glBindBuffer(GL_COPY_READ_BUFFER, staging->name);
	return 0;
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

static int64_t timer_mark_ns(const struct gz_gl_timer *timer, const struct gz_gl_device *device,
			     int mark)
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
	return gz_ns_to_ms(timer_mark_ns(timer, device, to) - timer_mark_ns(timer, device, from));
}

void gz_gl_timer_free(struct gz_gl_timer *timer)
{
	if (timer->queries[0])
		glDeleteQueries(GZ_GL_MARKS_MAX, timer->queries);
	*timer = (struct gz_gl_timer) { 0 };
}
