/**
 * @file
 * Sockets of the runtime directory that a service manager has bound before it started the daemon,
 * as sd_listen_fds(3) of systemd describes them: a client that connects to one of them starts the
 * daemon. They are recognised by their paths.
 */
#ifndef GZ_DAEMON_HANDED_SOCKETS_H
#define GZ_DAEMON_HANDED_SOCKETS_H

#include <stdbool.h>
#include <stddef.h>
#include <sys/un.h>

#include "base/log.h"
#include "base/result.h"

/** Most sockets that are taken over: the daemon has five. */
#define GZ_HANDED_SOCKETS_MAX 8

/** The sockets. Plain data; gz_handed_sockets_take_over() fills it. */
struct gz_handed_sockets {
	size_t count;
	struct gz_handed_socket {
		int fd;   /**< -1: somebody owns it already */
		int type; /**< SOCK_STREAM or SOCK_SEQPACKET */
		char path[sizeof((struct sockaddr_un *)NULL)->sun_path];
	} items[GZ_HANDED_SOCKETS_MAX];
};

/**
 * Read LISTEN_PID and LISTEN_FDS, and take over the descriptors that they name: they do not block,
 * are closed in child processes, and the variables are unset. Descriptors that are not listening
 * local sockets are closed with a warning. Call it before any thread starts.
 *
 * @param[out] out_sockets  always filled; empty if no service manager has handed over any
 */
void gz_handed_sockets_take_over(struct gz_handed_sockets *out_sockets, const struct gz_log *log);

/**
 * Take the socket that is bound to @p path.
 *
 * @param sockets  may be NULL: there is none
 * @param type     SOCK_STREAM or SOCK_SEQPACKET
 * @return the descriptor, now the caller's; -1 if none was handed over for it
 */
int gz_handed_sockets_take(struct gz_handed_sockets *sockets, const char *path, int type);

/** Warn about sockets that nobody has taken, and close them. */
void gz_handed_sockets_close(struct gz_handed_sockets *sockets, const struct gz_log *log);

/**
 * Whether a process of this machine listens at the local socket @p path, without connecting to it:
 * a socket of a service manager would start the daemon.
 */
bool gz_socket_is_listened_at(const char *path);

#endif
