/* Pictures from anywhere: whatever the bytes, a text that is found is whole. */
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "render/picture/image.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	struct gz_text text = { 0 };
	FILE *file = size > 0 ? fmemopen((void *)(uintptr_t)data, size, "rb") : NULL;
	if (!file)
		return 0;
	const enum gz_result result = gz_image_find_text(file, "gazecast.scene", &text);
	if (result == GZ_OK && text.length > 0 &&
	    (text.length > GZ_IMAGE_TEXT_MAX || text.bytes[text.length] != '\0'))
		abort();
	gz_text_free(&text);
	fclose(file);
	return 0;
}
