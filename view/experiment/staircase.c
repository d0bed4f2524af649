#include "view/experiment/staircase.h"

#include <stdio.h>
#include <stdlib.h>

/* Five digits are finer than any threshold; rounding must not leave the range. */
static void write_value(struct gz_staircase *staircase, double value)
{
	const struct gz_quest_params *params = &staircase->quest.params;
	char *text = staircase->setting.value;
	snprintf(text, sizeof staircase->setting.value, "%.5g", value);
	const double written = strtod(text, NULL);
	if (written < params->from || written > params->to)
		snprintf(text, sizeof staircase->setting.value, "%.17g",
			 written < params->from ? params->from : params->to);
}

void gz_staircase_place(struct gz_staircase *staircase)
{
	if (staircase)
		write_value(staircase, gz_quest_next(&staircase->quest));
}

void gz_staircase_take(struct gz_staircase *staircase, bool right)
{
	if (staircase)
		gz_quest_take(&staircase->quest, strtod(staircase->setting.value, NULL), right);
}

bool gz_staircase_finished(const struct gz_staircase *staircase)
{
	return staircase && staircase->stop_sd > 0 &&
	       gz_quest_estimate(&staircase->quest).sd <= staircase->stop_sd;
}

void gz_staircase_go_to_end(struct gz_staircase *staircase, int end)
{
	const struct gz_quest_params *params = &staircase->quest.params;
	write_value(staircase, end ? params->to : params->from);
}
