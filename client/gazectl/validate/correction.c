#include "client/gazectl/validate/correction.h"

#include <errno.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "base/clock.h"
#include "protocol/correction_file.h"

#define GZ_LOG_MODULE "gazectl"

/* Chosen: a status comes at once where a correction has changed, and once a second in any case. */
#define STATUS_PATIENCE_NS (3 * GZ_NS_PER_S)

static const struct gz_correct_params NO_CORRECTION = { { 0, 1, 0 }, { 0, 0, 1 } };

static enum gz_result find_path(const struct gazectl_correction *correction,
				const struct gz_status *status, char *path, size_t size)
{
	char directory[GZ_PATH_SIZE];
	enum gz_result result = GZ_OK;
	if (correction->directory[0])
		snprintf(directory, sizeof directory, "%s", correction->directory);
	else
		result = gz_correction_directory(directory, sizeof directory);
	if (result == GZ_OK)
		result = gz_correction_path(directory, status->tracker.name, status->tracker.serial,
					    &status->display, path, size);
	if (result != GZ_OK)
		gz_err(correction->log,
		       "no directory for corrections: %s; name one with "
		       "--corrections DIR",
		       gz_result_text(result));
	return result;
}

static bool is_in_force(const struct gz_status *status, const struct gz_correct_params *map)
{
	return memcmp(status->correction.x, map->x, sizeof map->x) == 0 &&
	       memcmp(status->correction.y, map->y, sizeof map->y) == 0;
}

/* Ask the daemon to look, and wait until its status tells that @p map is in force. */
static enum gazectl_exit apply(const struct gazectl_correction *correction,
			       const struct gz_correct_params *map, const char *path)
{
	char reply[GZ_CONTROL_REPLY_SIZE];
	struct gz_status status;
	enum gazectl_exit exit_status =
		gazectl_request(correction->control, "CORRECTION", correction->log, reply);
	if (exit_status != GAZECTL_DONE)
		return exit_status;
	int64_t deadline_ns = gz_clock_now_ns() + STATUS_PATIENCE_NS;
	while (gazectl_next_status(correction->stream, deadline_ns, &status))
		if (is_in_force(&status, map))
			return GAZECTL_DONE;
	gz_err(correction->log,
	       "the daemon does not follow: it reads its corrections elsewhere "
	       "(tracker.corrections "
	       "in gazed.conf, and --corrections here), or was given one on its command line; %s",
	       path);
	return GAZECTL_FAILED;
}

static struct gz_correction_file describe(const struct gz_validation *validation,
					  const struct gz_correct_params *map)
{
	const struct gz_status *status = &validation->status;
	struct gz_correction_file file = {
		.display_px = { status->display.px[0], status->display.px[1] },
		.display_mm = { status->display.mm[0], status->display.mm[1] },
		.distance_mm = status->display.distance_mm,
		.before_deg = validation->fit.before_deg,
		.after_deg = validation->fit.cross_deg,
	};
	gz_correction_name(status->tracker.name, file.tracker);
	gz_correction_name(status->tracker.serial, file.serial);
	memcpy(file.x, map->x, sizeof file.x);
	memcpy(file.y, map->y, sizeof file.y);
	memcpy(file.measured, validation->started, sizeof validation->started);
	return file;
}

enum gazectl_exit gazectl_correction_store(const struct gazectl_correction *correction,
					   const struct gz_validation *validation)
{
	char path[2 * GZ_PATH_SIZE];
	struct gz_correct_params before;
	if (!validation->fit.helps) {
		gz_warn(correction->log, "a correction would not help; none is stored");
		return GAZECTL_DONE;
	}
	memcpy(before.x, validation->status.correction.x, sizeof before.x);
	memcpy(before.y, validation->status.correction.y, sizeof before.y);
	struct gz_correct_params map = gz_fit_compose(&before, &validation->fit.map);
	if (!gz_correct_usable(&map)) {
		gz_err(correction->log, "together with the correction in force this one leaves no "
					"area: remove that with --forget, and check again");
		return GAZECTL_FAILED;
	}
	struct gz_correction_file file = describe(validation, &map);
	if (find_path(correction, &validation->status, path, sizeof path) != GZ_OK ||
	    gz_correction_write(path, &file, correction->log) != GZ_OK)
		return GAZECTL_FAILED;
	enum gazectl_exit status = apply(correction, &map, path);
	if (status == GAZECTL_DONE)
		gz_info(correction->log, "stored in %s, and in force", path);
	return status;
}

enum gazectl_exit gazectl_correction_forget(const struct gazectl_correction *correction,
					    const struct gz_status *status)
{
	char path[2 * GZ_PATH_SIZE];
	if (find_path(correction, status, path, sizeof path) != GZ_OK)
		return GAZECTL_FAILED;
	if (unlink(path) != 0) {
		gz_err(correction->log, "cannot remove %s: %s", path,
		       errno == ENOENT ? "nothing is stored there for this tracker and display"
				       : strerror(errno));
		return GAZECTL_FAILED;
	}
	enum gazectl_exit exit_status = apply(correction, &NO_CORRECTION, path);
	if (exit_status == GAZECTL_DONE)
		gz_info(correction->log, "%s is removed; gaze is no longer corrected", path);
	return exit_status;
}
