#include "drivers/hid/hid_find.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "drivers/hid/hid_port.h"
#include "drivers/hid/hid_usages.h"

/* What is needed while looking. */
struct search {
	struct gz_hid_found *found;
	size_t count;
	struct gz_hid_port_entry entries[GZ_HID_PORT_ENTRIES_MAX];
	unsigned char bytes[GZ_HID_DESCRIPTOR_SIZE];
	struct gz_hid_descriptor descriptor;
};

static struct gz_hid_found *add(struct search *search, const struct gz_hid_port_entry *entry)
{
	if (search->count == GZ_DEVICE_ENTRIES_MAX)
		return NULL;
	struct gz_hid_found *found = &search->found[search->count++];
	*found = (struct gz_hid_found) { .result = GZ_OK };
	snprintf(found->entry.name, sizeof found->entry.name, "%s", entry->name);
	snprintf(found->entry.serial, sizeof found->entry.serial, "%s", entry->serial);
	snprintf(found->entry.place, sizeof found->entry.place, "%s", entry->path);
	return found;
}

static void set_unusable(struct gz_hid_found *found, enum gz_result result, const char *reason)
{
	found->result = result;
	snprintf(found->entry.reason, sizeof found->entry.reason, "%s", reason);
}

static void add_malformed(struct search *search, const struct gz_hid_port_entry *entry,
			  const struct gz_hid_fault *fault)
{
	struct gz_hid_found *found = add(search, entry);
	if (!found)
		return;
	found->result = GZ_ERR_FORMAT;
	snprintf(found->entry.reason, sizeof found->entry.reason,
		 "its report descriptor cannot be: %s, byte %zu; ask its maker for other firmware",
		 fault->text, fault->at);
}

static void judge_access(struct gz_hid_found *found)
{
	switch (gz_hid_port_may_open(found->entry.place)) {
	case GZ_OK:
		found->entry.usable = true;
		return;
	case GZ_ERR_ACCESS:
		set_unusable(found, GZ_ERR_ACCESS,
			     "no permission; install the udev rule 70-gazecast.rules, then plug "
			     "the tracker in again");
		return;
	default:
		set_unusable(found, GZ_ERR_NO_DEVICE, "it has just gone");
	}
}

static void add_trackers(struct search *search, const struct gz_hid_port_entry *entry)
{
	size_t trackers = gz_hid_tracker_count(&search->descriptor);
	for (size_t i = 0; i < trackers; i++) {
		struct gz_hid_found *found = add(search, entry);
		const char *reason;
		if (!found)
			return;
		found->index = i;
		if (i > 0)
			snprintf(found->entry.name, sizeof found->entry.name, "%.*s #%u",
				 GZ_NAME_SIZE - 8, entry->name, (uint8_t)(i + 1));
		if (gz_hid_tracker_find(&search->descriptor, i, &found->tracker, &reason) != GZ_OK)
			set_unusable(found, GZ_ERR_FORMAT, reason);
		else
			judge_access(found);
	}
}

static void look_at(struct search *search, const struct gz_hid_port_entry *entry)
{
	size_t size;
	struct gz_hid_fault fault;
	if (gz_hid_port_descriptor(entry->path, search->bytes, &size) != GZ_OK ||
	    !gz_hid_descriptor_mentions(search->bytes, size, GZ_HID_PAGE_TRACKERS))
		return;
	if (gz_hid_descriptor_parse(search->bytes, size, &search->descriptor, &fault) == GZ_OK)
		add_trackers(search, entry);
	else
		add_malformed(search, entry, &fault);
}

enum gz_result gz_hid_find(struct gz_hid_found *out_found, size_t *out_count)
{
	struct search *search = malloc(sizeof *search);
	if (!search)
		return GZ_ERR_NO_MEM;
	search->found = out_found;
	search->count = 0;
	size_t entries = gz_hid_port_list(search->entries);
	for (size_t i = 0; i < entries; i++)
		look_at(search, &search->entries[i]);
	*out_count = search->count;
	free(search);
	return GZ_OK;
}

static bool is_meant(const struct gz_device_entry *entry, const char *choice)
{
	return strcmp(entry->name, choice) == 0 || strcmp(entry->place, choice) == 0 ||
	       (entry->serial[0] && strcmp(entry->serial, choice) == 0);
}

const struct gz_hid_found *gz_hid_choose(const struct gz_hid_found *found, size_t count,
					 const char *choice)
{
	const struct gz_hid_found *first = NULL;
	for (size_t i = 0; i < count; i++) {
		if (choice && choice[0] && !is_meant(&found[i].entry, choice))
			continue;
		if (found[i].result == GZ_OK)
			return &found[i];
		if (!first)
			first = &found[i];
	}
	return first;
}
