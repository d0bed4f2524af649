#include "render/decode/decode_process.h"

#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include "base/sizes.h"
#include "base/text.h"

#define GZ_LOG_MODULE "decode"

/* Descriptors here are at least this, so that none is in the way of those that the decoder gets. */
#define FD_LEAST 16

/* Where the decoder's standard error goes; -1: /dev/null. What libraries print is not for the
 * terminal; what sanitizers print must be heard. */
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define ERRORS_FD STDERR_FILENO
#else
#define ERRORS_FD (-1)
#endif

/* Variables of the environment that the decoder gets: where libraries are, and settings of
 * sanitizers. */
static const char *const kept_variables[] = { "LD_LIBRARY_PATH", "ASAN_OPTIONS", "LSAN_OPTIONS",
					      "UBSAN_OPTIONS", "TSAN_OPTIONS" };
enum { KEPT_COUNT = sizeof kept_variables / sizeof kept_variables[0] };

static void close_fd(int *fd)
{
	if (*fd >= 0)
		close(*fd);
	*fd = -1;
}

/* Move a descriptor out of the way of the decoder's. */
static bool lift_fd(int *fd)
{
	if (*fd < 0 || *fd >= FD_LEAST)
		return *fd >= 0;
	const int lifted = fcntl(*fd, F_DUPFD_CLOEXEC, FD_LEAST);
	close(*fd);
	*fd = lifted;
	return lifted >= 0;
}

static bool open_pipes(struct gz_decode_process *process, int *messages_end)
{
	int answers[2] = { -1, -1 }, messages[2] = { -1, -1 };
	const bool open = pipe2(answers, O_CLOEXEC) == 0 && pipe2(messages, O_CLOEXEC) == 0;
	process->answers_end = answers[0];
	*messages_end = messages[1];
	process->answers = answers[1];
	process->messages = messages[0];
	return open && lift_fd(&process->answers_end) && lift_fd(messages_end) &&
	       lift_fd(&process->answers) && lift_fd(&process->messages) &&
	       fcntl(process->messages, F_SETFL, O_NONBLOCK) == 0;
}

/* What the decoder's descriptors are; -1: /dev/null. */
static int plan_descriptors(posix_spawn_file_actions_t *actions,
			    const int sources[GZ_DECODE_FD_END])
{
	int error = 0, end = 0;
	for (int fd = 0; fd < GZ_DECODE_FD_END && !error; fd++) {
		if (fd <= STDERR_FILENO && sources[fd] < 0)
			error = posix_spawn_file_actions_addopen(actions, fd, "/dev/null", O_RDWR,
								 0);
		else if (sources[fd] >= 0)
			error = posix_spawn_file_actions_adddup2(actions, sources[fd], fd);
		end = fd <= STDERR_FILENO || sources[fd] >= 0 ? fd + 1 : end;
	}
	return error ? error : posix_spawn_file_actions_addclosefrom_np(actions, end);
}

static int plan_signals(posix_spawnattr_t *attributes)
{
	sigset_t none, all;
	sigemptyset(&none);
	sigfillset(&all);
	int error = posix_spawnattr_setflags(attributes,
					     POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF);
	if (!error)
		error = posix_spawnattr_setsigmask(attributes, &none);
	return error ? error : posix_spawnattr_setsigdefault(attributes, &all);
}

/* The environment of the decoder: pointers into `texts`, which holds the strings. */
static void keep_environment(char texts[KEPT_COUNT][GZ_PATH_SIZE], char *out[KEPT_COUNT + 1])
{
	int count = 0;
	for (size_t i = 0; i < KEPT_COUNT; i++) {
		const char *value = getenv(kept_variables[i]);
		if (value && (size_t)snprintf(texts[count], GZ_PATH_SIZE, "%s=%s",
					      kept_variables[i], value) < GZ_PATH_SIZE) {
			out[count] = texts[count];
			count++;
		}
	}
	out[count] = NULL;
}

static void print_range(const double range[2], char *text, size_t size)
{
	char least[GZ_NUMBER_SIZE], greatest[GZ_NUMBER_SIZE];
	gz_number_print(range[0], least);
	gz_number_print(range[1], greatest);
	snprintf(text, size, "%s %s", least, greatest);
}

