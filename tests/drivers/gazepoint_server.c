#include "gazepoint_server.h"

#include "suite.h"

#include <arpa/inet.h>
#include <errno.h>
#include <poll.h>
#include <stdio.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

#include "base/clock.h"

/* A client; there is one at a time. */
struct client {
	struct gazepoint_server *server;
	int fd;
	bool streaming;
	bool scripted; /* the script has been sent */
	char line[512];
	size_t filled;
	long count;
	int64_t next_ns;
};

static bool send_all(const struct client *client, const char *bytes, size_t size)
{
	size_t chunk = client->server->play.chunk ? client->server->play.chunk : size;
	for (size_t sent = 0; sent < size;) {
		size_t left = size - sent;
		ssize_t n =
			send(client->fd, bytes + sent, left < chunk ? left : chunk, MSG_NOSIGNAL);
		if (n <= 0)
			return false;
		sent += (size_t)n;
	}
	return true;
}

static bool send_text(const struct client *client, const char *text)
{
	return send_all(client, text, strlen(text));
}

/* The ID in "<GET ID="THIS" />". */
static void id_of(const char *line, char *id, size_t size)
{
	const char *begin = strstr(line, "ID=\"");
	begin = begin ? begin + 4 : "";
	snprintf(id, size, "%.*s", (int)strcspn(begin, "\""), begin);
}

static bool answer(struct client *client, const char *line)
{
	const struct gazepoint_play *play = &client->server->play;
	char id[64], values[128] = "STATE=\"1\"", text[256];
	id_of(line, id, sizeof id);
	bool refused = play->refuses && strstr(line, play->refuses);
	if (strcmp(id, "PRODUCT_ID") == 0)
		snprintf(values, sizeof values, "VALUE=\"GP3HD\" BUS=\"USB3\" RATE=\"150\"");
	else if (strcmp(id, "SERIAL_ID") == 0)
		snprintf(values, sizeof values, "VALUE=\"13&amp;7\"");
	else if (strcmp(id, "SCREEN_SIZE") == 0)
		snprintf(values, sizeof values, "X=\"0\" Y=\"0\" WIDTH=\"2560\" HEIGHT=\"1440\"");
	else if (strcmp(id, "TIME_TICK_FREQUENCY") == 0)
		snprintf(values, sizeof values, "FREQ=\"%s\"",
			 play->frequency ? play->frequency : "10000000");
	else if (strcmp(id, "ENABLE_SEND_DATA") == 0)
		client->streaming = strstr(line, "STATE=\"1\"") && !refused;
	snprintf(text, sizeof text, refused ? "<NACK ID=\"%s\" />\r\n" : "<ACK ID=\"%s\" %s />\r\n",
		 id, values);
	client->next_ns = gz_clock_now_ns();
	return send_text(client, text);
}

static bool take_commands(struct client *client)
{
	ssize_t n = recv(client->fd, client->line + client->filled,
			 sizeof client->line - 1 - client->filled, 0);
	if (n <= 0)
		return false;
	client->filled += (size_t)n;
	client->line[client->filled] = '\0';
	for (char *end; (end = strstr(client->line, "\r\n"));) {
		*end = '\0';
		if (!client->server->play.mute && !answer(client, client->line))
			return false;
		client->filled -= (size_t)(end + 2 - client->line);
		memmove(client->line, end + 2, client->filled + 1);
	}
	return client->filled < sizeof client->line - 1;
}

/* Send a record as the tracker does. Every 50th is missing, every 70th damaged. */
static bool send_record(struct client *client)
{
	char text[640];
	long i = client->count++;
	client->next_ns += 2 * GZ_NS_PER_MS;
	if (i % 50 == 49)
		return true;
	snprintf(text, sizeof text,
		 "<REC CNT=\"%ld\" TIME=\"%.5f\" TIME_TICK=\"%lld\" LPOGX=\"0.40000\" "
		 "LPOGY=\"0.50000\" LPOGV=\"%d\" RPOGX=\"0.60000\" RPOGY=\"0.50000\" RPOGV=\"1\" "
		 "BPOGX=\"0.50000\" BPOGY=\"0.50000\" BPOGV=\"1\" LEYEX=\"-0.03\" LEYEY=\"0.01\" "
		 "LEYEZ=\"0.6\" LPUPILD=\"0.0031\" LPUPILV=\"1\" REYEX=\"0.03\" REYEY=\"0.01\" "
		 "REYEZ=\"0.6\" RPUPILD=\"0.0030\" RPUPILV=\"1\" LPMM=\"3.1\" LPMMV=\"1\" "
		 "RPMM=\"3.0\" RPMMV=\"1\" %s/>\r\n",
		 i, (double)i * 0.002, 5000000000LL + i * 20000, i % 3 != 0,
		 i % 70 == 69 ? "=" : "");
	return send_text(client, text);
}

static bool play(struct client *client)
{
	const struct gazepoint_play *what = &client->server->play;
	if (!client->scripted && what->script) {
		client->scripted = true;
		size_t size = what->script_size ? what->script_size : strlen(what->script);
		if (!send_all(client, what->script, size))
			return false;
	}
	if (what->hang_up)
		return false;
	while (what->stream && client->next_ns <= gz_clock_now_ns()) {
		if (!send_record(client))
			return false;
	}
	return true;
}

static void serve(struct gazepoint_server *server, int fd)
{
	struct client client = { .server = server, .fd = fd };
	struct pollfd poll_fd = { .fd = fd, .events = POLLIN };
	bool going = true;
	while (going && !atomic_load(&server->quit)) {
		if (poll(&poll_fd, 1, 1) > 0)
			going = take_commands(&client);
		if (going && client.streaming)
			going = play(&client);
	}
	close(fd);
}

static void *run(void *user)
{
	struct gazepoint_server *server = user;
	struct pollfd poll_fd = { .fd = server->listen_fd, .events = POLLIN };
	while (!atomic_load(&server->quit)) {
		if (poll(&poll_fd, 1, 5) <= 0)
			continue;
		int fd = accept(server->listen_fd, NULL, NULL);
		atomic_fetch_add(&server->connections, 1);
		if (fd >= 0)
			serve(server, fd);
	}
	return NULL;
}

void gazepoint_server_start(struct gazepoint_server *server, const struct gazepoint_play *play_as,
			    int port)
{
	struct sockaddr_in address = { .sin_family = AF_INET,
				       .sin_addr.s_addr = htonl(INADDR_LOOPBACK),
				       .sin_port = htons((uint16_t)port) };
	socklen_t size = sizeof address;
	int one = 1;
	memset(server, 0, sizeof *server);
	server->play = *play_as;
	server->listen_fd = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
	assert_true(server->listen_fd >= 0);
	setsockopt(server->listen_fd, SOL_SOCKET, SO_REUSEADDR, &one, sizeof one);
	if (bind(server->listen_fd, (struct sockaddr *)&address, sizeof address) != 0 ||
	    listen(server->listen_fd, 4) != 0 ||
	    getsockname(server->listen_fd, (struct sockaddr *)&address, &size) != 0)
		fail_msg("cannot listen: %s", strerror(errno));
	server->port = ntohs(address.sin_port);
	assert_int_equal(pthread_create(&server->thread, NULL, run, server), 0);
}

void gazepoint_server_stop(struct gazepoint_server *server)
{
	atomic_store(&server->quit, true);
	pthread_join(server->thread, NULL);
	close(server->listen_fd);
}
