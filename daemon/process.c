#include "daemon/process.h"

#include <errno.h>
#include <fcntl.h>
#include <grp.h>
#include <pwd.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/clock.h"
#include "base/text.h"
#include "protocol/endpoint.h"
#include "protocol/gaze.h"

#define GZ_LOG_MODULE "process"

/* The process id that the holder of the lock wrote into it; "?" if it has not yet done so. */
static void read_holder(int fd, char *text, size_t size)
{
	ssize_t n = pread(fd, text, size - 1, 0);
	text[n > 0 ? n : 0] = '\0';
	text[strspn(text, "0123456789")] = '\0';
	if (!text[0])
		snprintf(text, size, "?");
}

static void write_holder(int fd)
{
	char text[32];
	int length = snprintf(text, sizeof text, "%ld\n", (long)getpid());
	if (ftruncate(fd, 0) != 0 || pwrite(fd, text, (size_t)length, 0) != length)
		return; /* harmless: a second daemon's message then lacks the process id */
}

enum gz_result gz_lock_take(const char *directory, const struct gz_log *log, int *out_fd)
{
	char path[GZ_PATH_SIZE], holder[16];
	snprintf(path, sizeof path, "%s/lock", directory);
	int fd = open(path, O_RDWR | O_CREAT | O_NOFOLLOW | O_CLOEXEC, 0600);
	if (fd < 0) {
		gz_err(log, "cannot create %s: %s; set GAZECAST_RUNTIME_DIR to another directory",
		       path, strerror(errno));
		return GZ_ERR_IO;
	}
	if (flock(fd, LOCK_EX | LOCK_NB) != 0) {
		read_holder(fd, holder, sizeof holder);
		gz_err(log,
		       "another gazed (process %s) already uses %s; stop it, or set "
		       "GAZECAST_RUNTIME_DIR to another directory for this one",
		       holder, directory);
		close(fd);
		return GZ_ERR_BUSY;
	}
	write_holder(fd);
	*out_fd = fd;
	return GZ_OK;
}

void gz_open_files_allow(const struct gz_log *log)
{
	struct rlimit limit;
	if (getrlimit(RLIMIT_NOFILE, &limit) != 0)
		return;
	rlim_t wanted = limit.rlim_max < GZ_OPEN_FILES_MAX ? limit.rlim_max : GZ_OPEN_FILES_MAX;
	struct rlimit highest = { .rlim_cur = wanted, .rlim_max = limit.rlim_max };
	if (limit.rlim_cur < wanted && setrlimit(RLIMIT_NOFILE, &highest) == 0)
		limit = highest;
	if (limit.rlim_cur < GZ_OPEN_FILES_ENOUGH)
		gz_warn(log,
			"at most %llu files and connections may be open; raise the limit "
			"(ulimit -n, or LimitNOFILE= of the unit)",
			(unsigned long long)limit.rlim_cur);
}

/* Make /run/gazecast, which only root can, and give it to the user. */
static enum gz_result hand_over_directory(const struct passwd *user, const struct gz_log *log)
{
	const char *chosen = getenv("GAZECAST_RUNTIME_DIR");
	const char *path = GZ_SYSTEM_RUNTIME_DIRECTORY;
	struct stat status;
	if (chosen && *chosen)
		return GZ_OK;
	if ((mkdir(path, 0750) == 0 || errno == EEXIST) && lstat(path, &status) == 0 &&
	    S_ISDIR(status.st_mode) && lchown(path, user->pw_uid, user->pw_gid) == 0 &&
	    chmod(path, 0750) == 0)
		return GZ_OK;
	gz_err(log, "cannot create %s: %s; set GAZECAST_RUNTIME_DIR to another directory", path,
	       strerror(errno));
	return GZ_ERR_IO;
}

