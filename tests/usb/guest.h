/**
 * @file
 * What tests do to the guest in which they run.
 */
#ifndef GZ_TESTS_USB_GUEST_H
#define GZ_TESTS_USB_GUEST_H

#include <stdbool.h>
#include <stdint.h>

/** Suspend the machine to RAM; its clock wakes it after 2 to 3 s. @return how long it slept, ns */
int64_t guest_suspend(void);

/** Wait until @p path exists, or no longer exists; fails the test after 10 s. */
void guest_wait_for_file(const char *path, bool wanted);

/** Wait until @p count is at least @p wanted; fails the test after 10 s. */
void guest_wait_for_count(const _Atomic uint32_t *count, uint32_t wanted);

/** Install the project's udev rules, as a user of the machine would, and remove them, even if they
 * are not installed. Devices that are plugged in keep their permissions. */
void guest_install_udev_rules(void);
void guest_remove_udev_rules(void);

#endif
