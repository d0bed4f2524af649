/**
 * @file
 * Tells a service manager that the daemon is ready, alive or leaving: datagrams to $NOTIFY_SOCKET,
 * as sd_notify(3) of systemd describes them. A few lines of our own, because libsystemd would bring
 * four compression libraries into a daemon that reads untrusted bytes, for one sendto().
 */
#ifndef GZ_DAEMON_NOTIFY_H
#define GZ_DAEMON_NOTIFY_H

#include <stdbool.h>
#include <stdint.h>
#include <sys/socket.h>
#include <sys/un.h>

#include "base/log.h"

/** Where to tell. */
struct gz_notify {
	int fd; /**< -1: nobody listens, and all calls do nothing */
	struct sockaddr_un address;
	socklen_t address_size;
	int64_t interval_ns; /**< between signs of life; 0: nobody wants them */
	int64_t next_ns;     /**< of the next one */
	bool ready;          /**< has been told */
};

/**
 * Look into the environment: NOTIFY_SOCKET (a path, or '@' and an abstract name), WATCHDOG_USEC and
 * WATCHDOG_PID. What cannot be used is warned of, and nobody is told anything then.
 */
void gz_notify_open(struct gz_notify *notify, const struct gz_log *log);

/**
 * Say that samples are served, from the thread that serves them and from nowhere else: the first
 * time "READY=1", then "WATCHDOG=1" twice in each of the watchdog's times, as
 * sd_watchdog_enabled(3) asks for. Never waits. Call it some times a second.
 */
void gz_notify_alive(struct gz_notify *notify, int64_t now_ns);

/** Say in words what is going on, for `systemctl status`. Never waits. Any thread. */
void gz_notify_status(const struct gz_notify *notify, const char *text);

/** Say that the daemon leaves. Never waits. Any thread. */
void gz_notify_stopping(const struct gz_notify *notify);

/** Close. */
void gz_notify_close(struct gz_notify *notify);

#endif
