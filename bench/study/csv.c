#include "bench/study/csv.h"

#include <string.h>

char *gz_csv_next_field(char **line)
{
	char *field = *line, *to;
	if (!field)
		return NULL;
	if (*field != '"') {
		*line = strchr(field, ',');
		if (*line)
			*(*line)++ = '\0';
		return field;
	}
	const char *from = field + 1;
	for (to = field; *from && (*from != '"' || from[1] == '"'); from++) {
		from += *from == '"';
		*to++ = *from;
	}
	if (*from != '"' || (from[1] != ',' && from[1] != '\0'))
		return NULL;
	*line = from[1] == ',' ? field + (from + 2 - field) : NULL;
	*to = '\0';
	return field;
}
