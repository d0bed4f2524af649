#include "suite.h"

#include "driver_stage.h"

#include <stdio.h>
#include <string.h>

#include "base/clock.h"

static void remember_line(void *user, enum gz_log_level level, const char *module,
			  const char *message)
{
	struct driver_stage *stage = user;
	(void)level;
	(void)module;
	size_t used = strlen(stage->logged);
	snprintf(stage->logged + used, sizeof stage->logged - used, "%s\n", message);
}

void stage_reset(struct driver_stage *stage, const char *driver)
{
	memset(stage, 0, sizeof *stage);
	stage->driver = gz_driver_find(driver);
	assert_non_null(stage->driver);
	assert_true(stage->driver->settings_size <= sizeof stage->settings);
	gz_log_init(&stage->log, remember_line, stage, "*:debug");
	stage->host.log = &stage->log;
	struct gz_option_binding binding = { stage->driver->options, *stage->driver->option_count,
					     stage->settings, NULL };
	assert_int_equal(gz_options_preset(&binding), GZ_OK);
}

void stage_set(struct driver_stage *stage, const char *key, const char *text)
{
	struct gz_option_binding binding = { stage->driver->options, *stage->driver->option_count,
					     stage->settings, NULL };
	const struct gz_option *option = gz_options_find(&binding, 1, key, NULL);
	char message[256] = "";
	assert_non_null(option);
	if (gz_option_parse(option, text, stage->settings, message, sizeof message) != GZ_OK)
		fail_msg("%s: %s", key, message);
}

enum gz_result stage_create(struct driver_stage *stage, const char *choice,
			    struct gz_device **out_device)
{
	*out_device = NULL;
	stage->host.choice = choice;
	return stage->driver->create(stage->settings, &stage->host, out_device);
}

struct gz_device *stage_open(struct driver_stage *stage, const char *choice)
{
	struct gz_device *device;
	enum gz_result result = stage_create(stage, choice, &device);
	if (result != GZ_OK)
		fail_msg("%s: %s: %s", stage->driver->name, gz_result_text(result), stage->logged);
	assert_non_null(device);
	return device;
}

struct gz_device *stage_start(struct driver_stage *stage)
{
	struct gz_device *device = stage_open(stage, NULL);
	assert_int_equal(gz_device_start(device), GZ_OK);
	return device;
}

size_t stage_list(struct driver_stage *stage, struct gz_device_entry *out_entries)
{
	return stage->driver->list(stage->settings, &stage->host, out_entries);
}

void stage_expect_logged(const struct driver_stage *stage, const char *text)
{
	if (!strstr(stage->logged, text))
		fail_msg("not logged: \"%s\"; but:\n%s", text, stage->logged);
}

enum gz_result device_read_result(struct gz_device *device, struct gz_sample *out_sample)
{
	int64_t deadline_ns = gz_clock_now_ns() + PATIENCE_NS;
	enum gz_result result;
	do
		result = gz_device_read(device, 20, out_sample);
	while (result == GZ_ERR_TIMEOUT && gz_clock_now_ns() < deadline_ns);
	return result;
}

struct gz_sample device_read_sample(struct gz_device *device)
{
	struct gz_sample sample;
	enum gz_result result = device_read_result(device, &sample);
	if (result != GZ_OK)
		fail_msg("no sample: %s", gz_result_text(result));
	return sample;
}

struct gz_device_counters device_counters(const struct gz_device *device)
{
	struct gz_device_counters counters;
	gz_device_get_counters(device, &counters);
	return counters;
}