static enum gz_result become_user(const struct passwd *user, const struct gz_log *log)
{
	if (initgroups(user->pw_name, user->pw_gid) != 0 ||
	    setresgid(user->pw_gid, user->pw_gid, user->pw_gid) != 0 ||
	    setresuid(user->pw_uid, user->pw_uid, user->pw_uid) != 0) {
		gz_err(log, "cannot become user %s: %s", user->pw_name, strerror(errno));
		return GZ_ERR_ACCESS;
	}
	/* If root can be regained, the step above has failed. */
	if (setuid(0) == 0 || geteuid() == 0) {
		gz_err(log, "cannot give up root's privileges; start gazed as user %s",
		       user->pw_name);
		return GZ_ERR_ACCESS;
	}
	return GZ_OK;
}

static void change_environment(const struct passwd *user)
{
	setenv("HOME", user->pw_dir, 1);
	setenv("USER", user->pw_name, 1);
	setenv("LOGNAME", user->pw_name, 1);
	unsetenv("XDG_RUNTIME_DIR");
	unsetenv("XDG_CONFIG_HOME");
	unsetenv("XDG_DATA_HOME");
}

enum gz_result gz_privileges_drop(const char *user, const struct gz_log *log)
{
	prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0);
	if (!user[0])
		return GZ_OK;
	const struct passwd *wanted = getpwnam(user);
	if (!wanted || wanted->pw_uid == 0) {
		gz_err(log,
		       "daemon.user: %s %s; create the user with systemd-sysusers, or name another",
		       user, wanted ? "is root" : "does not exist on this machine");
		return GZ_ERR_INVAL;
	}
	if (wanted->pw_uid == geteuid())
		return GZ_OK;
	if (geteuid() != 0) {
		gz_err(log,
		       "daemon.user: only root can become %s; leave this setting out to run as "
		       "user %ld",
		       user, (long)geteuid());
		return GZ_ERR_INVAL;
	}
	enum gz_result result = hand_over_directory(wanted, log);
	if (result == GZ_OK)
		result = become_user(wanted, log);
	if (result != GZ_OK)
		return result;
	change_environment(wanted);
	gz_info(log, "running as user %s", user);
	return GZ_OK;
}

void gz_privileges_advise(const struct gz_log *log)
{
	if (geteuid() == 0)
		gz_warn(log, "running as root, which is not needed: set user in section [daemon] "
			     "of gazed.conf, or use the systemd unit");
}

/* A path, or an abstract name, which begins with a zero byte and has no final NUL. */
static bool parse_notify_address(struct gz_notify *notify, const char *name)
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

/* Half of the watchdog's period, or 0 if it is not meant for this process. */
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
	if (!parse_notify_address(notify, name)) {
		gz_warn(log,
			"NOTIFY_SOCKET=%s is not a path or @name; the service manager is not told "
			"anything",
			name);
		return;
	}
	notify->fd = socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
	if (notify->fd < 0)
		gz_warn(log, "no socket to the service manager: %s", strerror(errno));
	notify->interval_ns = watchdog_interval_ns();
}

static bool send_to_manager(const struct gz_notify *notify, const char *text)
{
	return notify->fd >= 0 &&
	       sendto(notify->fd, text, strlen(text), MSG_NOSIGNAL | MSG_DONTWAIT,
		      (const struct sockaddr *)&notify->address, notify->address_size) >= 0;
}

void gz_notify_alive(struct gz_notify *notify, int64_t now_ns)
{
	if (notify->fd < 0)
		return;
	/* If the manager's queue is full, the next call tries again. */
	if (!notify->ready)
		notify->ready = send_to_manager(notify, "READY=1");
	if (notify->interval_ns == 0 || now_ns < notify->next_ns)
		return;
	if (send_to_manager(notify, "WATCHDOG=1"))
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
	send_to_manager(notify, message);
}

void gz_notify_stopping(const struct gz_notify *notify)
{
	send_to_manager(notify, "STOPPING=1");
}

void gz_notify_close(struct gz_notify *notify)
{
	if (notify->fd >= 0)
		close(notify->fd);
	notify->fd = -1;
}
