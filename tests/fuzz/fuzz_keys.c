/* Key files, lists of keys and ZAP requests from anywhere: what is accepted is keys, whole texts
 * and nothing that steers a terminal. The first byte says which it is. */
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "daemon/admission.h"
#include "protocol/key.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static void require(bool holds)
{
	if (!holds)
		abort();
}

static void require_text(const char *text, size_t size)
{
	const char *end = memchr(text, '\0', size);
	require(end != NULL);
	for (const char *c = text; c < end; c++)
		require((unsigned char)*c >= ' ' && *c != 0x7f);
}

static void require_key(const char *key)
{
	require(memchr(key, '\0', GZ_KEY_TEXT_SIZE) == key + GZ_KEY_LENGTH);
	require(gz_key_valid(key, GZ_KEY_LENGTH));
}

static void take_file(const char *text, size_t size)
{
	char key[GZ_KEY_TEXT_SIZE];
	if (gz_key_parse("fuzz", text, size, NULL, key) == GZ_OK)
		require_key(key);
}

static void take_list(const char *text, size_t size, enum gz_key_list_kind kind)
{
	static struct gz_key_list list;
	enum gz_result result = gz_key_list_parse("fuzz", text, size, kind, NULL, &list);
	require(result == GZ_OK || result == GZ_ERR_FORMAT || result == GZ_ERR_FULL);
	if (result != GZ_OK)
		return;
	require(list.count <= GZ_KEYS_MAX);
	for (size_t i = 0; i < list.count; i++) {
		const struct gz_known_key *item = &list.items[i];
		require_key(item->key);
		require_text(item->name, sizeof item->name);
		require(gz_key_list_find_key(&list, item->key) != NULL);
		if (kind == GZ_KEY_LIST_SERVERS && !strchr(item->name, ','))
			require(strcmp(gz_key_list_find_host(&list, item->name)->key, item->key) ==
				0);
	}
}

/* Frames, each behind a byte with its length; one that claims more ends the message. */
static void take_request(const uint8_t *data, size_t size)
{
	struct gz_zap_frame frames[GZ_ZAP_FRAMES + 1];
	struct gz_zap_request request;
	size_t count = 0;
	while (size > 0 && count < GZ_ZAP_FRAMES + 1 && data[0] < size) {
		frames[count++] = (struct gz_zap_frame) { data + 1, data[0] };
		size -= 1 + (size_t)data[0];
		data += 1 + data[0];
	}
	enum gz_result result = gz_zap_parse(frames, count, &request);
	require(request.id_size <= sizeof request.id);
	if (result != GZ_OK)
		return;
	require(count == GZ_ZAP_FRAMES);
	require_key(request.key);
	require_text(request.address, sizeof request.address);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	if (size == 0)
		return 0;
	const char *text = (const char *)data + 1;
	switch (data[0]) {
	case 'k':
		take_file(text, size - 1);
		break;
	case 'a':
		take_list(text, size - 1, GZ_KEY_LIST_AUTHORIZED);
		break;
	case 's':
		take_list(text, size - 1, GZ_KEY_LIST_SERVERS);
		break;
	default:
		take_request(data + 1, size - 1);
		break;
	}
	return 0;
}
