#include "daemon/board_server.h"

#include <errno.h>
#include <poll.h>
#include <pthread.h>
#include <stdbool.h>
#include <stdlib.h>
#include <sys/eventfd.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/sizes.h"
#include "base/text.h"
#include "protocol/board/board_door.h"
#include "protocol/endpoint.h"

/* Pause after a reader could not be let in because descriptors are scarce, ms. Chosen: readers go
 * on without the board after that time. */
enum { SCARCITY_PAUSE_MS = 100 };

struct gz_board_server {
	struct gz_board *board;
	char path[GZ_PATH_SIZE]; /* of the socket */
	int door;
	bool was_handed; /* the service manager keeps the socket's file */
	int quit_fd;     /* eventfd */
	pthread_t thread;
	bool has_thread;
};

/* Most readers let in before the thread looks whether it shall quit. */
enum { AT_ONCE = 64 };

/* Let in those who wait. If nobody could be let in, no descriptor is left, and the door stays
 * readable: wait, instead of trying again at once. */
static void serve_door(const struct gz_board_server *server)
{
	struct pollfd quit = { .fd = server->quit_fd, .events = POLLIN };
	int served = 0;
	while (served < AT_ONCE &&
	       gz_board_door_serve(server->door, gz_board_fd(server->board)) == GZ_OK)
		served++;
	if (served == 0)
		poll(&quit, 1, SCARCITY_PAUSE_MS);
}

static void *board_server_run(void *user)
{
	const struct gz_board_server *server = user;
	pthread_setname_np(pthread_self(), "gazed-board");
	struct pollfd fds[] = { { .fd = server->quit_fd, .events = POLLIN },
				{ .fd = server->door, .events = POLLIN } };
	for (;;) {
		if (poll(fds, 2, -1) < 0 && errno != EINTR)
			return NULL;
		if (fds[0].revents)
			return NULL;
		serve_door(server);
	}
}

static enum gz_result open_door(struct gz_board_server *server, const char *directory,
				struct gz_handed_sockets *handed)
{
	enum gz_result result = gz_text_print(server->path, sizeof server->path, "%s/%s", directory,
					      GZ_BOARD_DOOR_NAME);
	if (result != GZ_OK)
		return result;
	server->door = gz_handed_sockets_take(handed, server->path, SOCK_SEQPACKET);
	server->was_handed = server->door >= 0;
	if (server->was_handed)
		return GZ_OK;
	result = gz_board_door_open(server->path, &server->door);
	if (result != GZ_OK)
		return result;
	mode_t mode = gz_runtime_directory_is_shared(directory) ? 0660 : 0600;
	return chmod(server->path, mode) == 0 ? GZ_OK : GZ_ERR_IO;
}

static enum gz_result start_board_thread(struct gz_board_server *server)
{
	server->quit_fd = eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
	if (server->quit_fd < 0 ||
	    pthread_create(&server->thread, NULL, board_server_run, server) != 0)
		return GZ_ERR_NO_MEM;
	server->has_thread = true;
	return GZ_OK;
}

enum gz_result gz_board_server_create(const char *directory, struct gz_handed_sockets *handed,
				      struct gz_board_server **out_server)
{
	struct gz_board_server *server = calloc(1, sizeof *server);
	if (!server)
		return GZ_ERR_NO_MEM;
	server->door = server->quit_fd = -1;
	enum gz_result result = gz_board_create(GZ_BOARD_SIZE, &server->board);
	if (result == GZ_OK)
		result = open_door(server, directory, handed);
	if (result == GZ_OK)
		result = start_board_thread(server);
	if (result != GZ_OK) {
		gz_board_server_destroy(&server);
		return result;
	}
	*out_server = server;
	return GZ_OK;
}

struct gz_board *gz_board_server_board(const struct gz_board_server *server)
{
	return server->board;
}

void gz_board_server_destroy(struct gz_board_server **server)
{
	if (!server || !*server)
		return;
	struct gz_board_server *s = *server;
	uint64_t one = 1;
	if (s->has_thread && write(s->quit_fd, &one, sizeof one) == sizeof one)
		pthread_join(s->thread, NULL);
	if (s->door >= 0) {
		if (!s->was_handed)
			unlink(s->path);
		close(s->door);
	}
	if (s->quit_fd >= 0)
		close(s->quit_fd);
	gz_board_destroy(&s->board);
	free(s);
	*server = NULL;
}
