#include "base/command.h"

#include <ctype.h>
#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#define GZ_LOG_MODULE "command"

/* Set by the signal handler, which has no other way to pass it on. */
static volatile sig_atomic_t interrupted;

static void note_signal(int number)
{
	(void)number;
	interrupted = 1;
}

void gz_command_catch_signals(void)
{
	struct sigaction action = { .sa_handler = note_signal };
	sigaction(SIGINT, &action, NULL);
	sigaction(SIGTERM, &action, NULL);
}

bool gz_command_interrupted(void)
{
	return interrupted != 0;
}

/* Print "gazectl: text" in the style of command lines, without level and module. */
static void print_command_message(void *user, enum gz_log_level level, const char *module,
				  const char *message)
{
	const struct gz_command_program *program = user;
	(void)module;
	char line[2048];
	/* The command may have printed a line without its end, to replace it later. */
	bool terminal = isatty(STDERR_FILENO) && isatty(STDOUT_FILENO);
	int length = snprintf(line, sizeof line, "%s%s: %s%s\n", terminal ? "\r\033[K" : "",
			      program->name, level == GZ_LOG_WARN ? "warning: " : "", message);
	if (length >= (int)sizeof line)
		length = sizeof line - 1;
	if (write(STDERR_FILENO, line, (size_t)length) < 0)
		return; /* there is no other place to report it */
}

/* Columns of the longest name, or of the longest operands. */
static int widest_column(const struct gz_command_program *program, bool of_operands)
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
	const int name_width = widest_column(program, false),
		  operands_width = widest_column(program, true);
	fprintf(out, "usage: %s COMMAND [OPTION]... [ARGUMENT]...\n\n%s\n\ncommands:\n",
		program->name, program->purpose);
	for (const struct gz_command *const *command = program->commands; *command; command++)
		fprintf(out, "  %-*s  %-*s  %s\n", name_width, (*command)->name, operands_width,
			(*command)->operands, (*command)->summary);
	fprintf(out,
		"\n`%s COMMAND --help` lists a command's options; the manual is %s(1).\n"
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

int gz_command_read_arguments(const struct gz_command *command, int argc, char *const *argv,
			      const struct gz_log *log, void *settings,
			      struct gz_operands *out_operands)
{
	*out_operands = (struct gz_operands) { .count = 0 };
	const struct gz_option_binding binding = {
		.options = command->options,
		.count = command->option_count,
		.target = settings,
	};
	if (gz_options_preset(&binding) != GZ_OK ||
	    gz_options_read_arguments(&binding, 1, argc, argv, out_operands, log) != GZ_OK)
		return GZ_EXIT_USAGE;
	const struct gz_command_common *common = settings;
	if (common->help) {
		print_command_help(command, &binding);
		return GZ_EXIT_DONE;
	}
	if (command->operands_max >= 0 && out_operands->count > command->operands_max) {
		gz_err(log, "%s: unexpected argument; see %s %s --help",
		       out_operands->items[command->operands_max], command->program, command->name);
		return GZ_EXIT_USAGE;
	}
	return GZ_COMMAND_GO_ON;
}

static const struct gz_command *find_command(const struct gz_command_program *program,
					     const char *name)
{
	for (const struct gz_command *const *command = program->commands; *command; command++)
		if (strcmp((*command)->name, name) == 0)
			return *command;
	return NULL;
}

/* Flush standard output. @return @p status, or GZ_EXIT_FAILED if not everything could be written */
static int flush_output(int status, const struct gz_log *log)
{
	if (fflush(stdout) == 0 && !ferror(stdout))
		return status;
	gz_err(log, "cannot write to standard output: is its disk full?");
	return status == GZ_EXIT_DONE ? GZ_EXIT_FAILED : status;
}

int gz_command_main(const struct gz_command_program *program, int argc, char **argv)
{
	struct gz_log log;
	gz_log_init(&log, print_command_message, (void *)program, NULL);
	if (argc < 2) {
		print_program_help(program, stderr);
		return GZ_EXIT_USAGE;
	}
	if (strcmp(argv[1], "--help") == 0 || strcmp(argv[1], "-h") == 0) {
		print_program_help(program, stdout);
		return flush_output(GZ_EXIT_DONE, &log);
	}
	if (strcmp(argv[1], "--version") == 0) {
		printf("%s %s\n", program->name, program->version);
		return flush_output(GZ_EXIT_DONE, &log);
	}
	const struct gz_command *command = find_command(program, argv[1]);
	if (!command) {
		gz_err(&log, "%s: unknown command; see %s --help", argv[1], program->name);
		return GZ_EXIT_USAGE;
	}
	return flush_output(command->run(argc - 1, argv + 1, &log), &log);
}
