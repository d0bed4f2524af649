#include "base/ini_text.h"

#include <string.h>

static const char blanks[] = " \t\r";

/* A line of an INI text, without its end, and what it is. */
struct line {
	const char *start, *end;
	const char *name, *name_end; /* NULL where it gives no value */
	const char *value;           /* behind the '=' and blanks */
	bool is_section, is_comment;
};

static const char *skip_blanks(const char *at, const char *end)
{
	while (at < end && strchr(blanks, *at))
		at++;
	return at;
}

static const char *trim_blanks(const char *start, const char *end)
{
	while (end > start && strchr(blanks, end[-1]))
		end--;
	return end;
}

static struct line read_line(const char *start, const char *text_end)
{
	const char *end = memchr(start, '\n', (size_t)(text_end - start));
	struct line line = { .start = start, .end = end ? end : text_end };
	const char *first = skip_blanks(start, line.end);
	line.is_comment = first < line.end && (*first == ';' || *first == '#');
	line.is_section = first < line.end && *first == '[';
	if (line.is_section) {
		const char *close = memchr(first, ']', (size_t)(line.end - first));
		line.name = first + 1;
		line.name_end = close ? close : line.end;
	} else if (!line.is_comment) {
		const char *sign = first;
		while (sign < line.end && *sign != '=' && *sign != ':')
			sign++;
		if (sign < line.end) {
			line.name = first;
			line.name_end = trim_blanks(first, sign);
			line.value = skip_blanks(sign + 1, line.end);
		}
	}
	return line;
}

static bool is_called(const struct line *line, const char *name)
{
	const size_t length = strlen(name);
	return line->name && (size_t)(line->name_end - line->name) == length &&
	       strncmp(line->name, name, length) == 0;
}

/* Where a value ends: before a ';' behind a blank, and before blanks. */
static const char *end_of_value(const struct line *line)
{
	const char *end = line->end;
	for (const char *at = line->value; at < line->end; at++)
		if (*at == ';' && at > line->start && strchr(blanks, at[-1])) {
			end = at;
			break;
		}
	return trim_blanks(line->value, end);
}

/* The place in a text where a key is set. */
struct place {
	size_t from, to;    /* what is replaced */
	bool found;         /* the key is there */
	size_t line, next;  /* then where its line begins, and the one behind it */
	bool section_found; /* else its section is, and it goes to `from` */
};

static struct place find_place(const struct gz_text *text, const char *section, const char *name)
{
	struct place place = { .from = text->length, .to = text->length };
	const char *end = text->bytes + text->length;
	bool inside = false;
	for (const char *at = text->bytes; at && at < end;) {
		const struct line line = read_line(at, end);
		at = line.end < end ? line.end + 1 : end;
		if (line.is_section)
			inside = is_called(&line, section);
		if (!inside)
			continue;
		if (!line.is_section && is_called(&line, name)) {
			place.from = (size_t)(line.value - text->bytes);
			place.to = (size_t)(end_of_value(&line) - text->bytes);
			place.line = (size_t)(line.start - text->bytes);
			place.next = (size_t)(at - text->bytes);
			place.found = true;
			return place;
		}
		if (line.is_section || line.name) {
			place.from = place.to = (size_t)(at - text->bytes);
			place.section_found = true;
		}
	}
	return place;
}

void gz_ini_text_set(struct gz_text *text, const char *section, const char *name, const char *value)
{
	struct gz_text edited = { 0 };
	const struct place place = find_place(text, section, name);
	const char *bytes = text->bytes ? text->bytes : "";
	gz_text_add_bytes(&edited, bytes, place.from);
	if (place.found) {
		gz_text_add(&edited, "%s", value);
	} else {
		if (edited.length > 0 && edited.bytes[edited.length - 1] != '\n')
			gz_text_add(&edited, "\n");
		if (!place.section_found)
			gz_text_add(&edited, "[%s]\n", section);
		gz_text_add(&edited, "%s = %s\n", name, value);
	}
	gz_text_add_bytes(&edited, bytes + place.to, text->length - place.to);
	edited.failed |= text->failed;
	gz_text_free(text);
	*text = edited;
}

bool gz_ini_text_remove(struct gz_text *text, const char *section, const char *name)
{
	const struct place place = find_place(text, section, name);
	if (!place.found)
		return false;
	memmove(text->bytes + place.line, text->bytes + place.next, text->length - place.next + 1);
	text->length -= place.next - place.line;
	return true;
}

bool gz_ini_text_has(const struct gz_text *text, const char *section, const char *name)
{
	return find_place(text, section, name).found;
}
