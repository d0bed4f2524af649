#include "drivers/driver.h"

#include <string.h>

/* One driver a line. */
/* clang-format off */
const struct gz_driver *const gz_drivers[] = {
	&gz_driver_sim,
	&gz_driver_replay,
	&gz_driver_auto,
	&gz_driver_hid,
	&gz_driver_psvr2,
	&gz_driver_tobii5,
	&gz_driver_tobii,
	&gz_driver_gazepoint,
	&gz_driver_pupil,
	&gz_driver_pointer,
	&gz_driver_template,
	NULL,
};
/* clang-format on */

const struct gz_driver *gz_driver_find(const char *name)
{
	for (size_t i = 0; gz_drivers[i]; i++) {
		if (strcmp(gz_drivers[i]->name, name) == 0)
			return gz_drivers[i];
	}
	return NULL;
}
