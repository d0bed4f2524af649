#include "bench/report/palette.h"

#include <string.h>

struct entry {
	const char *method; /* NULL: none */
	uint32_t light, dark;
	int point;
};

static const struct entry entries[] = {
	{ "standard", 0x3d444d, 0xc9d1d9, 5 }, { "acuity", 0xb84700, 0xff9a52, 7 },
	{ "mdc", 0x0067a3, 0x62bbf2, 9 },      { "ddc", 0x00755a, 0x41cfa4, 13 },
	{ "mdc3", 0x7c3a9a, 0xd6a1f0, 11 },    { "uniform", 0x6b5f00, 0xd9c64a, 15 },
	{ "table", 0xa6265e, 0xf590b8, 4 },    { NULL, GZ_COLOUR_INK, 0xe6e9ed, 0 },
	{ NULL, GZ_COLOUR_GRID, 0x2c3239, 0 }, { NULL, GZ_COLOUR_MUTE, 0x9aa4af, 0 },
	{ NULL, GZ_COLOUR_PALE, 0x47505a, 0 }, { NULL, GZ_COLOUR_PAGE, 0x14171b, 0 },
};

struct gz_method_look gz_method_look(const char *method)
{
	for (size_t i = 0; i < sizeof entries / sizeof entries[0]; i++)
		if (entries[i].method && strcmp(entries[i].method, method) == 0)
			return (struct gz_method_look) { entries[i].light, entries[i].point };
	return (struct gz_method_look) { GZ_COLOUR_MUTE, 6 };
}

/* gnuplot writes a colour in two ways. */
static void add_rule(struct gz_text *out, const char *attribute, uint32_t light, uint32_t dark)
{
	const int r = (int)(light >> 16), g = (int)(light >> 8 & 255), b = (int)(light & 255);
	gz_text_add(out,
		    "[%s=\"rgb(%3d, %3d, %3d)\"],[%s=\"rgb(%d,%d,%d)\"]"
		    "{%s:#%06x}\n",
		    attribute, r, g, b, attribute, r, g, b, attribute, dark);
}

void gz_palette_add_dark(struct gz_text *out, const char *svg)
{
	const char *end = strstr(svg, "<svg");
	end = end ? strchr(end, '>') : NULL;
	if (!end) {
		gz_text_add(out, "%s", svg);
		return;
	}
	gz_text_add_bytes(out, svg, (size_t)(end + 1 - svg));
	gz_text_add(out, "\n<style>@media (prefers-color-scheme:dark){\n");
	for (size_t i = 0; i < sizeof entries / sizeof entries[0]; i++) {
		add_rule(out, "fill", entries[i].light, entries[i].dark);
		add_rule(out, "stroke", entries[i].light, entries[i].dark);
		add_rule(out, "color", entries[i].light, entries[i].dark);
	}
	gz_text_add(out, "}</style>%s", end + 1);
}
