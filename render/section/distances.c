#include "render/section/distances.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum { LINE_NUMBERS = 6 };

double gz_distance_length(const struct gz_volume *volume, const struct gz_distance *line)
{
	double sum = 0;
	for (int i = 0; i < 3; i++)
		sum += pow((line->ends[1][i] - line->ends[0][i]) * volume->dims[i] *
				   volume->spacing[i],
			   2);
	return sqrt(sum);
}

/* @return whether there was a number; the text that is left begins with no blank */
static bool take_share(const char **text, double *out_share)
{
	char *end;
	*out_share = strtod(*text, &end);
	const bool whole = end != *text && (*end == ' ' || *end == '\0');
	while (*end == ' ')
		end++;
	*text = end;
	return whole && *out_share >= 0 && *out_share <= 1;
}

bool gz_distances_parse(const char *text, struct gz_distances *out)
{
	struct gz_distances read = { 0 };
	while (*text == ' ')
		text++;
	while (*text) {
		if (read.count == GZ_DISTANCES_MAX)
			return false;
		struct gz_distance *line = &read.lines[read.count++];
		for (int i = 0; i < LINE_NUMBERS; i++)
			if (!take_share(&text, &line->ends[i / 3][i % 3]))
				return false;
	}
	*out = read;
	return true;
}

void gz_distances_print(const struct gz_distances *distances, char out_text[GZ_DISTANCES_SIZE])
{
	int used = 0;
	out_text[0] = '\0';
	for (int n = 0; n < distances->count; n++)
		for (int i = 0; i < LINE_NUMBERS; i++)
			used += snprintf(out_text + used, (size_t)(GZ_DISTANCES_SIZE - used),
					 "%s%.6g", used ? " " : "",
					 distances->lines[n].ends[i / 3][i % 3]);
}
