#include "suite.h"

#include "guest.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/clock.h"
#include "base/suspend.h"

static void write_file(const char *path, const char *text)
{
	int fd = open(path, O_WRONLY | O_CLOEXEC);
	ssize_t written = fd >= 0 ? write(fd, text, strlen(text)) : -1;
	int error = errno;
	if (fd >= 0)
		close(fd);
	if (written != (ssize_t)strlen(text))
		fail_msg("writing \"%s\" to %s: %s", text, path, strerror(error));
}

int64_t guest_suspend(void)
{
	int64_t before_ns = gz_suspended_ns();
	write_file("/sys/class/rtc/rtc0/wakealarm", "0");
	write_file("/sys/class/rtc/rtc0/wakealarm", "+3");
	write_file("/sys/power/state", "mem");
	return gz_suspended_ns() - before_ns;
}

void guest_wait_for_file(const char *path, bool wanted)
{
	int64_t deadline_ns = gz_clock_now_ns() + 10 * GZ_NS_PER_S;
	while ((access(path, F_OK) == 0) != wanted) {
		if (gz_clock_now_ns() > deadline_ns)
			fail_msg("%s %s", path, wanted ? "does not appear" : "does not go");
		usleep(10000);
	}
}

void guest_wait_for_count(const _Atomic uint32_t *count, uint32_t wanted)
{
	int64_t deadline_ns = gz_clock_now_ns() + 10 * GZ_NS_PER_S;
	while (*count < wanted && gz_clock_now_ns() < deadline_ns)
		usleep(1000);
	assert_true(*count >= wanted);
}

void guest_install_udev_rules(void)
{
	/* What still works on earlier events has the rules of its start. */
	assert_int_equal(system("udevadm settle --timeout=60 && "
				"cp /usr/share/gazecast/udev/*.rules /etc/udev/rules.d/ && "
				"udevadm control --reload"),
			 0);
}

void guest_remove_udev_rules(void)
{
	assert_int_equal(system("rm -f /etc/udev/rules.d/*.rules; udevadm control --reload"), 0);
}
