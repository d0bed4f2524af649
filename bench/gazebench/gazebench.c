/* gazebench: what each saving costs. */
#include "bench/gazebench/gazebench.h"

#include <string.h>

/* clang-format off */
static const struct gz_command *const commands[] = {
	&gazebench_run,
	&gazebench_merge,
	&gazebench_report,
	&gazebench_suggest,
	&gazebench_accumulate,
	&gazebench_compare,
	&gazebench_filter,
	&gazebench_stability,
	NULL,
};
/* clang-format on */

/* What is no command: --list, with --json behind it or not. */
static bool asks_for_list(int argc, char **argv)
{
	return argc >= 2 && strcmp(argv[1], "--list") == 0 &&
	       (argc == 2 || (argc == 3 && strcmp(argv[2], "--json") == 0));
}

int main(int argc, char **argv)
{
	if (asks_for_list(argc, argv))
		return gazebench_list(argc == 3);
	const struct gz_command_program program = {
		.name = "gazebench",
		.version = GAZECAST_VERSION,
		.purpose = "Measure what foveated rendering saves and what it costs in error, and "
			   "chart one against the other.\n\n`gazebench --list [--json]` names "
			   "methods, their options, paths, metrics and backends.",
		.exits = "0 done, 1 failed or refused, 2 called wrongly (no such option, method, "
			 "size), 3 a partial\nresult that can be resumed, 4 a stability row does "
			 "not hold",
		.commands = commands,
	};
	return gz_command_main(&program, argc, argv);
}
