/**
 * @file
 * The daemon's board (protocol/board/board.h), and the thread that hands it to readers at the
 * socket "board" of the runtime directory.
 */
#ifndef GZ_DAEMON_BOARD_SERVER_H
#define GZ_DAEMON_BOARD_SERVER_H

#include "base/result.h"
#include "daemon/handed_sockets.h"
#include "protocol/board/board.h"

/** A board and its thread. */
struct gz_board_server;

/**
 * Create the board, bind the socket or take over the one that a service manager has bound there,
 * and start the thread. The socket's permissions are those of the stream's local socket.
 *
 * @param directory  the runtime directory, which this process has locked
 * @param handed     sockets of a service manager; NULL: none
 * @param[out] out_server  owned by the caller: gz_board_server_destroy()
 * @retval GZ_ERR_NO_MEM  no memory, descriptor or thread
 * @retval GZ_ERR_FULL    the path of the directory is too long
 * @retval GZ_ERR_IO      the socket cannot be bound
 * @retval GZ_ERR_UNSUPPORTED  as gz_board_create()
 */
enum gz_result gz_board_server_create(const char *directory, struct gz_handed_sockets *handed,
				      struct gz_board_server **out_server);

/** The board. Its writer is the caller's thread. */
struct gz_board *gz_board_server_board(const struct gz_board_server *server);

/** Stop the thread, remove the socket unless it was handed over, free everything and set *server to
 * NULL. Accepts a pointer to NULL. */
void gz_board_server_destroy(struct gz_board_server **server);

#endif
