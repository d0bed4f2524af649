#include "base/command.h"

#include <ctype.h>
#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#define GZ_LOG_MODULE "command"

/* Set by a signal handler, which can reach nothing else. */
static volatile sig_atomic_t interrupted;

static void on_signal(int number)
{
	(void)number;
	interrupted = 1;
}

void gz_command_catch_signals(void)
{
	struct sigaction action = { .sa_handler = on_signal };
	sigaction(SIGINT, &action, NULL);
	sigaction(SIGTERM, &action, NULL);
}

bool gz_command_interrupted(void)
{
	return interrupted != 0;
}

/* "gazectl: text", as command lines do, without level and module. */
static void log_to_stderr(void *user, enum gz_log_level level, const char *module,
			  const char *message)
{
	const struct gz_command_program *program = user;
	(void)module;
	char line[2048];
	/* The command may have left a line that it means to replace. */
	bool terminal = isatty(STDERR_FILENO) && isatty(STDOUT_FILENO);
	int length = snprintf(line, sizeof line, "%s%s: %s%s\n", terminal ? "\r\033[K" : "",
			      program->name, level == GZ_LOG_WARN ? "warning: " : "", message);
	if (length >= (int)sizeof line)
		length = sizeof line - 1;
	if (write(STDERR_FILENO, line, (size_t)length) < 0)
		return; /* nowhere left to say it */
}

/* Columns of the longest name, or of the longest operands. */
static int widest(const struct gz_command_program *program, bool of_operands)
{
	int width = 0;
	for (const struct gz_command *const *command = program->commands; *command; command++) {
		const char *text = of_operands ? (*command)->operands : (*command)->name;
		const int length = (int)strlen(text);
		width = length > width ? length : width;
	}
	return width;
}

static void print_program_help(const struct gz_command_program *program, FILE *out)
{
	const int name_width = widest(program, false), operands_width = widest(program, true);
	fprintf(out, "usage: %s COMMAND [OPTION]... [ARGUMENT]...\n\n%s\n\ncommands:\n",
		program->name, program->purpose);
	for (const struct gz_command *const *command = program->commands; *command; command++)
		fprintf(out, "  %-*s  %-*s  %s\n", name_width, (*command)->name, operands_width,
			(*command)->operands, (*command)->summary);
	fprintf(out,
		"\n`%s COMMAND --help` tells the options of each; %s(1) tells all.\n"
		"exit status: %s\n",
		program->name, program->name, program->exits);
}

static void print_command_help(const struct gz_command *command,
			       const struct gz_option_binding *binding)
{
	printf("usage: %s %s [OPTION]...%s%s\n\n%c%s.\n%s\noptions:\n", command->program,
	       command->name, command->operands[0] ? " " : "", command->operands,
	       toupper((unsigned char)command->summary[0]), command->summary + 1, command->details);
	gz_options_print_help(binding, 1, stdout);
}

bool gz_command_read_arguments(const struct gz_command *command, int argc, char *const *argv,
			       const struct gz_log *log, void *settings,
			       struct gz_operands *out_operands, int *out_exit)
{
	*out_exit = GZ_EXIT_USAGE;
	if (argc > GZ_COMMAND_ARGUMENTS_MAX) {
		gz_err(log, "%d arguments: at most %d are understood", argc,
		       GZ_COMMAND_ARGUMENTS_MAX);
		return false;
	}
	*out_operands = (struct gz_operands) { 0 };
	const struct gz_option_binding binding = {
		.options = command->options,
		.count = command->option_count,
		.target = settings,
	};
	if (gz_options_preset(&binding) != GZ_OK ||
	    gz_options_read_arguments(&binding, 1, argc, argv, out_operands->items,
				      &out_operands->count, log) != GZ_OK)
		return false;
	const struct gz_command_common *common = settings;
	if (common->help) {
		print_command_help(command, &binding);
		*out_exit = GZ_EXIT_DONE;
		return false;
	}
	if (command->operands_max >= 0 && out_operands->count > command->operands_max) {
		gz_err(log, "%s: one argument too many: see %s %s --help",
		       out_operands->items[command->operands_max], command->program, command->name);
		return false;
	}
	return true;
}

static const struct gz_command *find_command(const struct gz_command_program *program,
					     const char *name)
{
	for (const struct gz_command *const *command = program->commands; *command; command++)
		if (strcmp((*command)->name, name) == 0)
			return *command;
	return NULL;
}

/* Whether all that was printed has reached its file. */
static int finish(int status, const struct gz_log *log)
{
	if (fflush(stdout) == 0 && !ferror(stdout))
		return status;
	gz_err(log, "cannot write to standard output: is its disk full?");
	return status == GZ_EXIT_DONE ? GZ_EXIT_FAILED : status;
}

int gz_command_main(const struct gz_command_program *program, int argc, char **argv)
{
	struct gz_log log;
	gz_log_init(&log, log_to_stderr, (void *)program, NULL);
	if (argc < 2) {
		print_program_help(program, stderr);
		return GZ_EXIT_USAGE;
	}
	if (strcmp(argv[1], "--help") == 0 || strcmp(argv[1], "-h") == 0) {
		print_program_help(program, stdout);
		return finish(GZ_EXIT_DONE, &log);
	}
	if (strcmp(argv[1], "--version") == 0) {
		printf("%s %s\n", program->name, program->version);
		return finish(GZ_EXIT_DONE, &log);
	}
	const struct gz_command *command = find_command(program, argv[1]);
	if (!command) {
		gz_err(&log, "%s is no command: see %s --help", argv[1], program->name);
		return GZ_EXIT_USAGE;
	}
	return finish(command->run(argc - 1, argv + 1, &log), &log);
}
