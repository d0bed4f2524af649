/* gazectl: the command line of the daemon. Finds the command and lets it run. */
#include "client/gazectl/gazectl.h"

#include <stdio.h>
#include <string.h>
#include <unistd.h>

#define GZ_LOG_MODULE "gazectl"

static const struct gazectl_command *const commands[] = {
	&gazectl_devices, &gazectl_status,   &gazectl_watch,  &gazectl_record,  &gazectl_stop,
	&gazectl_inspect, &gazectl_validate, &gazectl_keygen, &gazectl_convert,
};

enum { COMMAND_COUNT = sizeof commands / sizeof commands[0] };

/* Set by a signal handler, which can reach nothing else. */
static volatile sig_atomic_t interrupted;

static void on_signal(int number)
{
	(void)number;
	interrupted = 1;
}

void gazectl_catch_signals(void)
{
	/* Without SA_RESTART: a wait for messages ends at once. */
	struct sigaction action = { .sa_handler = on_signal };
	sigaction(SIGINT, &action, NULL);
	sigaction(SIGTERM, &action, NULL);
}

bool gazectl_interrupted(void)
{
	return interrupted != 0;
}

/* "gazectl: text", as command lines do, without level and module. */
static void log_to_stderr(void *user, enum gz_log_level level, const char *module,
			  const char *message)
{
	(void)user;
	(void)module;
	char line[2048];
	/* `watch` may have left a line that it means to replace. */
	bool terminal = isatty(STDERR_FILENO) && isatty(STDOUT_FILENO);
	int length = snprintf(line, sizeof line, "%sgazectl: %s%s\n", terminal ? "\r\033[K" : "",
			      level == GZ_LOG_WARN ? "warning: " : "", message);
	if (length >= (int)sizeof line)
		length = sizeof line - 1;
	if (write(STDERR_FILENO, line, (size_t)length) < 0)
		return; /* nowhere left to say it */
}

static void print_help(FILE *out)
{
	fputs("usage: gazectl COMMAND [OPTION]... [ARGUMENT]...\n\n"
	      "Ask the gaze daemon how it is, follow what it sees, record it, and look into "
	      "recordings.\n\ncommands:\n",
	      out);
	for (int i = 0; i < COMMAND_COUNT; i++)
		fprintf(out, "  %-8s %-13s %s\n", commands[i]->name, commands[i]->operands,
			commands[i]->summary);
	fputs("\n`gazectl COMMAND --help` tells the options of each; gazectl(1) tells all.\n"
	      "exit status: 0 done, 1 failed or refused, 2 usage, 3 no daemon answers, "
	      "4 the log is cut or corrupted, 5 the check was cancelled\n",
	      out);
}

static const struct gazectl_command *find_command(const char *name)
{
	for (int i = 0; i < COMMAND_COUNT; i++)
		if (strcmp(commands[i]->name, name) == 0)
			return commands[i];
	return NULL;
}

/* Whether all that was printed has reached its file. */
static enum gazectl_exit finish(enum gazectl_exit status, const struct gz_log *log)
{
	if (fflush(stdout) == 0 && !ferror(stdout))
		return status;
	gz_err(log, "cannot write to standard output: is its disk full?");
	return status == GAZECTL_DONE ? GAZECTL_FAILED : status;
}

int main(int argc, char **argv)
{
	struct gz_log log;
	gz_log_init(&log, log_to_stderr, NULL, NULL);
	if (argc < 2) {
		print_help(stderr);
		return GAZECTL_USAGE;
	}
	if (strcmp(argv[1], "--help") == 0 || strcmp(argv[1], "-h") == 0) {
		print_help(stdout);
		return finish(GAZECTL_DONE, &log);
	}
	if (strcmp(argv[1], "--version") == 0) {
		puts("gazectl " GAZECAST_VERSION);
		return finish(GAZECTL_DONE, &log);
	}
	const struct gazectl_command *command = find_command(argv[1]);
	if (!command) {
		gz_err(&log, "%s is no command: see gazectl --help", argv[1]);
		return GAZECTL_USAGE;
	}
	return finish(command->run(argc - 1, argv + 1, &log), &log);
}
