#include "drivers/driver.h"

#include <string.h>

#include "drivers/auto/auto_driver.h"
#include "drivers/gazepoint/gazepoint_driver.h"
#include "drivers/hid/hid_driver.h"
#include "drivers/pointer/pointer_driver.h"
#include "drivers/psvr2/psvr2_driver.h"
#include "drivers/pupil/pupil_driver.h"
#include "drivers/replay/replay_driver.h"
#include "drivers/sim/sim_driver.h"
#include "drivers/template/template_driver.h"
#include "drivers/tobii/tobii_driver.h"

/* clang-format off: one a line, because everybody adds to it. Players first, then what is on USB. */
const struct gz_driver *const gz_drivers[] = {
	&gz_driver_sim,
	&gz_driver_replay,
	&gz_driver_auto,
	&gz_driver_hid,
	&gz_driver_psvr2,
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

enum gz_result gz_device_start(struct gz_device *device)
{
	return device->ops->start(device);
}

enum gz_result gz_device_read(struct gz_device *device, int timeout_ms,
			      struct gz_sample *out_sample)
{
	if (timeout_ms < 0)
		return GZ_ERR_INVAL;
	return device->ops->read(device, timeout_ms, out_sample);
}

void gz_device_get_info(const struct gz_device *device, struct gz_device_info *out_info)
{
	*out_info = (struct gz_device_info) { 0 };
	device->ops->info(device, out_info);
}

void gz_device_get_counters(const struct gz_device *device, struct gz_device_counters *out_counters)
{
	*out_counters = (struct gz_device_counters) { 0 };
	device->ops->counters(device, out_counters);
}

void gz_device_destroy(struct gz_device **device)
{
	if (!device || !*device)
		return;
	(*device)->ops->destroy(*device);
	*device = NULL;
}
