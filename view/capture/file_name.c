#include "view/capture/file_name.h"

#include <stdio.h>
#include <time.h>
#include <unistd.h>

/* More within one second do not happen. */
enum { NUMBERS = 100 };

enum gz_result gz_capture_name(const char *folder, const char *ending, char out_path[GZ_PATH_SIZE])
{
	char when[32], number[8] = "", path[GZ_PATH_SIZE];
	const time_t now = time(NULL);
	struct tm local;
	localtime_r(&now, &local);
	strftime(when, sizeof when, "%Y%m%d-%H%M%S", &local);
	for (int i = 1; i <= NUMBERS; i++) {
		if (i > 1)
			snprintf(number, sizeof number, "_%d", i);
		const int length = snprintf(path, sizeof path, "%s/gazeview-%s%s%s", folder, when,
					    number, ending);
		if (length < 0 || length >= GZ_PATH_SIZE)
			return GZ_ERR_FULL;
		if (access(path, F_OK) != 0) {
			snprintf(out_path, GZ_PATH_SIZE, "%s", path);
			return GZ_OK;
		}
	}
	return GZ_ERR_FULL;
}
