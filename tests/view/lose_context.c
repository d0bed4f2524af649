/* Preloaded into a program whose window's context is to be lost: where a file that LOSE_CONTEXT
 * names appears, the driver's next answer is that the device was reset, once. GLEW asks for entry
 * points by glXGetProcAddressARB(), and gets this one. */
#include <dlfcn.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* GL_GUILTY_CONTEXT_RESET_ARB of GL_ARB_robustness. */
#define GUILTY 0x8253U

typedef void entry_point(void);

static unsigned (*true_status)(void);

static unsigned status(void)
{
	const char *path = getenv("LOSE_CONTEXT");
	if (path && unlink(path) == 0)
		return GUILTY;
	return true_status();
}

entry_point *glXGetProcAddressARB(const unsigned char *name);

entry_point *glXGetProcAddressARB(const unsigned char *name)
{
	entry_point *(*find)(const unsigned char *) =
		(entry_point * (*)(const unsigned char *)) dlsym(RTLD_NEXT, "glXGetProcAddressARB");
	entry_point *found = find ? find(name) : NULL;
	if (!found || strcmp((const char *)name, "glGetGraphicsResetStatusARB") != 0)
		return found;
	true_status = (unsigned (*)(void))found;
	return (entry_point *)status;
}
