/* Counts what a thread allocates, in this process, whoever asks for it. */
#ifndef GZ_TESTS_DRIVERS_ALLOCATIONS_H
#define GZ_TESTS_DRIVERS_ALLOCATIONS_H

/* Calls of malloc(), calloc() and realloc() by this thread so far; -1 where they cannot be counted:
 * under a sanitizer, which has its own, or another C library than glibc. */
long allocations_of_this_thread(void);

#endif
