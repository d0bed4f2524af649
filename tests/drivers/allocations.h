/* Counts the allocations of a thread in this process, including those of libraries. */
#ifndef GZ_TESTS_DRIVERS_ALLOCATIONS_H
#define GZ_TESTS_DRIVERS_ALLOCATIONS_H

/* Calls of malloc(), calloc() and realloc() by this thread so far. -1 if they cannot be counted:
 * under a sanitizer, which replaces these functions, or with a C library other than glibc. */
long allocations_of_this_thread(void);

#endif
