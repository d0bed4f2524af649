/**
 * @file
 * How a reader gets the daemon's board: it connects to the socket "board" in the runtime directory,
 * and is sent the descriptor of the memory. It sends nothing itself. Who may open that socket may
 * open the socket "stream" beside it, which carries the same messages.
 */
#ifndef GZ_PROTOCOL_BOARD_BOARD_DOOR_H
#define GZ_PROTOCOL_BOARD_BOARD_DOOR_H

#include "base/result.h"

/** The name of the socket in the runtime directory. */
#define GZ_BOARD_DOOR_NAME "board"

/**
 * Bind the socket at @p path and listen; a socket file that is there is replaced.
 *
 * @param[out] out_fd  owned by the caller: close()
 * @retval GZ_ERR_FULL  the path is too long for a socket
 * @retval GZ_ERR_IO    with errno set
 */
enum gz_result gz_board_door_open(const char *path, int *out_fd);

/**
 * Let in one reader that waits at @p door: send it the descriptor @p board_fd. Never waits.
 *
 * @retval GZ_OK           done; also if the reader has gone already
 * @retval GZ_ERR_TIMEOUT  nobody waits
 * @retval GZ_ERR_FULL     no descriptor or no memory is left; try again later
 */
enum gz_result gz_board_door_serve(int door, int board_fd);

/**
 * Ask at the socket @p path for the board. Never waits.
 *
 * @param[out] out_fd  a connection, for gz_board_door_take(); owned by the caller: close()
 * @retval GZ_ERR_NOT_FOUND  nobody listens there, or we may not ask
 * @retval GZ_ERR_BUSY       too many others ask, or no descriptor or memory is left; try again
 * @retval GZ_ERR_FULL       the path is too long for a socket
 */
enum gz_result gz_board_door_ask(const char *path, int *out_fd);

/**
 * Take the answer. Never waits; poll() tells when it is there.
 *
 * @param fd  from gz_board_door_ask()
 * @param[out] out_board_fd  the memory, for gz_board_open(); owned by the caller: close()
 * @retval GZ_ERR_TIMEOUT   there is no answer yet
 * @retval GZ_ERR_PROTOCOL  what came is no answer, or the connection has ended without one
 */
enum gz_result gz_board_door_take(int fd, int *out_board_fd);

#endif
