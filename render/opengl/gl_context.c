#include "render/opengl/gl_context.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <EGL/egl.h>
#include <EGL/eglext.h>

/* Most devices looked at. Chosen: more than a machine has. */
enum { DEVICES_MAX = 32 };

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

static bool has_word(const char *words, const char *word)
{
	const size_t length = strlen(word);
	for (const char *at = words; at && (at = strstr(at, word)); at += length)
		if ((at == words || at[-1] == ' ') && (at[length] == ' ' || !at[length]))
			return true;
	return false;
}

/* A core context of 4.3 that tells when it is lost, where the driver can tell. */
static EGLContext make_context(EGLDisplay display)
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

/* Which displays have been tried, and with what success. */
struct search {
	EGLDisplay display;
	EGLContext context;
	bool found_display;
};

static bool try_display(struct search *search, EGLenum platform, void *native)
{
	const PFNEGLGETPLATFORMDISPLAYEXTPROC get_display =
		(PFNEGLGETPLATFORMDISPLAYEXTPROC)(void *)eglGetProcAddress(
			"eglGetPlatformDisplayEXT");
	EGLDisplay display = get_display ? get_display(platform, native, NULL) : EGL_NO_DISPLAY;
	if (display == EGL_NO_DISPLAY || !eglInitialize(display, NULL, NULL) ||
	    !has_word(eglQueryString(display, EGL_EXTENSIONS), "EGL_KHR_surfaceless_context"))
		return false;
	search->found_display = true;
	search->context = make_context(display);
	search->display = display;
	return search->context != EGL_NO_CONTEXT;
}

/* GPUs, that is devices that do not call themselves software. */
static bool try_devices(struct search *search)
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
		if (!has_word(describe(devices[i], EGL_EXTENSIONS), "EGL_MESA_device_software") &&
		    try_display(search, EGL_PLATFORM_DEVICE_EXT, devices[i]))
			return true;
	return false;
}

static bool find_context(struct search *search, bool hardware_only)
{
	const char *client = eglQueryString(EGL_NO_DISPLAY, EGL_EXTENSIONS);
	if (has_word(client, "EGL_EXT_platform_device") && try_devices(search))
		return true;
	return !hardware_only && has_word(client, "EGL_MESA_platform_surfaceless") &&
	       try_display(search, EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY);
}

enum gz_result gz_gl_context_egl(bool hardware_only, struct gz_gl_context **out_context,
				 char *reason, size_t size)
{
	struct search search = { .context = EGL_NO_CONTEXT };
	if (!find_context(&search, hardware_only)) {
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
