#include "drivers/tobii/tobii_library.h"

#include <dlfcn.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>

#define GZ_LOG_MODULE "tobii"

#define PREFIX "tobii_research_"

/* A function, and where its address goes. */
struct tobii_function {
	const char *name;
	size_t offset;
	bool optional;
};

#define SYMBOL(name, optional)                                                  \
	{                                                                       \
		PREFIX #name, offsetof(struct gz_tobii_library, name), optional \
	}

static const struct tobii_function tobii_functions[] = {
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

/* @return the name of a missing function, or NULL */
static const char *find_tobii_functions(struct gz_tobii_library *library)
{
	for (size_t i = 0; i < sizeof tobii_functions / sizeof *tobii_functions; i++) {
		void *address = dlsym(library->handle, tobii_functions[i].name);
		if (!address && !tobii_functions[i].optional)
			return tobii_functions[i].name;
		/* POSIX lets a void pointer hold a function pointer. */
		memcpy((char *)library + tobii_functions[i].offset, &address, sizeof address);
	}
	return NULL;
}

enum gz_result gz_tobii_library_open(const char *path, struct gz_tobii_library *out_library,
				     char *out_reason)
{
	struct gz_tobii_library library = { 0 };
	/* NODELETE: threads of the library may run on after it is closed, and need its code. */
	library.handle = dlopen(path, RTLD_NOW | RTLD_LOCAL | RTLD_NODELETE);
	if (!library.handle) {
		const char *why = dlerror();
		snprintf(out_reason, GZ_TOBII_REASON_SIZE,
			 "%.300s; install the Tobii Pro SDK for C and set tobii.library to its "
			 "library",
			 why ? why : "unknown error");
		return GZ_ERR_NOT_FOUND;
	}
	const char *missing = find_tobii_functions(&library);
	if (missing) {
		snprintf(out_reason, GZ_TOBII_REASON_SIZE,
			 "%.300s has no function %s; set tobii.library to the library of the Tobii "
			 "Pro SDK",
			 path, missing);
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

typedef gz_tobii_status tobii_text_function(struct gz_tobii_tracker *tracker, char **out_text);

/* Ask the SDK for a text; empty if it does not know it. */
static void get_tobii_text(const struct gz_tobii_library *library, tobii_text_function *get,
			   struct gz_tobii_tracker *tracker, char *out_text, size_t size)
{
	char *text = NULL;
	out_text[0] = '\0';
	if (!get || get(tracker, &text) != GZ_TOBII_OK || !text)
		return;
	snprintf(out_text, size, "%s", text);
	library->free_string(text);
}

static void describe_tobii(const struct gz_tobii_library *library, struct gz_tobii_tracker *tracker,
			   struct gz_device_entry *out_entry)
{
	struct gz_device_entry entry = { .usable = true };
	get_tobii_text(library, library->get_model, tracker, entry.name, sizeof entry.name);
	if (!entry.name[0])
		get_tobii_text(library, library->get_device_name, tracker, entry.name,
			       sizeof entry.name);
	if (!entry.name[0])
		snprintf(entry.name, sizeof entry.name, "Tobii");
	get_tobii_text(library, library->get_serial_number, tracker, entry.serial,
		       sizeof entry.serial);
	get_tobii_text(library, library->get_address, tracker, entry.place, sizeof entry.place);
	*out_entry = entry;
}

enum gz_result gz_tobii_find(const struct gz_tobii_library *library, const struct gz_log *log,
			     struct gz_tobii_found *out_found)
{
	out_found->count = 0;
	struct gz_tobii_trackers *found = NULL;
	gz_tobii_status status = library->find_all_eyetrackers(&found);
	if (status != GZ_TOBII_OK || !found) {
		gz_err(log, "the Tobii Pro SDK cannot search for trackers: status %d", status);
		return GZ_ERR_NO_DEVICE;
	}
	size_t count = 0;
	for (size_t i = 0; i < found->count && count < GZ_DEVICE_ENTRIES_MAX; i++) {
		if (!found->trackers[i])
			continue;
		out_found->trackers[count] = found->trackers[i];
		describe_tobii(library, found->trackers[i], &out_found->entries[count]);
		count++;
	}
	library->free_eyetrackers(found);
	out_found->count = count;
	if (count > 0)
		return GZ_OK;
	gz_err(log, "the Tobii Pro SDK finds no tracker; connect one and set it up with Tobii's "
		    "Eye Tracker Manager");
	return GZ_ERR_NO_DEVICE;
}

static bool is_chosen_tobii(const struct gz_tobii_library *library,
			    struct gz_tobii_tracker *tracker, const struct gz_device_entry *entry,
			    const char *choice)
{
	char name[GZ_NAME_SIZE];
	get_tobii_text(library, library->get_device_name, tracker, name, sizeof name);
	return gz_device_is_chosen(choice, entry->name, entry->serial) ||
	       strcmp(choice, entry->place) == 0 || strcmp(choice, name) == 0;
}

size_t gz_tobii_choose(const struct gz_tobii_library *library, const struct gz_tobii_found *found,
		       const char *choice, const struct gz_log *log)
{
	if (!choice || !choice[0])
		return 0;
	for (size_t i = 0; i < found->count; i++) {
		if (is_chosen_tobii(library, found->trackers[i], &found->entries[i], choice))
			return i;
	}
	gz_err(log,
	       "no tracker is called %s; found %s, serial number %s%s; check tracker.choice, or "
	       "see gazectl devices",
	       choice, found->entries[0].name, found->entries[0].serial,
	       found->count > 1 ? ", and others" : "");
	return found->count;
}
