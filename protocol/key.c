#include "protocol/key.h"

#include <stdint.h>
#include <string.h>
#include <strings.h>

#define GZ_LOG_MODULE "key"

/* ZeroMQ RFC 32/Z85: the characters for 0 to 84; five of them, most significant first, are 32 bits.
 */
static const char alphabet[] = "0123456789abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ"
			       ".-:+=^!/*?&<>()[]{}@%$#";

enum { GROUP_LENGTH = 5 };

bool gz_key_valid(const char *text, size_t length)
{
	uint64_t value = 0;
	if (length != GZ_KEY_LENGTH)
		return false;
	for (size_t i = 0; i < length; i++) {
		const char *digit = text[i] ? strchr(alphabet, text[i]) : NULL;
		if (!digit)
			return false;
		value = (i % GROUP_LENGTH ? 85 * value : 0) + (uint64_t)(digit - alphabet);
		if (value > UINT32_MAX)
			return false;
	}
	return true;
}

/* Lines of a text. */
struct lines {
	const char *rest, *end;
	int number;        /* of the line in hand, from 1 */
	const char *start; /* of the line in hand, without the blanks around it */
	size_t length;
};

static bool is_blank(char c)
{
	return c == ' ' || c == '\t' || c == '\r';
}

/* Step to the next line that says something. */
static bool next_line(struct lines *lines)
{
	while (lines->rest < lines->end) {
		const char *start = lines->rest;
		const char *stop = memchr(start, '\n', (size_t)(lines->end - start));
		lines->rest = stop ? stop + 1 : lines->end;
		if (!stop)
			stop = lines->end;
		while (start < stop && is_blank(*start))
			start++;
		while (stop > start && is_blank(stop[-1]))
			stop--;
		lines->number++;
		lines->start = start;
		lines->length = (size_t)(stop - start);
		if (lines->length > 0 && *start != '#')
			return true;
	}
	return false;
}

/* Cut the first word off the line in hand. */
static size_t take_word(struct lines *lines, const char **out_word)
{
	size_t length = 0;
	*out_word = lines->start;
	while (length < lines->length && !is_blank(lines->start[length]))
		length++;
	lines->start += length;
	lines->length -= length;
	while (lines->length > 0 && is_blank(*lines->start)) {
		lines->start++;
		lines->length--;
	}
	return length;
}

enum gz_result gz_key_parse(const char *name, const char *text, size_t size,
			    const struct gz_log *log, char out_key[GZ_KEY_TEXT_SIZE])
{
	struct lines lines = { .rest = text, .end = text + size };
	char key[GZ_KEY_TEXT_SIZE] = "";
	while (next_line(&lines)) {
		if (!gz_key_valid(lines.start, lines.length) || key[0]) {
			gz_err(log,
			       "%s:%d: %s; keep one line with a key of %d characters, as gazectl "
			       "keygen writes it",
			       name, lines.number, key[0] ? "a second key" : "no key",
			       GZ_KEY_LENGTH);
			return GZ_ERR_FORMAT;
		}
		memcpy(key, lines.start, GZ_KEY_LENGTH);
		key[GZ_KEY_LENGTH] = '\0';
	}
	if (!key[0]) {
		gz_err(log, "%s: no key in it; make one anew by gazectl keygen", name);
		return GZ_ERR_FORMAT;
	}
	memcpy(out_key, key, sizeof key);
	return GZ_OK;
}

/* A comment or hosts: what is logged must not steer a terminal. */
static bool take_name(const char *text, size_t length, char out[GZ_KEY_NAME_SIZE])
{
	if (length >= GZ_KEY_NAME_SIZE)
		return false;
	for (size_t i = 0; i < length; i++) {
		if ((unsigned char)text[i] < ' ' || text[i] == 0x7f)
			return false;
	}
	memcpy(out, text, length);
	out[length] = '\0';
	return true;
}

/* What is wrong with the line in hand, or NULL. */
static const char *read_entry(struct lines *lines, enum gz_key_list_kind kind,
			      struct gz_known_key *out)
{
	const char *word;
	size_t length = take_word(lines, &word);
	if (kind == GZ_KEY_LIST_SERVERS) {
		if (!take_name(word, length, out->name))
			return "the host is longer than 127 bytes or holds control characters";
		length = take_word(lines, &word);
	}
	if (!gz_key_valid(word, length))
		return kind == GZ_KEY_LIST_SERVERS
			       ? "no key of 40 characters behind the host; write HOST KEY"
			       : "no key of 40 characters; write KEY and perhaps a comment";
	memcpy(out->key, word, GZ_KEY_LENGTH);
	out->key[GZ_KEY_LENGTH] = '\0';
	if (kind == GZ_KEY_LIST_AUTHORIZED && !take_name(lines->start, lines->length, out->name))
		return "the comment is longer than 127 bytes or holds control characters";
	return NULL;
}

/* Whether a host of @p entry has another key in @p list. */
static bool contradicts(const struct gz_key_list *list, const struct gz_known_key *entry)
{
	char host[GZ_KEY_NAME_SIZE];
	for (const char *rest = entry->name; *rest;) {
		size_t length = strcspn(rest, ",");
		memcpy(host, rest, length);
		host[length] = '\0';
		rest += length + (rest[length] == ',');
		const struct gz_known_key *other = gz_key_list_find_host(list, host);
		if (other && strcmp(other->key, entry->key) != 0)
			return true;
	}
	return false;
}

enum gz_result gz_key_list_parse(const char *name, const char *text, size_t size,
				 enum gz_key_list_kind kind, const struct gz_log *log,
				 struct gz_key_list *out_list)
{
	struct lines lines = { .rest = text, .end = text + size };
	out_list->count = 0;
	while (next_line(&lines)) {
		struct gz_known_key entry;
		if (out_list->count == GZ_KEYS_MAX) {
			gz_err(log, "%s:%d: more than %d keys; take some out", name, lines.number,
			       GZ_KEYS_MAX);
			return GZ_ERR_FULL;
		}
		const char *fault = read_entry(&lines, kind, &entry);
		if (!fault && kind == GZ_KEY_LIST_SERVERS && contradicts(out_list, &entry))
			fault = "a line above gives this host another key; keep the one that holds";
		if (fault) {
			gz_err(log, "%s:%d: %s", name, lines.number, fault);
			return GZ_ERR_FORMAT;
		}
		out_list->items[out_list->count++] = entry;
	}
	return GZ_OK;
}

const struct gz_known_key *gz_key_list_find_key(const struct gz_key_list *list, const char *key)
{
	for (size_t i = 0; i < list->count; i++) {
		if (strcmp(list->items[i].key, key) == 0)
			return &list->items[i];
	}
	return NULL;
}

static bool names_host(const char *hosts, const char *host)
{
	size_t wanted = strlen(host);
	for (;;) {
		size_t length = strcspn(hosts, ",");
		if (length == wanted && wanted > 0 && strncasecmp(hosts, host, wanted) == 0)
			return true;
		if (!hosts[length])
			return false;
		hosts += length + 1;
	}
}

const struct gz_known_key *gz_key_list_find_host(const struct gz_key_list *list, const char *host)
{
	for (size_t i = 0; i < list->count; i++) {
		if (names_host(list->items[i].name, host))
			return &list->items[i];
	}
	return NULL;
}
