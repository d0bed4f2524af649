/* Stored corrections and the lines of gazeview, from anywhere: what is accepted is finite, in its
 * range, and ends within its buffer. */
#include <math.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "client/gazectl/validate/viewer_process.h"
#include "protocol/correction_file.h"
#include "protocol/validated_file.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static void require(bool holds)
{
	if (!holds)
		abort();
}

static void try_file(const char *text, size_t size)
{
	struct gz_correction_file file;
	char name[GZ_NAME_SIZE];
	if (gz_correction_parse("fuzz", text, size, NULL, &file) != GZ_OK)
		return;
	for (int i = 0; i < 3; i++)
		require(fabs(file.x[i]) <= 10 && fabs(file.y[i]) <= 10);
	require(file.display_px[0] >= 1 && file.display_mm[1] > 0 && file.distance_mm > 0);
	require(memchr(file.tracker, '\0', sizeof file.tracker) != NULL);
	require(memchr(file.measured, '\0', sizeof file.measured) != NULL);
	gz_correction_name(file.serial, name);
	require(strchr(name, '/') == NULL && name[0] != '.');
}

static void try_validated(const char *text, size_t size)
{
	struct gz_validated validated;
	const struct gz_display display = gz_display_default(1920, 1080);
	const struct gz_monitor_place nowhere = { .scale = 0 };
	char changed[GZ_REASON_SIZE];
	if (gz_validated_parse("fuzz", text, size, NULL, &validated) != GZ_OK)
		return;
	require(gz_display_valid(&validated.display) && validated.accuracy_deg >= 0);
	require(memchr(validated.measured, '\0', sizeof validated.measured) != NULL);
	gz_validated_changed(&validated, &display, &validated.monitor, changed);
	require(memchr(changed, '\0', sizeof changed) != NULL);
	gz_validated_changed(&validated, &validated.display, &nowhere, changed);
	require(changed[0] == '\0');
}

static void try_line(const char *text, size_t size)
{
	struct gz_viewer_event event;
	char line[2 * GZ_VIEWER_LINE_SIZE];
	size_t length = size < sizeof line ? size : sizeof line - 1;
	memcpy(line, text, length);
	line[length] = '\0';
	if (gz_viewer_event_parse(line, &event) != GZ_OK)
		return;
	require(event.kind != GZ_VIEWER_SHOWN || event.index < event.count);
	require(isfinite(event.point.x) && isfinite(event.point.y));
	require(event.time_ns >= 0 && event.monitor.px[0] >= 0 && event.monitor.px[1] >= 0);
	require(event.monitor.scale >= 0 && event.monitor.scale <= GZ_MONITOR_SCALE_MAX);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	const char *text = size > 0 ? (const char *)data : "";
	try_file(text, size);
	try_validated(text, size);
	try_line(text, size);
	return 0;
}
