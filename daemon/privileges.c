#include "daemon/privileges.h"

#include <errno.h>
#include <grp.h>
#include <pwd.h>
#include <stdlib.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/stat.h>
#include <unistd.h>

#include "protocol/endpoint.h"

#define GZ_LOG_MODULE "privileges"

/* Only root can make it. */
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
	gz_err(log, "cannot make %s: %s; name another directory in GAZECAST_RUNTIME_DIR", path,
	       strerror(errno));
	return GZ_ERR_IO;
}

static enum gz_result become(const struct passwd *user, const struct gz_log *log)
{
	if (initgroups(user->pw_name, user->pw_gid) != 0 ||
	    setresgid(user->pw_gid, user->pw_gid, user->pw_gid) != 0 ||
	    setresuid(user->pw_uid, user->pw_uid, user->pw_uid) != 0) {
		gz_err(log, "cannot become user %s: %s", user->pw_name, strerror(errno));
		return GZ_ERR_ACCESS;
	}
	/* Where this works, the step before has not. */
	if (setuid(0) == 0 || geteuid() == 0) {
		gz_err(log, "root's privileges do not go away; start gazed as user %s",
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
		gz_err(log, "daemon.user: %s %s; make it by systemd-sysusers, or name another",
		       user, wanted ? "is root" : "is no user of this machine");
		return GZ_ERR_INVAL;
	}
	if (wanted->pw_uid == geteuid())
		return GZ_OK;
	if (geteuid() != 0) {
		gz_err(log, "daemon.user: only root can become %s; leave it out to run as user %ld",
		       user, (long)geteuid());
		return GZ_ERR_INVAL;
	}
	enum gz_result result = hand_over_directory(wanted, log);
	if (result == GZ_OK)
		result = become(wanted, log);
	if (result != GZ_OK)
		return result;
	change_environment(wanted);
	gz_info(log, "running as user %s", user);
	return GZ_OK;
}

void gz_privileges_advise(const struct gz_log *log)
{
	if (geteuid() == 0)
		gz_warn(log, "running as root, which nothing here needs: set user in section "
			     "[daemon] of gazed.conf, or use the systemd unit");
}
