#include "daemon/address_limit.h"

#include <stdio.h>
#include <string.h>

static bool is_free(const struct gz_address_limit_entry *entry, int64_t now_ns)
{
	return !entry->address[0] || now_ns >= entry->limit.next_ns;
}

static struct gz_address_limit_entry *find(struct gz_address_limit *limit, const char *address,
					   int kind)
{
	for (int i = 0; i < GZ_ADDRESS_LIMIT_COUNT; i++) {
		struct gz_address_limit_entry *entry = &limit->entries[i];
		if (entry->kind == kind && strcmp(entry->address, address) == 0)
			return entry;
	}
	return NULL;
}

/* Of the free entries that whose minute has been over longest: a steady caller keeps its count. */
static struct gz_address_limit_entry *make_room(struct gz_address_limit *limit, int64_t now_ns)
{
	struct gz_address_limit_entry *oldest = NULL;
	for (int i = 0; i < GZ_ADDRESS_LIMIT_COUNT; i++) {
		struct gz_address_limit_entry *entry = &limit->entries[i];
		if (is_free(entry, now_ns) &&
		    (!oldest || entry->limit.next_ns < oldest->limit.next_ns))
			oldest = entry;
	}
	return oldest;
}

bool gz_address_limit_pass(struct gz_address_limit *limit, const char *address, int kind,
			   int64_t now_ns, uint64_t *out_dropped)
{
	char key[GZ_ADDRESS_SIZE];
	snprintf(key, sizeof key, "%s", address[0] ? address : "?");
	struct gz_address_limit_entry *entry = find(limit, key, kind);
	if (!entry) {
		entry = make_room(limit, now_ns);
		if (!entry)
			return gz_ratelimit_pass(&limit->others, now_ns, GZ_ADDRESS_LIMIT_NS,
						 out_dropped);
		*entry = (struct gz_address_limit_entry) { .kind = kind };
		memcpy(entry->address, key, sizeof key);
	}
	return gz_ratelimit_pass(&entry->limit, now_ns, GZ_ADDRESS_LIMIT_NS, out_dropped);
}
