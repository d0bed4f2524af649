/* gazecast-udev-id FILE: whether a HID report descriptor contains an eye tracker. For
 * IMPORT{program} of udev, because udev does not know usage pages. Prints "GAZECAST_EYE_TRACKER=1"
 * or nothing. Runs as root on bytes from any device that is plugged in: reads at most 4 KiB and
 * parses them as gazed does. */
#include <stdio.h>
#include <stdlib.h>

#include "drivers/hid/hid_descriptor.h"
#include "drivers/hid/hid_tracker.h"

/* A refused descriptor is not an eye tracker that gazed could read. */
static bool contains_eye_tracker(FILE *file)
{
	/* Large, and needed once. */
	static struct gz_hid_descriptor descriptor;
	static unsigned char bytes[GZ_HID_DESCRIPTOR_SIZE + 1];
	size_t size = fread(bytes, 1, sizeof bytes, file);
	return gz_hid_descriptor_parse(bytes, size, &descriptor, NULL) == GZ_OK &&
	       gz_hid_tracker_count(&descriptor) > 0;
}

int main(int argc, char **argv)
{
	if (argc != 2) {
		fputs("usage: gazecast-udev-id REPORT-DESCRIPTOR-FILE\n", stderr);
		return 2;
	}
	FILE *file = fopen(argv[1], "re");
	if (!file) {
		perror(argv[1]);
		return EXIT_FAILURE;
	}
	if (contains_eye_tracker(file))
		puts("GAZECAST_EYE_TRACKER=1");
	fclose(file);
	return fflush(stdout) == 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}
