/**
 * @file
 * A recorded gaze log, delivered through the interface of a tracker: the samples as they were
 * recorded, with their numbers and times.
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/stat.h>

#include "base/clock.h"
#include "drivers/device/device.h"

#define GZ_LOG_MODULE "replay"

struct replay_settings {
	char file[GZ_PATH_SIZE];
	double speed;
};

#define AT(field) offsetof(struct replay_settings, field)

static const struct gz_option replay_options[] = {
	{ "replay.file", GZ_OPTION_STRING, AT(file), 0, GZ_PATH_SIZE, .preset = "",
	  .help = "gaze log to play (.gzl)" },
	{ "replay.speed", GZ_OPTION_DOUBLE, AT(speed), 0, 1000, .preset = "1",
	  .help = "speed, as a multiple of real time; 0 plays as fast as the log is read" },
};

static const size_t replay_option_count = sizeof replay_options / sizeof *replay_options;

struct replay_device {
	struct gz_device base;
	double speed;
	struct gz_gaze_log_reader *reader;
	struct gz_gaze_log_record record; /* the next sample, if has_next */
	bool has_next;
	bool ended;
	bool anchored;
	int64_t anchor_host_ns; /* recorded time that was delivered at anchor_now_ns */
	int64_t anchor_now_ns;
	int64_t last_host_ns; /* recorded time of the last sample */
	uint64_t gap;         /* samples missing since the last one */
	uint64_t lost;
	uint64_t malformed[GZ_MALFORMED_COUNT];
};

static struct replay_device *replay_device_of(struct gz_device *device)
{
	return (struct replay_device *)device;
}

static enum gz_result replay_start(struct gz_device *device)
{
	if (prctl(PR_SET_TIMERSLACK, 1) != 0)
		gz_debug(device->log,
			 "the timer slack cannot be reduced; samples arrive less evenly");
	return GZ_OK;
}

/* Find the next sample. @retval GZ_ERR_TIMEOUT  none yet in a long stretch without samples; call
 * again */
static enum gz_result find_recorded_sample(struct replay_device *replay, int64_t deadline_ns)
{
	while (!replay->has_next) {
		enum gz_result result = gz_gaze_log_read(replay->reader, &replay->record);
		if (result == GZ_ERR_FORMAT) {
			replay->malformed[GZ_MALFORMED_SYNTAX]++;
			if (gz_clock_now_ns() >= deadline_ns)
				return GZ_ERR_TIMEOUT;
			continue;
		}
		if (result != GZ_OK)
			return GZ_ERR_END; /* the reader has logged the reason, if it is an error */
		replay->has_next = replay->record.kind == GZ_GAZE_LOG_SAMPLE;
		if (replay->record.kind == GZ_GAZE_LOG_GAP)
			replay->gap += replay->record.missing;
	}
	return GZ_OK;
}

/* Host time at which the next sample is due. If the recorded time runs backwards, the sample is due
 * at once and the recorded time continues from there. */
static int64_t recorded_due_ns(struct replay_device *replay, int64_t now_ns)
{
	int64_t host_ns = replay->record.sample.host_ns;
	if (!replay->anchored || host_ns < replay->last_host_ns) {
		replay->anchored = true;
		replay->anchor_host_ns = host_ns;
		replay->anchor_now_ns = now_ns;
	}
	/* In doubles: a log may hold any times, and their difference may not fit 64 bits. */
	double ahead_ns = ((double)host_ns - (double)replay->anchor_host_ns) / replay->speed;
	double limit_ns = (double)(INT64_MAX / 2);
	return replay->anchor_now_ns + (int64_t)(ahead_ns < limit_ns ? ahead_ns : limit_ns);
}

static void deliver_recorded(struct replay_device *replay, struct gz_sample *out_sample)
{
	*out_sample = replay->record.sample;
	/* A pupil in another unit is not a diameter in mm, which readers expect. */
	if (gz_gaze_log_header(replay->reader)->pupil_unit[0])
		out_sample->eye[GZ_EYE_RIGHT].pupil_mm = out_sample->eye[GZ_EYE_LEFT].pupil_mm =
			NAN;
	out_sample->lost_before = replay->gap > UINT32_MAX ? UINT32_MAX : (uint32_t)replay->gap;
	replay->lost += replay->gap;
	replay->gap = 0;
	replay->last_host_ns = out_sample->host_ns;
	replay->has_next = false;
}

