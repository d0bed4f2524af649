#include "base/utf8.h"

#include <stdbool.h>
#include <string.h>

size_t gz_utf8_length(const char *text, size_t left)
{
	const unsigned char *bytes = (const unsigned char *)text;
	const unsigned char lead = bytes[0];
	if (lead < 0x80)
		return 1;
	const size_t length = lead >= 0xf0 ? 4 : lead >= 0xe0 ? 3 : 2;
	unsigned char low = 0x80, high = 0xbf; /* allowed in the second byte */
	if (lead < 0xc2 || lead > 0xf4 || length > left)
		return 0;
	if (lead == 0xe0)
		low = 0xa0;
	else if (lead == 0xed)
		high = 0x9f;
	else if (lead == 0xf0)
		low = 0x90;
	else if (lead == 0xf4)
		high = 0x8f;
	if (bytes[1] < low || bytes[1] > high)
		return 0;
	for (size_t i = 2; i < length; i++)
		if ((bytes[i] & 0xc0) != 0x80)
			return 0;
	return length;
}

/* Whether the character is one of U+0000 to U+001F or U+007F to U+009F. */
static bool is_control(const unsigned char *character)
{
	if (character[0] < 0x80)
		return character[0] < 0x20 || character[0] == 0x7f;
	return character[0] == 0xc2 && character[1] < 0xa0;
}

void gz_utf8_clean(char *text)
{
	size_t left = strlen(text);
	while (left > 0) {
		size_t length = gz_utf8_length(text, left);
		if (length == 0 || is_control((const unsigned char *)text)) {
			length = length ? length : 1;
			memset(text, '?', length);
		}
		text += length;
		left -= length;
	}
}
