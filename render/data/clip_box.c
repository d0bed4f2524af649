#include "render/data/clip_box.h"

#define AT(field) offsetof(struct gz_clip_box, field)

const struct gz_option gz_clip_options[] = {
	{ "clip.least", GZ_OPTION_DOUBLE, AT(least), 0, 1, .count = 3, .preset = "0 0 0",
	  .help = "lower clip bounds along x, y, z, as fractions of the box" },
	{ "clip.greatest", GZ_OPTION_DOUBLE, AT(greatest), 0, 1, .count = 3, .preset = "1 1 1",
	  .help = "upper clip bounds along x, y, z, as fractions of the box" },
};
const size_t gz_clip_option_count = sizeof gz_clip_options / sizeof gz_clip_options[0];

bool gz_clip_box_valid(const struct gz_clip_box *clip)
{
	for (int axis = 0; axis < 3; axis++)
		if (!(clip->least[axis] < clip->greatest[axis]))
			return false;
	return gz_options_hold(gz_clip_options, gz_clip_option_count, clip);
}

bool gz_clip_box_same(const struct gz_clip_box *a, const struct gz_clip_box *b)
{
	return gz_options_same(gz_clip_options, gz_clip_option_count, a, b);
}
