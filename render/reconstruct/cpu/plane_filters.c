/* The choice of filters of planes other than colours. */
#include <string.h>

#include "render/reconstruct/cpu/reconstruct.h"

static const struct gz_plane_filters *find_plane_filters(const char *name)
{
	static const struct gz_plane_filters *const all[] = {
#ifdef GZ_CAST_X86
		&gz_plane_filters_avx512,
		&gz_plane_filters_avx2,
#endif
		&gz_plane_filters_portable,
	};
	for (size_t i = 0; i < sizeof all / sizeof all[0]; i++)
		if (strcmp(all[i]->name, name) == 0)
			return all[i];
	return &gz_plane_filters_portable;
}

struct gz_row_filters gz_row_filters_of_plane(enum gz_plane_kind kind,
					      const struct gz_row_filters *colours)
{
	struct gz_row_filters filters = *colours;
	const struct gz_plane_filters *found = find_plane_filters(colours->name);
	const struct gz_row_filters *own = kind == GZ_PLANE_VALUE ? found->values : found->ids;
	if (kind == GZ_PLANE_COLOUR || kind == GZ_PLANE_DEEP_COLOUR)
		return filters;
	filters.double_cubic = own->double_cubic;
	filters.double_mean = own->double_mean;
	filters.quincunx_cubic = own->quincunx_cubic;
	filters.quincunx_mean = own->quincunx_mean;
	filters.span = own->span;
	filters.blend = own->blend;
	return filters;
}
