#include "drivers/tobii/tobii_find.h"

#include <stdbool.h>
#include <stdio.h>
#include <string.h>

#define GZ_LOG_MODULE "tobii"

typedef gz_tobii_status get_text(struct gz_tobii_tracker *tracker, char **out_text);

/* Empty where the SDK cannot tell. */
static void ask(const struct gz_tobii_library *library, get_text *get,
		struct gz_tobii_tracker *tracker, char *out_text, size_t size)
{
	char *text = NULL;
	out_text[0] = '\0';
	if (!get || get(tracker, &text) != GZ_TOBII_OK || !text)
		return;
	snprintf(out_text, size, "%s", text);
	library->free_string(text);
}

static void describe(const struct gz_tobii_library *library, struct gz_tobii_tracker *tracker,
		     struct gz_device_entry *out_entry)
{
	struct gz_device_entry entry = { .usable = true };
	ask(library, library->get_model, tracker, entry.name, sizeof entry.name);
	if (!entry.name[0])
		ask(library, library->get_device_name, tracker, entry.name, sizeof entry.name);
	if (!entry.name[0])
		snprintf(entry.name, sizeof entry.name, "Tobii");
	ask(library, library->get_serial_number, tracker, entry.serial, sizeof entry.serial);
	ask(library, library->get_address, tracker, entry.place, sizeof entry.place);
	*out_entry = entry;
}

enum gz_result gz_tobii_find(const struct gz_tobii_library *library, const struct gz_log *log,
			     struct gz_tobii_tracker **out_trackers,
			     struct gz_device_entry *out_entries, size_t *out_count)
{
	struct gz_tobii_trackers *found = NULL;
	gz_tobii_status status = library->find_all_eyetrackers(&found);
	if (status != GZ_TOBII_OK || !found) {
		gz_err(log, "the Tobii Pro SDK cannot look for trackers: its status is %d", status);
		return GZ_ERR_NO_DEVICE;
	}
	size_t count = 0;
	for (size_t i = 0; i < found->count && count < GZ_DEVICE_ENTRIES_MAX; i++) {
		if (!found->trackers[i])
			continue;
		out_trackers[count] = found->trackers[i];
		describe(library, out_trackers[count], &out_entries[count]);
		count++;
	}
	library->free_eyetrackers(found);
	*out_count = count;
	if (count > 0)
		return GZ_OK;
	gz_err(log, "the Tobii Pro SDK finds no tracker; connect one, and set it up with Tobii's "
		    "Eye Tracker Manager");
	return GZ_ERR_NO_DEVICE;
}

static bool is_meant(const struct gz_tobii_library *library, struct gz_tobii_tracker *tracker,
		     const struct gz_device_entry *entry, const char *choice)
{
	char name[GZ_NAME_SIZE];
	ask(library, library->get_device_name, tracker, name, sizeof name);
	return strcmp(choice, entry->name) == 0 || strcmp(choice, entry->serial) == 0 ||
	       strcmp(choice, entry->place) == 0 || strcmp(choice, name) == 0;
}

size_t gz_tobii_choose(const struct gz_tobii_library *library,
		       struct gz_tobii_tracker *const *trackers,
		       const struct gz_device_entry *entries, size_t count, const char *choice,
		       const struct gz_log *log)
{
	if (!choice || !choice[0])
		return 0;
	size_t i = 0;
	while (i < count && !is_meant(library, trackers[i], &entries[i], choice))
		i++;
	if (i == count)
		gz_err(log,
		       "no tracker %s: there is %s, serial number %s%s; check tracker.choice, or "
		       "see "
		       "gazectl devices",
		       choice, entries[0].name, entries[0].serial, count > 1 ? ", and others" : "");
	return i;
}
