/* Names and sizes from anywhere: what is offered fits. The first eight bytes are the size. */
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "render/data/raw_guess.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	struct gz_raw_guess guesses[GZ_RAW_GUESSES_MAX];
	char name[512];
	uint64_t bytes;
	if (size < sizeof bytes || size - sizeof bytes >= sizeof name)
		return 0;
	memcpy(&bytes, data, sizeof bytes);
	memcpy(name, data + sizeof bytes, size - sizeof bytes);
	name[size - sizeof bytes] = '\0';
	const size_t count = gz_raw_guess(name, bytes, guesses, GZ_RAW_GUESSES_MAX);
	for (size_t i = 0; i < count; i++) {
		const uint64_t fits = gz_raw_layout_bytes(&guesses[i].layout);
		if (fits == 0 || (bytes > 0 && fits != bytes) ||
		    !memchr(guesses[i].reason, '\0', sizeof guesses[i].reason))
			abort();
		for (int axis = 0; axis < 3; axis++)
			if (!(guesses[i].layout.spacing[axis] >= 0)) /* 0: not known */
				abort();
	}
	return count > GZ_RAW_GUESSES_MAX;
}
