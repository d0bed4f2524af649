/**
 * @file
 * A temporary folder for the tests of a suite: `place`.
 */
#ifndef GZ_TESTS_VIEW_PLACE_H
#define GZ_TESTS_VIEW_PLACE_H

#include "suite.h"

#include <stdio.h>
#include <stdlib.h>

#include "base/sizes.h"

static char place[64];

/** Create the folder. @return 0, or 1 if it cannot be created */
static inline int create_place(void)
{
	snprintf(place, sizeof place, "/tmp/gazeview-test-XXXXXX");
	return mkdtemp(place) ? 0 : 1;
}

/** The path of @p name in the folder. Valid for three further calls. */
static inline const char *in_place(const char *name)
{
	static char paths[4][GZ_PATH_SIZE];
	static int next;
	char *path = paths[next++ % 4];
	snprintf(path, GZ_PATH_SIZE, "%s/%s", place, name);
	return path;
}

/** Write a file into the folder. @return its path, like in_place() */
static inline const char *write_in_place(const char *name, const char *text)
{
	const char *path = in_place(name);
	FILE *file = fopen(path, "w");
	assert_non_null(file);
	fputs(text, file);
	fclose(file);
	return path;
}

/** Teardown of the suite: remove the folder with its contents. */
static inline int remove_place(void **state)
{
	char command[128];
	(void)state;
	snprintf(command, sizeof command, "rm -r '%s'", place);
	return system(command);
}

#endif
