#include <stddef.h>
#include <string.h>

#include "render/reconstruct/cpu/reconstruct.h"

const struct gz_row_filters *gz_row_filters_find(const char *name)
{
	static const struct gz_row_filters *const all[] = {
#ifdef GZ_CAST_X86
		&gz_row_filters_avx512,
		&gz_row_filters_avx2,
#endif
		&gz_row_filters_portable,
	};
	for (size_t i = 0; i < sizeof all / sizeof all[0]; i++)
		if (strcmp(all[i]->name, name) == 0)
			return all[i];
	return &gz_row_filters_portable;
}