static enum gz_result replay_read(struct gz_device *device, int timeout_ms,
				  struct gz_sample *out_sample)
{
	struct replay_device *replay = replay_device_of(device);
	int64_t now_ns = gz_clock_now_ns();
	int64_t deadline_ns = now_ns + timeout_ms * GZ_NS_PER_MS;
	if (replay->ended)
		return GZ_ERR_END;
	enum gz_result result = find_recorded_sample(replay, deadline_ns);
	replay->ended = result == GZ_ERR_END;
	if (result != GZ_OK)
		return result;
	if (replay->speed > 0) {
		int64_t due = recorded_due_ns(replay, now_ns);
		gz_clock_sleep_until_ns(due < deadline_ns ? due : deadline_ns);
		if (due > deadline_ns)
			return GZ_ERR_TIMEOUT;
	}
	deliver_recorded(replay, out_sample);
	return GZ_OK;
}

static void replay_info(const struct gz_device *device, struct gz_device_info *out_info)
{
	const struct replay_device *replay = (const struct replay_device *)device;
	const struct gz_gaze_log_header *header = gz_gaze_log_header(replay->reader);
	out_info->rate_hz = header->rate_hz;
	out_info->on_demand = replay->speed == 0;
	out_info->has_display = header->has_display;
	out_info->display = header->display;
	out_info->recorded = header;
	memcpy(out_info->name, header->tracker, sizeof out_info->name);
	memcpy(out_info->serial, header->serial, sizeof out_info->serial);
}

static void replay_counters(const struct gz_device *device, struct gz_device_counters *out_counters)
{
	const struct replay_device *replay = (const struct replay_device *)device;
	out_counters->lost = replay->lost;
	memcpy(out_counters->malformed, replay->malformed, sizeof out_counters->malformed);
}

static void replay_destroy(struct gz_device *device)
{
	struct replay_device *replay = replay_device_of(device);
	gz_gaze_log_close(&replay->reader);
	free(replay);
}

static const struct gz_device_ops replay_ops = {
	.start = replay_start,
	.read = replay_read,
	.info = replay_info,
	.counters = replay_counters,
	.destroy = replay_destroy,
};

/* Only regular files: opening or reading a FIFO could block for ever. */
static enum gz_result open_replay_log(const char *path, const struct gz_log *log,
				      struct gz_gaze_log_reader **out_reader)
{
	struct stat status;
	if (stat(path, &status) == 0 && !S_ISREG(status.st_mode)) {
		gz_err(log, "%s is not a regular file; name a gaze log with --replay.file", path);
		return GZ_ERR_INVAL;
	}
	enum gz_result result = gz_gaze_log_open(path, log, out_reader);
	/* The daemon waits for a missing device; a file that cannot be read will not become
	 * readable. */
	return result == GZ_ERR_IO ? GZ_ERR_INVAL : result;
}

static enum gz_result replay_create(const void *settings, const struct gz_driver_host *host,
				    struct gz_device **out_device)
{
	const struct gz_log *log = host->log;
	const struct replay_settings *wanted = settings;
	if (!wanted->file[0]) {
		gz_err(log, "no gaze log given; name one with --replay.file FILE.gzl");
		return GZ_ERR_INVAL;
	}
	struct replay_device *replay = calloc(1, sizeof *replay);
	if (!replay)
		return GZ_ERR_NO_MEM;
	replay->base = (struct gz_device) { .ops = &replay_ops, .log = log };
	replay->speed = wanted->speed;
	enum gz_result result = open_replay_log(wanted->file, log, &replay->reader);
	if (result != GZ_OK) {
		replay_destroy(&replay->base);
		return result;
	}
	*out_device = &replay->base;
	return GZ_OK;
}

_Static_assert(sizeof(struct replay_settings) <= GZ_DRIVER_SETTINGS_SIZE, "settings fit");

const struct gz_driver gz_driver_replay = {
	.name = "replay",
	.help = "a recorded gaze log, with the settings it was recorded with",
	.options = replay_options,
	.option_count = &replay_option_count,
	.settings_size = sizeof(struct replay_settings),
	.create = replay_create,
};
