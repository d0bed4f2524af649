/* A program that confines itself like a decoder and then tries what a decoder must not do. Prints a
 * line for each attempt that succeeds, and exits 0 if none does and what it may do is possible.
 *   confined_attempts MAY-READ-FOLDER MAY-READ-FILE OTHER-FILE */
#include <errno.h>
#include <fcntl.h>
#include <pthread.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include "render/decode/child/confine.h"
#include "render/decode/decode.h"

static int faults;

static void expect(int holds, const char *what)
{
	if (holds)
		return;
	fprintf(stderr, "%s (%s)\n", what, strerror(errno));
	faults++;
}

static void try_files(const char *may, const char *other, int landlock)
{
	int fd = open(may, O_RDONLY);
	expect(fd >= 0, "the given file cannot be read");
	char byte;
	expect(fd >= 0 && read(fd, &byte, 1) == 1, "the given file gives no byte");
	expect(open(may, O_RDWR) < 0, "the given file can be written");
	expect(open("made-by-confined", O_WRONLY | O_CREAT, 0600) < 0, "a file can be made");
	if (landlock)
		expect(open(other, O_RDONLY) < 0, "another file can be read");
}

static void *other_thread(void *user)
{
	*(int *)user = 1;
	return NULL;
}

static void try_calls(void)
{
	pthread_t thread;
	int ran = 0;
	expect(socket(AF_INET, SOCK_STREAM, 0) < 0, "a socket can be made");
	expect(socket(AF_UNIX, SOCK_STREAM, 0) < 0, "a local socket can be made");
	char *const arguments[] = { (char *)"true", NULL };
	expect(execve("/bin/true", arguments, NULL) < 0 && errno == EPERM, "exec is possible");
	const pid_t child = fork();
	if (child == 0)
		_exit(0);
	expect(child < 0, "a process can be started");
	expect(kill(getppid(), 0) < 0, "the parent can be sent signals");
	expect(mmap(NULL, 4096, PROT_READ | PROT_WRITE | PROT_EXEC, MAP_PRIVATE | MAP_ANONYMOUS, -1,
		    0) == MAP_FAILED,
	       "memory can be written and run");
	struct rlimit limit = { RLIM_INFINITY, RLIM_INFINITY };
	expect(setrlimit(RLIMIT_AS, &limit) < 0, "the limit of memory can be raised");
	expect(pthread_create(&thread, NULL, other_thread, &ran) == 0 &&
		       pthread_join(thread, NULL) == 0 && ran,
	       "no thread can be started");
}

static void try_limits(int descriptors)
{
	struct rlimit limit;
	expect(getrlimit(RLIMIT_CORE, &limit) == 0 && limit.rlim_max == 0, "core files");
	expect(getrlimit(RLIMIT_CPU, &limit) == 0 && limit.rlim_cur <= 3600, "processor time");
	expect(getrlimit(RLIMIT_NOFILE, &limit) == 0 && limit.rlim_max <= 64, "descriptors");
	if (!descriptors)
		return;
	void *memory = mmap(NULL, 2 * GZ_DECODE_WORK_BYTES, PROT_READ | PROT_WRITE,
			    MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
	expect(memory == MAP_FAILED, "more address space than allowed");
}

int main(int argc, char **argv)
{
	char protection[GZ_CONFINE_TEXT_SIZE];
	if (argc != 4 || gz_confine(getppid(), argv[1], protection) != GZ_OK)
		return 3;
	printf("%s\n", protection);
	fflush(stdout);
	const int landlock = strstr(protection, "Landlock ") && !strstr(protection, "no Landlock");
	try_files(argv[2], argv[3], landlock);
	if (strstr(protection, "system calls"))
		try_calls();
	try_limits(strstr(protection, "but for the address space") == NULL);
	fflush(stdout);
	fflush(stderr);
	_exit(faults > 0);
}
