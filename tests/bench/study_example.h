/**
 * @file
 * A small study made up of numbers, for tests of what reads and writes studies.
 */
#ifndef GZ_TESTS_BENCH_STUDY_EXAMPLE_H
#define GZ_TESTS_BENCH_STUDY_EXAMPLE_H

#include "bench/study/study.h"

/** Two scenes, three variants, a size, two backends, four points, two frames; every row of the
 *  shard, whose numbers all differ. The caller's: gz_study_free(). */
struct gz_study study_example(int shard, int shard_count);

#endif
