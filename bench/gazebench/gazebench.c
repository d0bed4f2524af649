/* gazebench: what each saving costs. */
#include "bench/gazebench/gazebench.h"

static const struct gz_command *const commands[] = { &gazebench_report, &gazebench_suggest,
						     &gazebench_compare, &gazebench_stability,
						     NULL };

int main(int argc, char **argv)
{
	const struct gz_command_program program = {
		.name = "gazebench",
		.version = GAZECAST_VERSION,
		.purpose = "Measure what foveated rendering saves and what it costs in error, and "
			   "chart one against the other.",
		.exits = "0 done, 1 failed or refused, 2 usage, 3 a partial result that can be "
			 "resumed, 4 a stability row does not hold",
		.commands = commands,
	};
	return gz_command_main(&program, argc, argv);
}
