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

/** The suite that a file tests/FOLDER/test_NAME.c holds: what would be its main(). The programs of
 *  gz_test_program() call it. @return 0 if it passes, 77 if it cannot run here */
#define TEST_SUITE(name)                        \
	int test_##name(int argc, char **argv); \
	int test_##name(__attribute__((unused)) int argc, __attribute__((unused)) char **argv)

#endif
