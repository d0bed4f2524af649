#include "daemon/notify.h"

#include <errno.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/clock.h"
#include "base/number.h"

#define GZ_LOG_MODULE "notify"

/* A path's address, or an abstract one, whose name begins with a zero byte and has no end mark. */
static bool take_address(struct gz_notify *notify, const char *name)
{
	size_t length = strlen(name);
	if ((name[0] != '/' && name[0] != '@') || length < 2 ||
	    length >= sizeof notify->address.sun_path)
		return false;
	notify->address.sun_family = AF_UNIX;
	memcpy(notify->address.sun_path, name, length);
	if (name[0] == '@')
		notify->address.sun_path[0] = '\0';
	notify->address_size =
		(socklen_t)(offsetof(struct sockaddr_un, sun_path) + length + (name[0] == '/'));
	return true;
}

/* Half of the watchdog's time, or 0 where it is not meant for this process. */
static int64_t watchdog_interval_ns(void)
{
	const char *text = getenv("WATCHDOG_USEC"), *pid = getenv("WATCHDOG_PID");
	long long usec, whose;
	if (!text || !gz_number_parse_whole(text, &usec) || usec <= 0 ||
	    usec > INT64_MAX / (GZ_NS_PER_MS / 1000))
		return 0;
	if (pid && (!gz_number_parse_whole(pid, &whose) || whose != getpid()))
		return 0;
	return usec * (GZ_NS_PER_MS / 1000) / 2;
}

void gz_notify_open(struct gz_notify *notify, const struct gz_log *log)
{
	const char *name = getenv("NOTIFY_SOCKET");
	*notify = (struct gz_notify) { .fd = -1 };
	if (!name || !name[0])
		return;
	if (!take_address(notify, name)) {
		gz_warn(log, "NOTIFY_SOCKET=%s is no socket that can be told anything", name);
		return;
	}
	notify->fd = socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
	if (notify->fd < 0)
		gz_warn(log, "the service manager cannot be told: %s", strerror(errno));
	notify->interval_ns = watchdog_interval_ns();
}

static bool tell(const struct gz_notify *notify, const char *text)
{
	return notify->fd >= 0 &&
	       sendto(notify->fd, text, strlen(text), MSG_NOSIGNAL | MSG_DONTWAIT,
		      (const struct sockaddr *)&notify->address, notify->address_size) >= 0;
}

void gz_notify_alive(struct gz_notify *notify, int64_t now_ns)
{
	if (notify->fd < 0)
		return;
	/* Where the manager's queue is full it is told at the next call. */
	if (!notify->ready)
		notify->ready = tell(notify, "READY=1");
	if (notify->interval_ns == 0 || now_ns < notify->next_ns)
		return;
	if (tell(notify, "WATCHDOG=1"))
		notify->next_ns = now_ns + notify->interval_ns;
}

void gz_notify_status(const struct gz_notify *notify, const char *text)
{
	char message[512];
	int length = snprintf(message, sizeof message, "STATUS=%s", text);
	for (int i = 0; i < length && message[i]; i++) {
		if (message[i] == '\n')
			message[i] = ' ';
	}
	tell(notify, message);
}

void gz_notify_stopping(const struct gz_notify *notify)
{
	tell(notify, "STOPPING=1");
}

void gz_notify_close(struct gz_notify *notify)
{
	if (notify->fd >= 0)
		close(notify->fd);
	notify->fd = -1;
}
