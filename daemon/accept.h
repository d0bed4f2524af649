/**
 * @file
 * libzmq's calls of the system for connections, which the daemon answers itself. A program that
 * contains this file defines accept(), accept4() and recv(): its own definitions come before those
 * of the C library, for libzmq too.
 *
 * - libzmq 4.3.4 calls abort() if a local socket cannot accept a connection because no file
 *   descriptor or no memory is left; it tolerates that over TCP. The quota (quota.h) ends
 *   connections beyond its limit, but a burst may come faster than it is counted.
 * - libzmq takes every client and all it sends. The door (door.h) is asked first.
 */
#ifndef GZ_DAEMON_ACCEPT_H
#define GZ_DAEMON_ACCEPT_H

#include <stdbool.h>
#include <stdint.h>
#include <sys/socket.h>

#include "daemon/door.h"

/** As accept4(2), under whose name it is linked, except for two errors. Without a free descriptor
 * or memory it is EAGAIN; libzmq then tries again until the quota has freed a descriptor. So it is
 * if the door refuses the connection, which is then closed. */
int gz_accept4(int fd, struct sockaddr *address, socklen_t *size, int flags) __asm__("accept4");

/** The same for accept(2). */
int gz_accept(int fd, struct sockaddr *address, socklen_t *size) __asm__("accept");

/** As recv(2), under whose name it is linked. What the door refuses is dropped, and the connection
 * has ended: 0. */
ssize_t gz_recv(int fd, void *bytes, size_t size, int flags) __asm__("recv");

/** Whether libzmq finds these definitions. The linker exports them because libzmq needs them. */
bool gz_accept_is_found(void);

/**
 * Ask a door about connections at a port, or at a local socket, from now on. Up to eight of them
 * are kept.
 *
 * @param door  borrowed until gz_accept_freely()
 * @param port  local TCP port at which connections come through it, in the host's byte order
 * @param path  the same for a local socket: its file, as it is bound; copied
 * @return the door's channel (door.h) for these connections, 1 to 8; 0 if there are too many, or
 * the path is too long for a socket: then the door is not asked
 *
 * Threads: any.
 */
int gz_accept_through(struct gz_door *door, uint16_t port);
int gz_accept_through_path(struct gz_door *door, const char *path);

/** Ask no door any more. Threads: any. */
void gz_accept_freely(void);

/** The channel at which connection @p fd came through a door; 0: none. Threads: any. */
int gz_accept_channel(int fd);

/** libzmq has closed a connection that had the number @p fd. Threads: any. */
void gz_accept_ended(int fd);

#endif
