/**
 * @file
 * The daemon as a process of its system: one daemon per runtime directory, the limit of open files,
 * the user it runs as, and what it reports to a service manager.
 */
#ifndef GZ_DAEMON_PROCESS_H
#define GZ_DAEMON_PROCESS_H

#include <stdbool.h>
#include <stdint.h>
#include <sys/socket.h>
#include <sys/un.h>

#include "base/log.h"
#include "base/result.h"

/**
 * Lock the runtime directory for this process, so that no second daemon uses it. Without the lock a
 * second daemon would silently take over the sockets of the first: ZeroMQ removes a socket file
 * that is in its way. The lock lasts until *out_fd is closed or the process ends, however it ends.
 *
 * @param directory    made and checked by gz_runtime_directory_prepare()
 * @param[out] out_fd  the caller closes it
 * @retval GZ_ERR_BUSY  another daemon holds the lock; logged with its process id and the remedy
 * @retval GZ_ERR_IO    the lock file cannot be made; logged
 */
enum gz_result gz_lock_take(const char *directory, const struct gz_log *log, int *out_fd);

/** A lower limit of open files is warned about: a client that does not close its connections, or an
 * attacker, would soon use them up. Chosen: more than all connections that are allowed (quota.h).
 */
#define GZ_OPEN_FILES_ENOUGH 8192

/** The limit of open files is not raised beyond this. Chosen: far more than the connections that
 * are allowed (quota.h). */
#define GZ_OPEN_FILES_MAX 65536

/**
 * Raise the limit of open files to what the system allows this process, at most GZ_OPEN_FILES_MAX,
 * and warn if that is less than GZ_OPEN_FILES_ENOUGH. Each connection is an open file, and libzmq
 * 4.3.4 ends the program if it cannot accept a connection at a local socket; the quota (quota.h)
 * keeps the connections below the limit. Call it before the first thread starts.
 */
void gz_open_files_allow(const struct gz_log *log);

/**
 * Give up privileges, before anything from outside is read. The daemon needs none: a udev rule
 * gives its devices to its user.
 *
 * The process can no longer gain privileges by running programs. If root has started it, it becomes
 * @p user with that user's groups: /run/gazecast is made and handed over, HOME becomes the user's,
 * and XDG_RUNTIME_DIR, XDG_CONFIG_HOME and XDG_DATA_HOME, which were root's, are unset. Call it
 * before any thread starts.
 *
 * @param user  user name; empty: keep the present user
 * @retval GZ_ERR_INVAL   there is no such user, or it is another user and we are not root; logged
 *                        with the remedy
 * @retval GZ_ERR_ACCESS  root's privileges cannot be given up; logged
 * @retval GZ_ERR_IO      /run/gazecast cannot be made; logged
 */
enum gz_result gz_privileges_drop(const char *user, const struct gz_log *log);

/** Warn if the daemon runs as root. */
void gz_privileges_advise(const struct gz_log *log);

/**
 * Reports to a service manager that the daemon is ready, alive or stopping: datagrams to
 * $NOTIFY_SOCKET, as sd_notify(3) of systemd describes them. A few lines of our own, because
 * libsystemd would bring four compression libraries into a daemon that reads untrusted bytes, for
 * the sake of one sendto().
 */
struct gz_notify {
	int fd; /**< -1: there is no service manager, and all calls do nothing */
	struct sockaddr_un address;
	socklen_t address_size;
	int64_t interval_ns; /**< between signs of life; 0: none are wanted */
	int64_t next_ns;     /**< host time of the next one */
	bool ready;          /**< readiness has been reported */
};

/**
 * Read NOTIFY_SOCKET (a path, or '@' and an abstract name), WATCHDOG_USEC and WATCHDOG_PID from the
 * environment. An address that cannot be used is warned about, and nothing is reported then.
 */
void gz_notify_open(struct gz_notify *notify, const struct gz_log *log);

/**
 * Report that samples are served: "READY=1" at the first call, then "WATCHDOG=1" twice in each
 * watchdog period, as sd_watchdog_enabled(3) asks. Only the thread that serves samples may call it,
 * several times a second. Never waits.
 */
void gz_notify_alive(struct gz_notify *notify, int64_t now_ns);

/** Report the daemon's state as text, for `systemctl status`. Never waits. Threads: any. */
void gz_notify_status(const struct gz_notify *notify, const char *text);

/** Report that the daemon is stopping. Never waits. Threads: any. */
void gz_notify_stopping(const struct gz_notify *notify);

/** Close the socket. */
void gz_notify_close(struct gz_notify *notify);

#endif
