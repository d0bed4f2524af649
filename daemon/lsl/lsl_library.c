#include "daemon/lsl/lsl_library.h"

#include <dlfcn.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>

#define PREFIX "lsl_"

/* A function, and where its address goes. */
struct lsl_function {
	const char *name;
	size_t offset;
	bool optional;
};

#define SYMBOL(name, optional)                                                \
	{                                                                     \
		PREFIX #name, offsetof(struct gz_lsl_library, name), optional \
	}

static const struct lsl_function lsl_functions[] = {
	SYMBOL(create_streaminfo, false),  SYMBOL(destroy_streaminfo, false),
	SYMBOL(get_desc, false),           SYMBOL(append_child, false),
	SYMBOL(append_child_value, false), SYMBOL(create_outlet, false),
	SYMBOL(destroy_outlet, false),     SYMBOL(have_consumers, false),
	SYMBOL(push_sample_dtp, false),    SYMBOL(push_sample_strtp, false),
	SYMBOL(local_clock, false),        SYMBOL(library_version, false),
	SYMBOL(last_error, true),
};

/* @return the name of a missing function, or NULL */
static const char *find_lsl_functions(struct gz_lsl_library *library)
{
	for (size_t i = 0; i < sizeof lsl_functions / sizeof *lsl_functions; i++) {
		void *address = dlsym(library->handle, lsl_functions[i].name);
		if (!address && !lsl_functions[i].optional)
			return lsl_functions[i].name;
		/* POSIX lets a void pointer hold a function pointer. */
		memcpy((char *)library + lsl_functions[i].offset, &address, sizeof address);
	}
	return NULL;
}

enum gz_result gz_lsl_library_open(const char *path, struct gz_lsl_library *out_library,
				   char *out_reason)
{
	struct gz_lsl_library library = { 0 };
	/* NODELETE: threads of the library may run on after it is closed, and need its code. */
	library.handle = dlopen(path, RTLD_NOW | RTLD_LOCAL | RTLD_NODELETE);
	if (!library.handle) {
		const char *why = dlerror();
		snprintf(
			out_reason, GZ_LSL_REASON_SIZE,
			"%.300s; install liblsl and set lsl.library to it, or leave out lsl.outlet",
			why ? why : "unknown error");
		return GZ_ERR_NOT_FOUND;
	}
	const char *missing = find_lsl_functions(&library);
	if (missing) {
		snprintf(out_reason, GZ_LSL_REASON_SIZE,
			 "%.300s has no function %s; set lsl.library to liblsl 1.13 or later", path,
			 missing);
		gz_lsl_library_close(&library);
		return GZ_ERR_FORMAT;
	}
	*out_library = library;
	return GZ_OK;
}

void gz_lsl_library_close(struct gz_lsl_library *library)
{
	if (library->handle)
		dlclose(library->handle);
	library->handle = NULL;
}
