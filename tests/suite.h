/**
 * @file
 * What every test includes first: cmocka, in the order that it demands, and what makes a file a
 * suite.
 */
#ifndef GZ_TESTS_SUITE_H
#define GZ_TESTS_SUITE_H

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

/** Longest wait for a condition that a test needs, s, ms and ns. A test that passes never waits so
 *  long, however busy the machine is. cmake/GzTargets.cmake sets it, for scripts as well. */
#define PATIENCE_S  GZ_TEST_PATIENCE_S
#define PATIENCE_MS (1000 * PATIENCE_S)
#define PATIENCE_NS (INT64_C(1000000000) * PATIENCE_S)

/** How many times slower a program may be in this build than the limits of a release build say. */
#if defined __SANITIZE_ADDRESS__ || defined __SANITIZE_THREAD__
#define SLOWNESS 10
#else
#define SLOWNESS 1
#endif

/** Whether only what several threads do is of interest: a thread sanitizer watches. */
#if defined __SANITIZE_THREAD__
#define THREADS_ONLY 1
#else
#define THREADS_ONLY 0
#endif

/** The suite that a file tests/FOLDER/test_NAME.c holds: what would be its main(). The programs of
 *  gz_test_program() call it. @return 0 if it passes, 77 if it cannot run here */
#define TEST_SUITE(name)                        \
	int test_##name(int argc, char **argv); \
	int test_##name(__attribute__((unused)) int argc, __attribute__((unused)) char **argv)

#endif
