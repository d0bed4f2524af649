/**
 * @file
 * How many files the daemon may have open. Each connection is one, and libzmq 4.3.4 ends the
 * program where it cannot accept one more at a local socket.
 */
#ifndef GZ_DAEMON_OPEN_FILES_H
#define GZ_DAEMON_OPEN_FILES_H

#include "base/log.h"

/** Fewer are told of: a client that does not close its connections, or somebody who means harm,
 * would soon have them all. Chosen: some hundred times what a laboratory's programs hold. */
#define GZ_OPEN_FILES_ENOUGH 16384

/** Raise the limit to what the system allows this process; warn where that is less than
 * GZ_OPEN_FILES_ENOUGH. What is open stays open. Before the first thread. */
void gz_open_files_allow(const struct gz_log *log);

#endif
