#include "suite.h"

#include "program.h"

#include <poll.h>
#include <signal.h>
#include <stdbool.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include "base/clock.h"

void program_start(struct program *program, const char *const *arguments)
{
	int out[2], err[2];
	*program = (struct program) { 0 };
	assert_int_equal(pipe(out), 0);
	assert_int_equal(pipe(err), 0);
	program->process = fork();
	assert_true(program->process >= 0);
	if (program->process == 0) {
		prctl(PR_SET_PDEATHSIG, SIGKILL);
		dup2(out[1], STDOUT_FILENO);
		dup2(err[1], STDERR_FILENO);
		close(out[0]);
		close(err[0]);
		execv(arguments[0], (char *const *)arguments);
		_exit(127);
	}
	close(out[1]);
	close(err[1]);
	program->out = out[0];
	program->err = err[0];
}

void program_kill(struct program *program)
{
	if (program->process > 0) {
		kill(program->process, SIGKILL);
		waitpid(program->process, NULL, 0);
	}
	program->process = 0;
}

/* Append what can be read; false at the end of the file. */
static bool collect(int file, char *text, size_t room, size_t *size)
{
	char spill[512];
	bool full = *size + 1 >= room;
	ssize_t n =
		full ? read(file, spill, sizeof spill) : read(file, text + *size, room - 1 - *size);
	if (n > 0 && !full)
		*size += (size_t)n;
	text[*size] = '\0';
	return n > 0;
}

bool program_collect(struct program *program, int wait_ms)
{
	struct pollfd files[] = { { program->out, POLLIN, 0 }, { program->err, POLLIN, 0 } };
	if (program->out < 0 && program->err < 0)
		return false;
	poll(files, 2, wait_ms);
	if (files[0].revents && !collect(program->out, program->out_text, sizeof program->out_text,
					 &program->out_size)) {
		close(program->out);
		program->out = -1;
	}
	if (files[1].revents && !collect(program->err, program->err_text, sizeof program->err_text,
					 &program->err_size)) {
		close(program->err);
		program->err = -1;
	}
	return true;
}

/* Wait for output. Returns false when both pipes are closed; fails at the deadline. */
static bool collect_both(struct program *program, int64_t deadline_ns)
{
	if (!program_collect(program, 100))
		return false;
	if (gz_clock_now_ns() > deadline_ns) {
		program_kill(program);
		fail_msg("the program goes on; it printed:\n%s\n%s", program->out_text,
			 program->err_text);
	}
	return true;
}

void program_wait_for(struct program *program, const char *text)
{
	int64_t deadline_ns = gz_clock_now_ns() + PATIENCE_NS;
	while (!strstr(program->out_text, text) && !strstr(program->err_text, text))
		if (!collect_both(program, deadline_ns))
			fail_msg("it ended without \"%s\":\n%s\n%s", text, program->out_text,
				 program->err_text);
}

void program_finish(struct program *program)
{
	int64_t deadline_ns = gz_clock_now_ns() + PATIENCE_NS;
	while (collect_both(program, deadline_ns))
		;
	int status;
	assert_int_equal(waitpid(program->process, &status, 0), program->process);
	program->process = 0;
	program->status = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

void program_run(struct program *program, const char *const *arguments)
{
	program_start(program, arguments);
	program_finish(program);
}
