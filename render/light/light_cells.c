#include "render/light/light_cells.h"

#include <stdlib.h>

#include "render/data/volume.h"

enum gz_result gz_light_cells_reserve(size_t count, uint16_t **cells, size_t *capacity)
{
	const size_t padding = GZ_VOLUME_PADDING / sizeof **cells;
	if (count > *capacity) {
		free(*cells);
		*cells = calloc(count + padding, sizeof **cells);
		*capacity = *cells ? count : 0;
	}
	return *cells ? GZ_OK : GZ_ERR_NO_MEM;
}
