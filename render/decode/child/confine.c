#include "render/decode/child/confine.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <linux/landlock.h>
#include <seccomp.h>
#include <signal.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

#include "base/sizes.h"
#include "render/decode/decode.h"

/* Chosen: long for any file, short for a machine that waits for it. */
#define CPU_SECONDS 3600

#define DESCRIPTORS 64

/* Symbolic links of a folder that are followed (chosen: as many as files of a folder are read). */
#define LINKS_MAX 65536

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define ADDRESS_SPACE_LIMITED 0
#else
#define ADDRESS_SPACE_LIMITED 1
#endif

/* landlock(7); struct landlock_ruleset_attr of newer headers, by number, since older ones lack its
 * later members. */
struct ruleset {
	uint64_t files, network, scopes;
};

/* The rights of each version that a rule can give or deny: what a version adds is denied too. */
static uint64_t file_rights_of_version(long version)
{
	const int count = version >= 5 ? 16 : version >= 3 ? 15 : version >= 2 ? 14 : 13;
	return (UINT64_C(1) << count) - 1;
}

static size_t ruleset_size(long version)
{
	return version >= 6 ? 24 : version >= 4 ? 16 : 8;
}

/* Let what `path` names be read; a rule for a file cannot have the rights of folders. */
static bool allow_reading(int rules, const char *path)
{
	struct landlock_path_beneath_attr beneath = { .allowed_access =
							      LANDLOCK_ACCESS_FS_READ_FILE };
	struct stat status;
	beneath.parent_fd = open(path, O_PATH | O_CLOEXEC);
	if (beneath.parent_fd < 0)
		return false;
	if (fstat(beneath.parent_fd, &status) == 0 && S_ISDIR(status.st_mode))
		beneath.allowed_access |= LANDLOCK_ACCESS_FS_READ_DIR;
	const long done =
		syscall(SYS_landlock_add_rule, rules, LANDLOCK_RULE_PATH_BENEATH, &beneath, 0);
	close(beneath.parent_fd);
	return done == 0;
}

/* A link in the folder stands for the file that it points to. */
static void allow_links(int rules, const char *folder)
{
	char path[2 * GZ_PATH_SIZE];
	DIR *entries = opendir(folder);
	int links = 0;
	if (!entries)
		return;
	for (struct dirent *entry; links < LINKS_MAX && (entry = readdir(entries));) {
		struct stat status;
		if (entry->d_type != DT_LNK && entry->d_type != DT_UNKNOWN)
			continue;
		if ((size_t)snprintf(path, sizeof path, "%s/%s", folder, entry->d_name) >=
		    sizeof path)
			continue;
		links++;
		if (lstat(path, &status) == 0 && S_ISLNK(status.st_mode) &&
		    stat(path, &status) == 0 && S_ISREG(status.st_mode))
			(void)allow_reading(rules, path);
	}
	closedir(entries);
}

/* The folder of a file, or the folder itself. */
static void folder_to_read(const char *path, char out_folder[GZ_PATH_SIZE])
{
	struct stat status;
	snprintf(out_folder, GZ_PATH_SIZE, "%s", path);
	if (stat(path, &status) == 0 && S_ISDIR(status.st_mode))
		return;
	char *slash = strrchr(out_folder, '/');
	if (!slash)
		snprintf(out_folder, GZ_PATH_SIZE, ".");
	else
		slash[slash == out_folder] = 0;
}

/* Returns Landlock's version; 0: the kernel has none; -1: it failed. */
static long confine_files(const char *path)
{
	char folder[GZ_PATH_SIZE];
	const long version =
		syscall(SYS_landlock_create_ruleset, NULL, 0, LANDLOCK_CREATE_RULESET_VERSION);
	if (version < 1)
		return 0;
	/* Binding and connecting by TCP; signals and abstract sockets out of the process. */
	const struct ruleset all = { file_rights_of_version(version), 3, 3 };
	const int rules = (int)syscall(SYS_landlock_create_ruleset, &all, ruleset_size(version), 0);
	if (rules < 0)
		return -1;
	folder_to_read(path, folder);
	(void)allow_reading(rules, folder); /* if there is none, nothing can be read */
	(void)allow_reading(rules, path);   /* it may be a link to another folder */
	allow_links(rules, folder);
	const long done = syscall(SYS_landlock_restrict_self, rules, 0);
	close(rules);
	return done == 0 ? version : -1;
}

