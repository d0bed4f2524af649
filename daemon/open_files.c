#include "daemon/open_files.h"

#include <sys/resource.h>

#define GZ_LOG_MODULE "open_files"

void gz_open_files_allow(const struct gz_log *log)
{
	struct rlimit limit;
	if (getrlimit(RLIMIT_NOFILE, &limit) != 0)
		return;
	struct rlimit highest = { .rlim_cur = limit.rlim_max, .rlim_max = limit.rlim_max };
	if (limit.rlim_cur < limit.rlim_max && setrlimit(RLIMIT_NOFILE, &highest) == 0)
		limit = highest;
	if (limit.rlim_cur < GZ_OPEN_FILES_ENOUGH)
		gz_warn(log,
			"no more than %llu files and connections may be open; raise the limit "
			"(ulimit -n, or LimitNOFILE= of the unit)",
			(unsigned long long)limit.rlim_cur);
}
