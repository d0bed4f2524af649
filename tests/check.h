/**
 * @file
 * What every cmocka test includes first, in the order cmocka demands.
 */
#ifndef GZ_TESTS_CHECK_H
#define GZ_TESTS_CHECK_H

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#endif