/* Calls that are allowed whatever their arguments. */
static const int allowed_calls[] = {
	SCMP_SYS(read),
	SCMP_SYS(readv),
	SCMP_SYS(pread64),
	SCMP_SYS(write),
	SCMP_SYS(writev),
	SCMP_SYS(close),
	SCMP_SYS(fstat),
	SCMP_SYS(newfstatat),
	SCMP_SYS(stat),
	SCMP_SYS(lstat),
	SCMP_SYS(statx),
	SCMP_SYS(access),
	SCMP_SYS(faccessat),
	SCMP_SYS(faccessat2),
	SCMP_SYS(readlink),
	SCMP_SYS(readlinkat),
	SCMP_SYS(lseek),
	SCMP_SYS(getdents64),
	SCMP_SYS(fadvise64),
	SCMP_SYS(getcwd),
	SCMP_SYS(munmap),
	SCMP_SYS(mremap),
	SCMP_SYS(madvise),
	SCMP_SYS(brk),
	SCMP_SYS(futex),
	SCMP_SYS(exit),
	SCMP_SYS(exit_group),
	SCMP_SYS(rt_sigaction),
	SCMP_SYS(rt_sigprocmask),
	SCMP_SYS(rt_sigreturn),
	SCMP_SYS(sigaltstack),
	SCMP_SYS(tgkill),
	SCMP_SYS(gettid),
	SCMP_SYS(getpid),
	SCMP_SYS(getppid),
	SCMP_SYS(getuid),
	SCMP_SYS(geteuid),
	SCMP_SYS(set_robust_list),
	SCMP_SYS(rseq),
	SCMP_SYS(sched_yield),
	SCMP_SYS(sched_getaffinity),
	SCMP_SYS(getrandom),
	SCMP_SYS(clock_gettime),
	SCMP_SYS(clock_getres),
	SCMP_SYS(clock_nanosleep),
	SCMP_SYS(nanosleep),
	SCMP_SYS(gettimeofday),
	SCMP_SYS(poll),
	SCMP_SYS(ppoll),
	SCMP_SYS(uname),
	SCMP_SYS(sysinfo),
	SCMP_SYS(getrusage),
	SCMP_SYS(restart_syscall),
	SCMP_SYS(membarrier),
#if !ADDRESS_SPACE_LIMITED /* a sanitizer finds out by a pipe whether memory can be read */
	SCMP_SYS(pipe),
	SCMP_SYS(pipe2),
#endif
};

/* The C library's threads: a process of its own lacks these. */
#define THREAD_FLAGS ((scmp_datum_t)0x00010000 /* CLONE_THREAD, linux/sched.h */)

