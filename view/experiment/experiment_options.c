#include "view/experiment/experiment.h"

static const char *const asks_names[] = { "auto", "interval", "answer", NULL };
static const char *const interval_order_names[] = { "balanced", "random", "ab", "ba", NULL };
static const char *const order_names[] = { "random", "full_random", "listed", NULL };
static const char *const block_order_names[] = { "listed", "random", "rotated", NULL };
static const char *const gaze_names[] = { "optional", "required", NULL };

#define AT(field) offsetof(struct gz_trial_params, field)

/* A text of one line of the file. */
/* clang-format off */
#define TEXT(name, text, what)                                                                   \
	{ .key = #name, .type = GZ_OPTION_STRING, .offset = AT(name), .max = GZ_INI_LINE_SIZE,   \
	  .preset = text, .help = what }
#define SECONDS(name, least, most, value, what)                                                  \
	{ .key = #name, .type = GZ_OPTION_DOUBLE, .offset = AT(name), .min = least, .max = most, \
	  .preset = value, .help = what }
#define CHOICE(name, names, value, what)                                                         \
	{ .key = #name, .type = GZ_OPTION_CHOICE, .offset = AT(name), .choices = names,          \
	  .preset = value, .help = what }
/* clang-format on */

const struct gz_option gz_trial_options[] = {
	TEXT(scene, "", "scene file, beside the experiment"),
	{ .key = "intervals",
	  .type = GZ_OPTION_INT,
	  .offset = AT(intervals),
	  .min = 1,
	  .max = 2,
	  .preset = "2",
	  .help = "pictures shown one after the other" },
	CHOICE(interval_order, interval_order_names, "balanced",
	       "which alternative comes first: half each way over the repeats, drawn each time, a "
	       "or b"),
	SECONDS(fixation_s, 0, 60, "1", "cross before the first interval, s"),
	SECONDS(duration_s, 0.01, 3600, "2", "each interval, s"),
	SECONDS(blank_s, 0, 60, "0.5", "empty ground between the intervals, s"),
	SECONDS(pause_s, 0, 60, "0.5", "empty ground after the answer, s"),
	TEXT(question, "Which was sharper, the first or the second?", "shown at the end"),
	CHOICE(asks, asks_names, "auto",
	       "what a key means: interval, the first key the first interval; answer, its answer"),
	TEXT(keys, "1 2", "keys that answer: a to z, 0 to 9, left right up down space return"),
	TEXT(answers, "", "what each key stands for; empty: first second, or the keys themselves"),
	TEXT(correct, "", "the alternative (a or b) or the answer that is right; empty: none"),
	SECONDS(timeout_s, 0, 3600, "0", "longest wait for an answer, s; 0: for ever"),
	{ .key = "feedback",
	  .type = GZ_OPTION_BOOL,
	  .offset = AT(feedback),
	  .preset = "no",
	  .help = "tell whether the answer was right" },
	SECONDS(feedback_s, 0.1, 60, "0.8", "how long, s"),
	TEXT(feedback_correct, "Correct", "what it says then"),
	TEXT(feedback_wrong, "Wrong", "and of another answer"),
	TEXT(feedback_late, "Too late", "and of none in time"),
};

const size_t gz_trial_option_count = sizeof gz_trial_options / sizeof gz_trial_options[0];

#undef AT
#define AT(field) offsetof(struct gz_block_params, field)

const struct gz_option gz_block_options[] = {
	TEXT(trials, "*", "names of trials, parted by blanks; * stands for any part of a name"),
	{ .key = "repeats",
	  .type = GZ_OPTION_INT,
	  .offset = AT(repeats),
	  .min = 1,
	  .max = 1000,
	  .preset = "1",
	  .help = "how often each comes" },
	CHOICE(order, order_names, "random",
	       "random: each once before any again; full_random: over all repeats; listed"),
	{ .key = "practice",
	  .type = GZ_OPTION_BOOL,
	  .offset = AT(practice),
	  .preset = "no",
	  .help = "trials that do not count: a column tells" },
	{ .key = "break_every",
	  .type = GZ_OPTION_INT,
	  .offset = AT(break_every),
	  .min = 0,
	  .max = 10000,
	  .preset = "0",
	  .help = "a break after so many trials; 0: none" },
	TEXT(break_text, "Have a break.\\nSpace goes on.", "shown in it"),
	TEXT(instructions, "", "shown before the block"),
	TEXT(instructions_file, "", "text file in place of it"),
};

const size_t gz_block_option_count = sizeof gz_block_options / sizeof gz_block_options[0];

#undef AT
#define AT(field) offsetof(struct gz_experiment_params, field)

const struct gz_option gz_experiment_options[] = {
	{ .key = "name",
	  .type = GZ_OPTION_STRING,
	  .offset = AT(name),
	  .max = GZ_EXPERIMENT_LABEL_SIZE,
	  .preset = "",
	  .help = "letters and digits: of the file of answers" },
	{ .key = "seed",
	  .type = GZ_OPTION_INT,
	  .offset = AT(seed),
	  .min = 0,
	  .max = 2147483647,
	  .preset = "1",
	  .help = "of the orders that are drawn, with participant and session" },
	CHOICE(block_order, block_order_names, "listed",
	       "of the blocks; rotated begins one further for each participant number; practice "
	       "stays"),
	CHOICE(gaze, gaze_names, "optional",
	       "required: nothing begins and no interval is shown without a tracker's gaze"),
	TEXT(instructions, "", "shown first"),
	TEXT(instructions_file, "", "text file in place of it"),
	TEXT(goodbye, "That was all. Thank you.\\nSpace ends.", "shown last"),
	{ .key = "ground",
	  .type = GZ_OPTION_DOUBLE,
	  .offset = AT(ground),
	  .min = 0,
	  .max = 1,
	  .count = 3,
	  .preset = "0.5 0.5 0.5",
	  .help = "red, green, blue between pictures" },
	{ .key = "text_size",
	  .type = GZ_OPTION_DOUBLE,
	  .offset = AT(text_size),
	  .min = 0.005,
	  .max = 0.2,
	  .preset = "0.035",
	  .help = "height of a line of text, share of the picture's" },
	{ .key = "fixation_deg",
	  .type = GZ_OPTION_DOUBLE,
	  .offset = AT(fixation_deg),
	  .min = 0.05,
	  .max = 10,
	  .preset = "0.6",
	  .help = "of the cross, across, degrees" },
};

const size_t gz_experiment_option_count =
	sizeof gz_experiment_options / sizeof gz_experiment_options[0];
