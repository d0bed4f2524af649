#include "client/board_link.h"

#include <poll.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>
#include <zmq.h>

#include "base/clock.h"
#include "base/text.h"
#include "protocol/board/board_door.h"

/* How long a daemon that did not answer is left alone, ms. Chosen. */
enum { ASK_AGAIN_MS = 1000 };

/* Find the socket at which boards are asked for, in the directory of the endpoint's. */
static void find_door(struct gz_board_link *link, const char *endpoint, const char *channel)
{
	static const char scheme[] = "ipc://";
	const size_t scheme_length = sizeof scheme - 1;
	const char *slash = strrchr(endpoint, '/');
	if (strncmp(endpoint, scheme, scheme_length) != 0 || strcmp(slash + 1, channel) != 0 ||
	    slash < endpoint + scheme_length)
		return;
	gz_text_print(link->path, sizeof link->path, "%.*s/%s",
		      (int)(slash - endpoint - (ptrdiff_t)scheme_length), endpoint + scheme_length,
		      GZ_BOARD_DOOR_NAME);
}

static enum gz_result copy_topics(struct gz_board_link *link, const char *const *topics)
{
	static const char *const everything[] = { "", NULL };
	size_t size = 0;
	if (!topics)
		topics = everything;
	for (size_t i = 0; topics[i]; i++)
		size += GZ_BOARD_TOPIC_SIZE + strlen(topics[i]) + 1;
	char *place = link->topics = malloc(size > 0 ? size : 1);
	if (!place)
		return GZ_ERR_NO_MEM;
	for (; topics[link->topic_count]; link->topic_count++) {
		memcpy(place, GZ_BOARD_TOPIC, GZ_BOARD_TOPIC_SIZE);
		place = stpcpy(place + GZ_BOARD_TOPIC_SIZE, topics[link->topic_count]) + 1;
	}
	return GZ_OK;
}

static const char *first_topic(const struct gz_board_link *link)
{
	return link->topics + GZ_BOARD_TOPIC_SIZE;
}

static const char *topic_after(const char *topic)
{
	return topic + strlen(topic) + 1 + GZ_BOARD_TOPIC_SIZE;
}

/* Subscribe to the caller's topics, or end that. */
static bool set_topics(const struct gz_board_link *link, int option)
{
	const char *topic = first_topic(link);
	for (size_t i = 0; i < link->topic_count; i++, topic = topic_after(topic))
		if (zmq_setsockopt(link->socket, option, topic, strlen(topic)) != 0)
			return false;
	return true;
}

/* Tell the daemon which topics are read at the board, or end that. */
static void set_board_topics(const struct gz_board_link *link, int option)
{
	const char *topic = first_topic(link);
	for (size_t i = 0; i < link->topic_count; i++, topic = topic_after(topic))
		zmq_setsockopt(link->socket, option, topic - GZ_BOARD_TOPIC_SIZE,
			       GZ_BOARD_TOPIC_SIZE + strlen(topic));
}

/* Drop what the socket has collected: the board has it, too. */
static void drop_collected(const struct gz_board_link *link)
{
	char byte;
	while (zmq_recv(link->socket, &byte, sizeof byte, ZMQ_DONTWAIT) >= 0)
		;
}

static void enter_board(struct gz_board_link *link)
{
	if (link->source == GZ_BOARD_SOURCE_BOARD)
		return;
	link->source = GZ_BOARD_SOURCE_BOARD;
	set_topics(link, ZMQ_UNSUBSCRIBE);
	set_board_topics(link, ZMQ_SUBSCRIBE);
	drop_collected(link);
}

static void leave_board(struct gz_board_link *link, enum gz_board_source source)
{
	if (link->source == GZ_BOARD_SOURCE_BOARD) {
		drop_collected(link);
		set_board_topics(link, ZMQ_UNSUBSCRIBE);
		set_topics(link, ZMQ_SUBSCRIBE);
	}
	link->source = source;
}

static void stop_asking(struct gz_board_link *link)
{
	if (link->asking)
		close(link->fd);
	link->asking = false;
	link->until_ns = 0;
}

/* The daemon offers no board now. A board that is read already remains the best that is known, and
 * is asked for again. */
static void miss_answer(struct gz_board_link *link)
{
	stop_asking(link);
	if (link->source == GZ_BOARD_SOURCE_BOARD)
		link->until_ns = gz_clock_now_ns() + ASK_AGAIN_MS * GZ_NS_PER_MS;
	else
		link->source = GZ_BOARD_SOURCE_SOCKET;
}

static void ask_for_board(struct gz_board_link *link)
{
	stop_asking(link);
	enum gz_result result = gz_board_door_ask(link->path, &link->fd);
	if (result == GZ_OK) {
		link->asking = true;
		link->until_ns = gz_clock_now_ns() + GZ_BOARD_ANSWER_MS * GZ_NS_PER_MS;
	} else if (result == GZ_ERR_NOT_FOUND) {
		leave_board(link, GZ_BOARD_SOURCE_SOCKET);
	} else {
		miss_answer(link);
	}
}

