/* The daemon's configuration file from anywhere: it is refused, or its settings are possible, and
 * print as a file that reads back to the same. */
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

#include "daemon/config.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

/* Longest printed file. */
enum { PRINTED_SIZE = 1 << 17 };

static void require(bool holds)
{
	if (!holds)
		abort();
}

static enum gz_result read_bytes(const void *bytes, size_t size, struct gz_config *out)
{
	char path[64];
	char *argv[] = { (char *)"gazed", (char *)"--config", path, NULL };
	int fd = memfd_create("config", 0);
	require(fd >= 0 && write(fd, bytes, size) == (ssize_t)size);
	snprintf(path, sizeof path, "/proc/self/fd/%d", fd);
	enum gz_result result = gz_config_read(3, argv, NULL, out);
	close(fd);
	return result;
}

static size_t print(struct gz_config *config, char *text)
{
	FILE *out = fmemopen(text, PRINTED_SIZE, "w");
	require(out != NULL);
	gz_config_print_file(config, out);
	long length = ftell(out);
	require(length > 0 && length < PRINTED_SIZE);
	fclose(out);
	return (size_t)length;
}

static void require_possible(const struct gz_config *config)
{
	const void *settings;
	require(gz_config_driver(config, &settings) != NULL);
	require(config->surface_count <= GZ_SURFACES_MAX);
	for (size_t i = 0; i < config->surface_count; i++)
		require(config->surface[i][0] && !strchr(config->surface[i], '/'));
	const struct gz_device_info info = { .rate_hz = 0 };
	struct gz_display display = gz_config_display(config, &info);
	require(gz_display_valid(&display));
	if (config->tcp == GZ_TCP_LOOPBACK)
		require(strncmp(config->control_endpoint, "tcp://127.", 10) == 0 ||
			strncmp(config->control_endpoint, "tcp://[::1]:", 12) == 0);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	static struct gz_config config, again;
	static char printed[PRINTED_SIZE], reprinted[PRINTED_SIZE];
	if (read_bytes(data, size, &config) != GZ_OK)
		return 0;
	require_possible(&config);
	size_t length = print(&config, printed);
	require(read_bytes(printed, length, &again) == GZ_OK);
	require(print(&again, reprinted) == length && memcmp(printed, reprinted, length) == 0);
	return 0;
}