static int add_conditional_calls(scmp_filter_ctx filter)
{
	const scmp_datum_t writing = O_WRONLY | O_RDWR | O_CREAT | O_TRUNC;
	int error = seccomp_rule_add(filter, SCMP_ACT_ALLOW, SCMP_SYS(openat), 1,
				     SCMP_A2(SCMP_CMP_MASKED_EQ, writing, 0));
#ifdef __NR_open
	if (!error)
		error = seccomp_rule_add(filter, SCMP_ACT_ALLOW, SCMP_SYS(open), 1,
					 SCMP_A1(SCMP_CMP_MASKED_EQ, writing, 0));
#endif
	if (!error)
		error = seccomp_rule_add(filter, SCMP_ACT_ALLOW, SCMP_SYS(mmap), 1,
					 SCMP_A2(SCMP_CMP_MASKED_EQ, PROT_EXEC, 0));
	if (!error)
		error = seccomp_rule_add(filter, SCMP_ACT_ALLOW, SCMP_SYS(mprotect), 1,
					 SCMP_A2(SCMP_CMP_MASKED_EQ, PROT_EXEC, 0));
	if (!error)
		error = seccomp_rule_add(filter, SCMP_ACT_ALLOW, SCMP_SYS(clone), 1,
					 SCMP_A0(SCMP_CMP_MASKED_EQ, THREAD_FLAGS, THREAD_FLAGS));
	/* Its flags are behind a pointer: the C library then takes clone(). */
	if (!error)
		error = seccomp_rule_add(filter, SCMP_ACT_ERRNO(ENOSYS), SCMP_SYS(clone3), 0);
	/* Limits can be asked for, not changed. */
	if (!error)
		error = seccomp_rule_add(filter, SCMP_ACT_ALLOW, SCMP_SYS(prlimit64), 1,
					 SCMP_A2(SCMP_CMP_EQ, 0));
	if (!error)
		error = seccomp_rule_add(filter, SCMP_ACT_ALLOW, SCMP_SYS(prctl), 1,
					 SCMP_A0(SCMP_CMP_EQ, PR_SET_NAME));
	if (!error)
		error = seccomp_rule_add(filter, SCMP_ACT_ALLOW, SCMP_SYS(fcntl), 1,
					 SCMP_A1(SCMP_CMP_EQ, F_GETFL));
	if (!error)
		error = seccomp_rule_add(filter, SCMP_ACT_ALLOW, SCMP_SYS(fcntl), 1,
					 SCMP_A1(SCMP_CMP_EQ, F_GETFD));
	if (!error)
		error = seccomp_rule_add(filter, SCMP_ACT_ALLOW, SCMP_SYS(fcntl), 1,
					 SCMP_A1(SCMP_CMP_EQ, F_SETFD));
	return error;
}

static bool confine_calls(void)
{
	scmp_filter_ctx filter = seccomp_init(SCMP_ACT_ERRNO(EPERM));
	if (!filter)
		return false;
	int error = 0;
	for (size_t i = 0; !error && i < sizeof allowed_calls / sizeof allowed_calls[0]; i++) {
		error = seccomp_rule_add(filter, SCMP_ACT_ALLOW, allowed_calls[i], 0);
		if (error == -EDOM) /* not a call of this architecture */
			error = 0;
	}
	if (!error)
		error = add_conditional_calls(filter);
	if (!error)
		error = seccomp_load(filter);
	seccomp_release(filter);
	return error == 0;
}

static bool set_soft_limit(int resource, rlim_t value, bool hard_too)
{
	struct rlimit limit;
	if (getrlimit((__rlimit_resource_t)resource, &limit) != 0)
		return false;
	if (limit.rlim_max != RLIM_INFINITY && value > limit.rlim_max)
		value = limit.rlim_max;
	limit.rlim_cur = value;
	if (hard_too)
		limit.rlim_max = value;
	return setrlimit((__rlimit_resource_t)resource, &limit) == 0;
}

/* The hard limit of the address space stays: the parent raises the soft one. */
static bool set_limits(void)
{
	return set_soft_limit(RLIMIT_CORE, 0, true) &&
	       set_soft_limit(RLIMIT_NOFILE, DESCRIPTORS, true) &&
	       set_soft_limit(RLIMIT_CPU, CPU_SECONDS, false) &&
	       (!ADDRESS_SPACE_LIMITED || set_soft_limit(RLIMIT_AS, GZ_DECODE_WORK_BYTES, false));
}

enum gz_result gz_confine(pid_t parent, const char *path, char protection[GZ_CONFINE_TEXT_SIZE])
{
	if (prctl(PR_SET_PDEATHSIG, SIGKILL) != 0 || getppid() != parent ||
	    prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) != 0)
		return GZ_ERR_ACCESS;
	const long landlock = confine_files(path);
	if (landlock < 0 || !set_limits())
		return GZ_ERR_ACCESS;
	const bool calls = confine_calls();
	char files[32] = "no Landlock";
	if (landlock > 0)
		snprintf(files, sizeof files, "Landlock %ld", landlock);
	snprintf(protection, GZ_CONFINE_TEXT_SIZE, "%s, %s, limits%s", files,
		 calls ? "system calls" : "no seccomp",
		 ADDRESS_SPACE_LIMITED ? "" : " but for the address space");
	return GZ_OK;
}
