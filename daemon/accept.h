/**
 * @file
 * Accepting connections while file descriptors are scarce. libzmq 4.3.4 calls abort() if a local
 * socket cannot accept a connection because no file descriptor or no memory is left; it tolerates
 * that over TCP. The quota (quota.h) ends connections beyond its limit, but a burst may come faster
 * than it is counted. So a program that contains this file defines accept() and accept4() itself:
 * its own definitions come before those of the C library, for libzmq too.
 */
#ifndef GZ_DAEMON_ACCEPT_H
#define GZ_DAEMON_ACCEPT_H

#include <stdbool.h>
#include <sys/socket.h>

/** As accept4(2), under whose name it is linked, except for one error: without a free descriptor or
 * memory it is EAGAIN. libzmq then tries again until the quota has freed a descriptor. */
int gz_accept4(int fd, struct sockaddr *address, socklen_t *size, int flags) __asm__("accept4");

/** The same for accept(2). */
int gz_accept(int fd, struct sockaddr *address, socklen_t *size) __asm__("accept");

/** Whether libzmq finds these definitions. The linker exports them because libzmq needs them. */
bool gz_accept_is_found(void);

#endif