/* Use the board whose memory is @p fd, unless it is being read already. */
static void adopt_board(struct gz_board_link *link, int fd)
{
	struct gz_board_reader *reader = NULL;
	const struct gz_board_reader *known = link->next ? link->next : link->reader;
	if (known && gz_board_is_same(known, fd)) {
		enter_board(link);
		return;
	}
	if (gz_board_open(fd, &reader) != GZ_OK ||
	    gz_board_skip(reader, link->opened_ns) != GZ_OK) {
		gz_board_close(&reader);
		leave_board(link, GZ_BOARD_SOURCE_SOCKET);
		return;
	}
	gz_board_close(&link->next);
	link->next = reader;
	enter_board(link);
}

void gz_board_link_step(struct gz_board_link *link)
{
	int fd;
	if (!link->asking) {
		if (link->until_ns > 0 && gz_clock_now_ns() >= link->until_ns)
			ask_for_board(link);
		return;
	}
	enum gz_result result = gz_board_door_take(link->fd, &fd);
	if (result == GZ_OK) {
		stop_asking(link);
		adopt_board(link, fd);
		close(fd);
	} else if (result != GZ_ERR_TIMEOUT || gz_clock_now_ns() >= link->until_ns) {
		miss_answer(link);
	}
}

/* Look for the board of a daemon that is there already. */
static void look_for_board(struct gz_board_link *link)
{
	if (gz_board_door_ask(link->path, &link->fd) != GZ_OK)
		return;
	struct pollfd answer = { .fd = link->fd, .events = POLLIN };
	int fd;
	link->asking = true;
	poll(&answer, 1, GZ_BOARD_OPEN_MS);
	if (gz_board_door_take(link->fd, &fd) == GZ_OK) {
		adopt_board(link, fd);
		close(fd);
	}
	stop_asking(link);
}

enum gz_result gz_board_link_open(struct gz_board_link *link,
				  const struct gz_board_link_params *params)
{
	*link = (struct gz_board_link) {
		.socket = params->socket,
		.newest_only = strcmp(params->channel, "latest") == 0,
		.opened_ns = gz_clock_now_ns(),
	};
	enum gz_result result = copy_topics(link, params->topics);
	if (result != GZ_OK)
		return result;
	if (!set_topics(link, ZMQ_SUBSCRIBE))
		return GZ_ERR_INVAL;
	find_door(link, params->endpoint, params->channel);
	if (link->path[0]) {
		link->source = GZ_BOARD_SOURCE_OPEN;
		look_for_board(link);
	}
	return GZ_OK;
}

void gz_board_link_connected(struct gz_board_link *link)
{
	/* The daemon may be another one than that whose board is read. */
	if (link->source != GZ_BOARD_SOURCE_SOCKET)
		ask_for_board(link);
}

void gz_board_link_disconnected(struct gz_board_link *link)
{
	stop_asking(link);
	if (link->source == GZ_BOARD_SOURCE_BOARD)
		leave_board(link, GZ_BOARD_SOURCE_OPEN);
}

int gz_board_link_fd(const struct gz_board_link *link)
{
	return link->asking ? link->fd : -1;
}

static bool is_read_to_end(const struct gz_board_link *link)
{
	return link->newest_only || !link->reader || !gz_board_has_next(link->reader);
}

struct gz_board_reader *gz_board_link_reader(struct gz_board_link *link)
{
	if (link->next && is_read_to_end(link)) {
		gz_board_close(&link->reader);
		link->reader = link->next;
		link->next = NULL;
		link->boards++;
	} else if (link->source == GZ_BOARD_SOURCE_SOCKET && is_read_to_end(link)) {
		gz_board_close(&link->reader);
	}
	return link->reader;
}

bool gz_board_link_reads_socket(const struct gz_board_link *link)
{
	return link->source == GZ_BOARD_SOURCE_SOCKET && !link->reader && !link->next;
}

void gz_board_link_give_up(struct gz_board_link *link)
{
	stop_asking(link);
	gz_board_close(&link->reader);
	gz_board_close(&link->next);
	leave_board(link, GZ_BOARD_SOURCE_SOCKET);
}

bool gz_board_link_wants(const struct gz_board_link *link, const char *topic, size_t size)
{
	const char *wanted = first_topic(link);
	for (size_t i = 0; i < link->topic_count; i++, wanted = topic_after(wanted)) {
		size_t length = strlen(wanted);
		if (length <= size && memcmp(wanted, topic, length) == 0)
			return true;
	}
	return false;
}

void gz_board_link_close(struct gz_board_link *link)
{
	stop_asking(link);
	gz_board_close(&link->reader);
	gz_board_close(&link->next);
	free(link->topics);
	*link = (struct gz_board_link) { 0 };
}
