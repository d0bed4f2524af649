#include "render/decode/minc/minc_load.h"

#include "render/data/slice_import.h"
#include "render/decode/minc/minc_image.h"

static enum gz_result read_minc_slice(void *user, uint64_t index, void *numbers)
{
	return gz_minc_image_read(user, index, numbers);
}

enum gz_result gz_minc_load(const struct gz_volume_file *file, const char *choice,
			    struct gz_volume *out_volume)
{
	struct gz_minc_image *image = NULL;
	(void)choice;
	enum gz_result result = gz_minc_image_open(file, &image);
	if (result == GZ_OK) {
		const struct gz_slice_source source = { read_minc_slice, image,
							gz_minc_image_bytes_bound(image) };
		result = gz_volume_import_slices(&source, gz_minc_image_layout(image), file,
						 out_volume);
	}
	gz_minc_image_close(&image);
	return result;
}