static int spawn_with(const char *program, const struct gz_decode_job *job,
		      const posix_spawn_file_actions_t *actions,
		      const posix_spawnattr_t *attributes, pid_t *out_pid)
{
	char self[32], time_point[32], range[2 * GZ_NUMBER_SIZE] = "";
	char texts[KEPT_COUNT][GZ_PATH_SIZE], *environment[KEPT_COUNT + 1];
	snprintf(self, sizeof self, "%ld", (long)getpid());
	snprintf(time_point, sizeof time_point, "%d", job->time_point);
	if (job->number_range)
		print_range(job->number_range, range, sizeof range);
	keep_environment(texts, environment);
	/* posix_spawn() does not write to them. */
	char *const arguments[] = { (char *)"gazedecode",
				    self,
				    (char *)job->format,
				    (char *)job->path,
				    (char *)(job->choice ? job->choice : ""),
				    time_point,
				    range,
				    (char *)(job->resampling ? job->resampling : "off"),
				    NULL };
	return posix_spawn(out_pid, program, actions, attributes, arguments, environment);
}

/* lent: the decoder's end of the pipe of messages, and the scratch file or -1. */
static int spawn_decoder(const char *program, const struct gz_decode_job *job,
			 struct gz_decode_process *process, const int lent[2])
{
	posix_spawn_file_actions_t actions;
	posix_spawnattr_t attributes;
	const int sources[GZ_DECODE_FD_END] = {
		[STDIN_FILENO] = -1,
		[STDOUT_FILENO] = -1,
		[STDERR_FILENO] = ERRORS_FD,
		[GZ_DECODE_FD_ANSWERS] = process->answers_end,
		[GZ_DECODE_FD_MESSAGES] = lent[0],
		[GZ_DECODE_FD_MEMORY] = process->memory,
		[GZ_DECODE_FD_SCRATCH] = lent[1],
	};
	int error = posix_spawn_file_actions_init(&actions);
	if (error)
		return error;
	error = posix_spawnattr_init(&attributes);
	if (!error) {
		error = plan_descriptors(&actions, sources);
		if (!error)
			error = plan_signals(&attributes);
		if (!error)
			error = spawn_with(program, job, &actions, &attributes, &process->pid);
		posix_spawnattr_destroy(&attributes);
	}
	posix_spawn_file_actions_destroy(&actions);
	if (error)
		process->pid = 0;
	return error;
}

static enum gz_result find_decoder(const struct gz_decode_job *job, char *path, size_t size)
{
	if (job->program)
		return (size_t)snprintf(path, size, "%s", job->program) < size ? GZ_OK
									       : GZ_ERR_ACCESS;
	if (gz_decode_find_program(path, size) == GZ_OK)
		return GZ_OK;
	gz_err(job->log,
	       "%s: cannot be decoded: gazedecode is not installed in " GZ_LIBEXEC_FOLDER
	       " beside this program; install Gazecast again, or name it in GAZECAST_DECODER",
	       job->path);
	return GZ_ERR_ACCESS;
}

enum gz_result gz_decode_process_start(const struct gz_decode_job *job,
				       struct gz_decode_process *process)
{
	char program[GZ_PATH_SIZE];
	*process = GZ_DECODE_NO_PROCESS;
	const enum gz_result result = find_decoder(job, program, sizeof program);
	if (result != GZ_OK)
		return result;
	const bool has_scratch = job->scratch_fd >= 0;
	int lent[2] = { -1, has_scratch ? fcntl(job->scratch_fd, F_DUPFD_CLOEXEC, FD_LEAST) : -1 };
	process->memory = memfd_create("gazecast-voxels", MFD_CLOEXEC | MFD_ALLOW_SEALING);
	const bool ready = open_pipes(process, &lent[0]) && lift_fd(&process->memory) &&
			   (lent[1] >= 0 || !has_scratch);
	int error = ready ? 0 : errno;
	if (ready)
		error = spawn_decoder(program, job, process, lent);
	close_fd(&lent[0]);
	close_fd(&lent[1]);
	if (!ready) {
		gz_err(job->log, "%s: cannot be decoded: no descriptors: %s", job->path,
		       strerror(error));
		return GZ_ERR_NO_MEM;
	}
	if (error) {
		gz_err(job->log, "%s: cannot be decoded: cannot start %s: %s", job->path, program,
		       strerror(error));
		return GZ_ERR_ACCESS;
	}
	return GZ_OK;
}

int gz_decode_process_stop(struct gz_decode_process *process)
{
	int status = 0;
	if (process->pid > 0) {
		kill(process->pid, SIGKILL);
		while (waitpid(process->pid, &status, 0) < 0)
			if (errno != EINTR) {
				status = 0;
				break;
			}
	}
	process->pid = 0;
	close_fd(&process->messages);
	close_fd(&process->answers);
	close_fd(&process->answers_end);
	return status;
}

void gz_decode_process_end(struct gz_decode_process *process)
{
	(void)gz_decode_process_stop(process);
	close_fd(&process->memory);
}
