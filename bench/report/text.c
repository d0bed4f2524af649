#include "bench/report/text.h"

#include <stdint.h>

void gz_text_add_escaped(struct gz_text *text, const char *plain)
{
	for (; *plain; plain++) {
		switch (*plain) {
		case '&':
			gz_text_add(text, "&amp;");
			break;
		case '<':
			gz_text_add(text, "&lt;");
			break;
		case '>':
			gz_text_add(text, "&gt;");
			break;
		case '"':
			gz_text_add(text, "&quot;");
			break;
		case '\'':
			gz_text_add(text, "&#39;");
			break;
		default:
			if ((unsigned char)*plain >= ' ' || *plain == '\n' || *plain == '\t')
				gz_text_add_bytes(text, plain, 1);
		}
	}
}

void gz_text_add_base64(struct gz_text *text, const void *bytes, size_t size)
{
	static const char digits[] =
		"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
	const unsigned char *from = bytes;
	for (size_t i = 0; i < size; i += 3) {
		const size_t here = size - i < 3 ? size - i : 3;
		uint32_t group = (uint32_t)from[i] << 16;
		if (here > 1)
			group |= (uint32_t)from[i + 1] << 8;
		if (here > 2)
			group |= from[i + 2];
		const char four[4] = { digits[group >> 18], digits[group >> 12 & 63],
				       here > 1 ? digits[group >> 6 & 63] : '=',
				       here > 2 ? digits[group & 63] : '=' };
		gz_text_add_bytes(text, four, sizeof four);
	}
}
