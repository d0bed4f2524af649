#include "suite.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "bench/report/charts.h"
#include "called.h"

int place_make(struct place *place)
{
	*place = (struct place) { .status = 0 };
	snprintf(place->path, sizeof place->path, "/tmp/gazebench-test-XXXXXX");
	if (!mkdtemp(place->path))
		return 1;
	snprintf(place->log, sizeof place->log, "%s/viewer.gzl", place->path);
	return 0;
}

int place_remove(void **state)
{
	struct place *place = *state;
	char rm[] = "rm", rf[] = "-rf";
	char *const arguments[] = { rm, rf, place->path, NULL };
	int status;
	gz_text_free(&place->said);
	return gz_child_run("/tmp", arguments, "/dev/null", &status) == GZ_OK ? status : 1;
}

void place_run(struct place *place, const char *const *arguments)
{
	char path[96], copies[9][128], *pointers[10] = { NULL };
	snprintf(copies[0], sizeof copies[0], "%s", GAZEBENCH_PROGRAM);
	pointers[0] = copies[0];
	for (int i = 0; arguments[i]; i++) {
		assert_true(i < 8);
		snprintf(copies[i + 1], sizeof copies[0], "%s", arguments[i]);
		pointers[i + 1] = copies[i + 1];
	}
	assert_int_equal(gz_child_run(place->path, pointers, "said.txt", &place->status), GZ_OK);
	gz_text_free(&place->said);
	snprintf(path, sizeof path, "%s/said.txt", place->path);
	assert_int_equal(gz_text_add_file(&place->said, path), GZ_OK);
}

void assert_said(const struct place *place, int status, const char *what)
{
	const char *said = place->said.bytes ? place->said.bytes : "";
	if (place->status != status || !strstr(said, what))
		fail_msg("exit status %d, not %d, or without \"%s\": %s", place->status, status,
			 what, said);
}
