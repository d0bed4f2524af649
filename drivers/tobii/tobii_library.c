#include "drivers/tobii/tobii_library.h"

#include <dlfcn.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>

#define PREFIX "tobii_research_"

/* A function and where its address goes. */
struct symbol {
	const char *name;
	size_t offset;
	bool optional;
};

#define SYMBOL(name, optional)                                                  \
	{                                                                       \
		PREFIX #name, offsetof(struct gz_tobii_library, name), optional \
	}

static const struct symbol symbols[] = {
	SYMBOL(find_all_eyetrackers, false),
	SYMBOL(free_eyetrackers, false),
	SYMBOL(get_address, false),
	SYMBOL(get_device_name, false),
	SYMBOL(free_string, false),
	SYMBOL(get_display_area, false),
	SYMBOL(set_gaze_output_frequency, false),
	SYMBOL(get_system_time_stamp, false),
	SYMBOL(subscribe_to_gaze_data, false),
	SYMBOL(unsubscribe_from_gaze_data, false),
	SYMBOL(get_serial_number, true),
	SYMBOL(get_model, true),
	SYMBOL(get_gaze_output_frequency, true),
	SYMBOL(subscribe_to_notifications, true),
	SYMBOL(unsubscribe_from_notifications, true),
};

/* @return the name of a function that is missing, or NULL */
static const char *find_symbols(struct gz_tobii_library *library)
{
	for (size_t i = 0; i < sizeof symbols / sizeof *symbols; i++) {
		void *address = dlsym(library->handle, symbols[i].name);
		if (!address && !symbols[i].optional)
			return symbols[i].name;
		/* POSIX has function pointers fit into void pointers. */
		memcpy((char *)library + symbols[i].offset, &address, sizeof address);
	}
	return NULL;
}

enum gz_result gz_tobii_library_open(const char *path, struct gz_tobii_library *out_library,
				     char *out_reason)
{
	struct gz_tobii_library library = { 0 };
	/* NODELETE: its threads may outlive a close, and their code must not vanish. */
	library.handle = dlopen(path, RTLD_NOW | RTLD_LOCAL | RTLD_NODELETE);
	if (!library.handle) {
		const char *why = dlerror();
		snprintf(out_reason, GZ_TOBII_REASON_SIZE,
			 "%.300s; install the Tobii Pro SDK for C and name its library: "
			 "tobii.library",
			 why ? why : "no library");
		return GZ_ERR_NOT_FOUND;
	}
	const char *missing = find_symbols(&library);
	if (missing) {
		snprintf(out_reason, GZ_TOBII_REASON_SIZE,
			 "%.300s has no %s; name the Tobii Pro SDK's library: tobii.library", path,
			 missing);
		gz_tobii_library_close(&library);
		return GZ_ERR_FORMAT;
	}
	*out_library = library;
	return GZ_OK;
}

void gz_tobii_library_close(struct gz_tobii_library *library)
{
	if (library->handle)
		dlclose(library->handle);
	library->handle = NULL;
}
