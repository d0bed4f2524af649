/**
 * @file
 * gazebench called as people call it, in a folder of its own.
 */
#ifndef GZ_TESTS_BENCH_CALLED_H
#define GZ_TESTS_BENCH_CALLED_H

#include "base/text.h"

/** A folder that is made anew for each test; said.txt in it is what was said last. */
struct place {
	char path[64];
	char log[96]; /**< a gaze log in it, for who writes one */
	int status;   /**< that gazebench ended with */
	struct gz_text said;
};

/** Make the folder: 0, or 1 where it cannot be. */
int place_make(struct place *place);

/** Remove the folder and all in it: 0, or 1 where it cannot be. For cmocka's teardown. */
int place_remove(void **state);

/** Run gazebench with up to eight arguments, NULL behind the last, in the place. */
void place_run(struct place *place, const char *const *arguments);

/** Fail unless gazebench ended with @p status and said @p what. */
void assert_said(const struct place *place, int status, const char *what);

#endif
