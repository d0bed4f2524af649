#include "view/options/target_options.h"

#include <string.h>

#include "base/clock.h"
#include "sim/random.h"

#define AT(field) offsetof(struct gz_target_options, field)

static const char *const order_names[] = { "fixed", "random", NULL };
static const char *const advance_names[] = { "auto", "space", NULL };

const struct gz_option gz_target_option_table[] = {
	{ "targets", GZ_OPTION_STRING, AT(targets), .max = GZ_PATH_SIZE, .preset = "",
	  .help = "show fixation targets instead of a scene: 5, 9, 13, or a file with lines \"x "
		  "y\"; events are printed on standard output" },
	{ "duration", GZ_OPTION_DOUBLE, AT(duration_s), 0.5, 60, .preset = "2.5",
	  .help = "time each target is shown, s" },
	{ "order", GZ_OPTION_CHOICE, AT(order), .choices = order_names, .preset = "random",
	  .help = "order of the targets: as listed or random" },
	{ "seed", GZ_OPTION_INT, AT(seed), 0, 2147483647, .preset = "0",
	  .help = "random seed of the order; 0: a new order each time" },
	{ "advance", GZ_OPTION_CHOICE, AT(advance), .choices = advance_names, .preset = "auto",
	  .help = "go to the next target automatically, or when Space or a button of the mouse is "
		  "pressed" },
	{ "instructions", GZ_OPTION_BOOL, AT(instructions), .preset = "true",
	  .help = "show instructions first and wait for Space or a click" },
	{ "window", GZ_OPTION_BOOL, AT(windowed), .preset = "false",
	  .help = "show targets or an experiment in a window instead of full screen" },
};

const size_t gz_target_option_count =
	sizeof gz_target_option_table / sizeof gz_target_option_table[0];

/* From the centre outwards: the first 5, 9 or 13 make a layout. */
static const struct gz_point layout[] = {
	{ 0.5f, 0.5f }, { 0.1f, 0.1f }, { 0.9f, 0.1f }, { 0.1f, 0.9f }, { 0.9f, 0.9f },
	{ 0.5f, 0.1f }, { 0.1f, 0.5f }, { 0.9f, 0.5f }, { 0.5f, 0.9f }, { 0.3f, 0.3f },
	{ 0.7f, 0.3f }, { 0.3f, 0.7f }, { 0.7f, 0.7f },
};

static void shuffle_targets(struct gz_targets *targets, int seed)
{
	const uint64_t start = seed > 0 ? (uint64_t)seed : (uint64_t)gz_clock_now_ns();
	struct gz_random random = gz_random_seeded(start, 0);
	gz_random_shuffle(&random, targets->target, targets->count, sizeof targets->target[0]);
}

enum gz_result gz_target_places(const struct gz_target_options *options, const struct gz_log *log,
				struct gz_targets *out_targets)
{
	static const char *const names[] = { "5", "9", "13" };
	static const size_t counts[] = { 5, 9, 13 };
	struct gz_targets targets = { .count = 0 };
	for (size_t i = 0; i < sizeof names / sizeof names[0]; i++)
		if (strcmp(options->targets, names[i]) == 0)
			targets.count = counts[i];
	for (size_t i = 0; i < targets.count; i++)
		targets.target[i] = (struct gz_target) { layout[i], 1 };
	if (targets.count == 0) {
		enum gz_result r = gz_targets_load(options->targets, log, &targets);
		if (r != GZ_OK)
			return r;
	}
	if (options->order == GZ_TARGET_ORDER_RANDOM)
		shuffle_targets(&targets, options->seed);
	*out_targets = targets;
	return GZ_OK;
}
