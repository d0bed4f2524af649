#include "suite.h"

#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

#include "base/clock.h"
#include "daemon/door.h"
#include "daemon/zmtp_input.h"
#include "protocol/board/board.h"

enum { CHANNEL = 3 };

static struct gz_door *door;

/* What a reader has sent. */
struct sent {
	size_t size;
	unsigned char bytes[8192];
};

static void add_bytes(struct sent *sent, const void *bytes, size_t size)
{
	assert_true(size <= sizeof sent->bytes - sent->size);
	memcpy(sent->bytes + sent->size, bytes, size);
	sent->size += size;
}

static void add_greeting(struct sent *sent)
{
	static const unsigned char greeting[64] = { 0xff, 0,    0, 0, 0,   0,   0,   0,
						    1,    0x7f, 3, 1, 'N', 'U', 'L', 'L' };
	static const char ready[] = "\x04\x19\x05READY\x0bSocket-Type\0\0\0\3SUB";
	add_bytes(sent, greeting, sizeof greeting);
	add_bytes(sent, ready, sizeof ready - 1);
}

/* A frame with a length of one byte: @p head, then a topic of @p size bytes. */
static void add_frame(struct sent *sent, unsigned char flags, const char *head, const char *topic,
		      size_t size)
{
	unsigned char header[2] = { flags, (unsigned char)(strlen(head) + size) };
	add_bytes(sent, header, sizeof header);
	add_bytes(sent, head, strlen(head));
	add_bytes(sent, topic, size);
}

static void add_subscription(struct sent *sent, const char *topic)
{
	add_frame(sent, 0, "\x01", topic, strlen(topic));
}

/* A connection as far as the door looks at it. */
static int open_connection(void)
{
	int fd = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
	assert_true(fd >= 0);
	return fd;
}

static bool enter(int fd, int64_t now_ns)
{
	return gz_door_enter(door, fd, gz_connection_identity(fd), CHANNEL, now_ns);
}

static bool pass(int fd, const struct sent *sent, int64_t now_ns)
{
	return gz_door_pass(door, fd, gz_connection_identity(fd), sent->bytes, sent->size, now_ns);
}

/* Come in and send @p topic. @return whether that passes */
static bool come_with(int fd, const char *topic, int64_t now_ns)
{
	struct sent sent = { 0 };
	add_greeting(&sent);
	add_subscription(&sent, topic);
	return enter(fd, now_ns) && pass(fd, &sent, now_ns);
}

static int set_up(void **state)
{
	(void)state;
	return gz_door_create(GZ_DOOR_READERS, GZ_DOOR_OPEN, NULL, &door) == GZ_OK ? 0 : -1;
}

static int set_up_for_senders(void **state)
{
	(void)state;
	return gz_door_create(GZ_DOOR_SENDERS, GZ_DOOR_OPEN, NULL, &door) == GZ_OK ? 0 : -1;
}

static int set_up_for_local_readers(void **state)
{
	(void)state;
	return gz_door_create(GZ_DOOR_READERS, GZ_DOOR_LOCAL, NULL, &door) == GZ_OK ? 0 : -1;
}

static int set_up_for_readers_with_keys(void **state)
{
	(void)state;
	return gz_door_create(GZ_DOOR_READERS, GZ_DOOR_KEYS, NULL, &door) == GZ_OK ? 0 : -1;
}

static int tear_down(void **state)
{
	(void)state;
	gz_door_destroy(&door);
	gz_door_destroy(&door);
	return door != NULL;
}

/* The frames of @p sent, read in pieces. @return how many; the last one in @p out_last, with its
 * topic in @p topic */
static int read_frames(const struct sent *sent, size_t piece, struct gz_zmtp_frame *out_last,
		       char topic[GZ_ZMTP_TOPIC_SIZE])
{
	struct gz_zmtp_input input = { 0 };
	int count = 0;
	for (size_t at = 0; at < sent->size; at += piece) {
		const unsigned char *bytes = sent->bytes + at;
		size_t size = sent->size - at < piece ? sent->size - at : piece;
		while (gz_zmtp_next(&input, &bytes, &size, out_last))
			count++;
	}
	if (out_last->kind == GZ_ZMTP_SUBSCRIBE) {
		assert_true(out_last->topic_size < GZ_ZMTP_TOPIC_SIZE);
		memcpy(topic, out_last->topic, (size_t)out_last->topic_size);
		topic[out_last->topic_size] = '\0';
	}
	return count;
}

static void zmtp_frames_are_found_in_any_pieces(void **state)
{
	(void)state;
	struct sent messages = { 0 }, commands = { 0 };
	add_greeting(&messages);
	add_frame(&messages, 0, "", "", 0);
	add_frame(&messages, 1, "", "x", 1);
	add_subscription(&messages, "gaze.");
	add_greeting(&commands);
	add_frame(&commands, 4,
		  "\x06"
		  "CANCEL",
		  "gaze.", 5);
	add_frame(&commands, 4, "\x09SUBSCRIBE", "gaze.", 5);
	for (size_t piece = 1; piece < 120; piece++) {
		struct gz_zmtp_frame frame = { 0 };
		char topic[GZ_ZMTP_TOPIC_SIZE] = "";
		assert_int_equal(read_frames(&messages, piece, &frame, topic), 4);
		assert_int_equal(frame.size, 2 + 6);
		assert_string_equal(topic, "gaze.");
		topic[0] = '\0';
		assert_int_equal(read_frames(&commands, piece, &frame, topic), 3);
		assert_int_equal(frame.size, 2 + 15);
		assert_string_equal(topic, "gaze.");
	}
}

static void zmtp_older_versions_are_told_apart(void **state)
{
	(void)state;
	static const unsigned char version_2[] = { 0xff, 0, 0, 0, 0, 0, 0,   0,   1,   0x7f, 1,
						   2,    0, 0, 0, 5, 1, 'g', 'a', 'z', 'e' };
	static const unsigned char version_1[] = { 1, 0, 6, 0, 1, 'g', 'a', 'z', 'e' };
	struct sent sent = { 0 };
	struct gz_zmtp_frame frame = { 0 };
	char topic[GZ_ZMTP_TOPIC_SIZE] = "";
	add_bytes(&sent, version_2, sizeof version_2);
	assert_int_equal(read_frames(&sent, 3, &frame, topic), 2);
	assert_string_equal(topic, "gaze");
	sent.size = 0;
	add_bytes(&sent, version_1, sizeof version_1);
	read_frames(&sent, 3, &frame, topic);
	assert_int_equal(frame.kind, GZ_ZMTP_UNKNOWN);
	assert_int_equal(frame.size, 3);
}

static void door_readers_of_what_the_daemon_sends_all_come_in(void **state)
{
	(void)state;
	enum { READERS = 64 };
	static const char *const topics[] = { "",           "gaze.",         "gaze.3d.01.",
					      "pupil.0.3d", "surfaces.left", "fixations",
					      "status",     "notify." };
	int fds[READERS];
	gz_door_know(door, "surfaces.left");
	for (int i = 0; i < READERS; i++) {
		fds[i] = open_connection();
		assert_true(come_with(fds[i], topics[i % 8], 0));
		for (int t = 0; t < 8; t++) {
			struct sent sent = { 0 };
			add_subscription(&sent, topics[t]);
			assert_true(pass(fds[i], &sent, 0));
		}
	}
	for (int i = 0; i < READERS; i++)
		close(fds[i]);
	assert_int_equal(gz_door_refused(door, GZ_QUOTA_TOO_MANY), 0);
	assert_int_equal(gz_door_refused(door, GZ_QUOTA_TOO_LARGE), 0);
}

static void fill_topic(char topic[201])
{
	memset(topic, 'x', 200);
	topic[200] = '\0';
}

/* Strange topics fill the tree. Those of connections that have ended count on for a while; a reader
 * of gaze comes in meanwhile. */
static void door_strange_topics_of_all_readers_are_limited(void **state)
{
	(void)state;
	enum { ENOUGH = GZ_DOOR_STRANGE / 201 };
	int fds[ENOUGH + 1], reader = open_connection();
	char topic[201];
	fill_topic(topic);
	for (int i = 0; i <= ENOUGH; i++) {
		fds[i] = open_connection();
		assert_int_equal(come_with(fds[i], topic, 0), i < ENOUGH);
	}
	assert_int_equal(gz_door_refused(door, GZ_QUOTA_TOO_LARGE), 1);
	assert_true(come_with(reader, "gaze.", 0));
	for (int i = 0; i < ENOUGH; i++)
		gz_door_leave(door, fds[i], 0);
	assert_false(come_with(fds[0], topic, 0));
	assert_true(come_with(fds[0], topic, GZ_NS_PER_S));
	/* A connection that ended unnoticed is found. */
	for (int i = 1; i < ENOUGH; i++)
		assert_true(come_with(fds[i], topic, 2 * GZ_NS_PER_S));
	for (int i = 0; i < ENOUGH; i++)
		close(fds[i]);
	assert_false(come_with(fds[ENOUGH], topic, 2 * GZ_NS_PER_S));
	assert_true(come_with(fds[ENOUGH], topic, 3 * GZ_NS_PER_S));
	close(fds[ENOUGH]);
	close(reader);
}

static void door_reader_with_many_strange_topics_is_refused(void **state)
{
	(void)state;
	int fd = open_connection();
	char topic[201];
	struct sent sent = { 0 };
	fill_topic(topic);
	assert_true(come_with(fd, topic, 0));
	for (int i = 0; i < GZ_DOOR_STRANGE_EACH / 201; i++)
		add_subscription(&sent, topic);
	assert_false(pass(fd, &sent, 0));
	/* What was refused is nowhere. */
	assert_true(come_with(fd, topic, 0));
	assert_true(pass(fd, &(struct sent) { 0 }, 0));
	close(fd);
}

/* Bytes of a version whose frames are not told apart. */
static void check_old_version(void)
{
	int fd = open_connection();
	struct sent sent = { .size = GZ_DOOR_STRANGE_EACH, .bytes = { 1 } };
	assert_true(enter(fd, 0));
	assert_true(pass(fd, &sent, 0));
	sent.size = 1;
	assert_false(pass(fd, &sent, 0));
	close(fd);
}

static void door_reader_of_an_old_version_has_strange_bytes(void **state)
{
	(void)state;
	check_old_version();
}

/* Each message takes time, whatever it says. */
static void door_flood_of_messages_is_ended(void **state)
{
	(void)state;
	enum { MESSAGES = 100, FRAME = 2 + 5, ENOUGH = GZ_DOOR_SHARED_COST / 100 / 32 };
	int flooding = open_connection(), reader = open_connection();
	struct sent sent = { 0 };
	int passed = 0;
	for (int i = 0; i < MESSAGES; i++)
		add_frame(&sent, 0, "", "\0gaze", 5);
	assert_true(come_with(flooding, "gaze", 0));
	while (pass(flooding, &sent, 0) && passed <= ENOUGH &&
	       gz_door_refused(door, GZ_QUOTA_TOO_LARGE) == 0)
		passed++;
	assert_in_range(passed, 1, ENOUGH);
	assert_int_equal(gz_door_refused(door, GZ_QUOTA_TOO_LARGE), 1);
	assert_true(come_with(reader, "gaze", 0));
	assert_true(come_with(flooding, "gaze", GZ_NS_PER_S));
	assert_true(pass(flooding, &sent, GZ_NS_PER_S));
	close(flooding);
	close(reader);
}

static void door_few_connections_come_in_a_second(void **state)
{
	(void)state;
	int fd = open_connection(), entered = 0;
	while (entered < 2000 && enter(fd, 0))
		entered++;
	assert_in_range(entered, 256, GZ_DOOR_NODES / GZ_DOOR_KNOWN_NODES);
	assert_int_equal(gz_door_refused(door, GZ_QUOTA_TOO_MANY), 1);
	assert_true(enter(fd, GZ_NS_PER_S));
	/* The more there is to walk, the fewer. */
	char topic[201];
	struct sent sent = { 0 };
	int after = 0;
	fill_topic(topic);
	add_greeting(&sent);
	add_subscription(&sent, topic);
	add_subscription(&sent, topic);
	while (after < 2000 && enter(fd, 10 * GZ_NS_PER_S)) {
		pass(fd, &sent, 10 * GZ_NS_PER_S);
		after++;
	}
	assert_in_range(after, entered / 4, entered / 2);
	close(fd);
}

/* Whether the connection has been ended by shutdown(). */
static bool is_ended(int fd)
{
	char byte;
	return recvfrom(fd, &byte, 1, MSG_DONTWAIT, NULL, NULL) == 0;
}

static void door_full_house_ends_the_least_useful(void **state)
{
	(void)state;
	static int ours[GZ_DOOR_CONNECTIONS + 3], theirs[GZ_DOOR_CONNECTIONS + 3];
	const int64_t old_ns = GZ_DOOR_NEW_MS * GZ_NS_PER_MS;
	const int64_t calm_ns = (GZ_DOOR_CALM_MS + 2 * GZ_DOOR_NEW_MS) * GZ_NS_PER_MS;
	for (int i = 0; i < GZ_DOOR_CONNECTIONS + 3; i++) {
		int fds[2];
		assert_int_equal(
			socketpair(AF_UNIX, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0, fds), 0);
		ours[i] = fds[0];
		theirs[i] = fds[1];
	}
	for (int i = 0; i < GZ_DOOR_CONNECTIONS; i++)
		assert_true(i == 1 ? enter(ours[i], 1) : come_with(ours[i], "gaze.", i > 0));
	/* One that has subscribed to nothing, then one that does not read. */
	char bytes[32768] = { 0 };
	assert_int_equal(send(ours[2], bytes, sizeof bytes, 0), sizeof bytes);
	assert_true(come_with(ours[GZ_DOOR_CONNECTIONS], "gaze.", old_ns));
	assert_true(is_ended(ours[1]));
	assert_true(come_with(ours[GZ_DOOR_CONNECTIONS + 1], "gaze.", 2 * old_ns));
	assert_true(is_ended(ours[2]));
	/* The oldest of those that came shortly before, while others want to come. */
	assert_true(come_with(ours[GZ_DOOR_CONNECTIONS + 2], "gaze.", 3 * old_ns));
	assert_false(is_ended(ours[0]));
	assert_true(is_ended(ours[3]));
	assert_false(come_with(ours[1], "gaze.", 3 * old_ns + calm_ns));
	assert_int_equal(gz_door_refused(door, GZ_QUOTA_TOO_MANY), 4);
	for (int i = 0; i < GZ_DOOR_CONNECTIONS + 3; i++) {
		close(ours[i]);
		close(theirs[i]);
	}
}

/* A frame with a length of eight bytes and a body of @p size. */
static void add_large_frame(struct sent *sent, unsigned char flags, size_t size)
{
	static const char body[4096];
	unsigned char header[9] = { [7] = (unsigned char)(size >> 8), [8] = (unsigned char)size };
	header[0] = flags | 2;
	add_bytes(sent, header, sizeof header);
	add_bytes(sent, body, size);
}

/* A sender that has sent one small message. */
static int let_sender_in(void)
{
	int fd = open_connection();
	assert_true(come_with(fd, "topic", 0));
	return fd;
}

/* What libzmq holds of all is limited; a sender with few messages is not hindered by the others. */
static void door_senders_share_what_libzmq_holds(void **state)
{
	(void)state;
	enum { BODY = 4096, COST = BODY + GZ_DOOR_FRAME_COST, ENOUGH = GZ_DOOR_HELD / COST };
	int flooding = let_sender_in(), quiet = let_sender_in(), passed = 0;
	struct sent message = { 0 }, few = { 0 };
	add_large_frame(&message, 0, BODY);
	add_subscription(&few, "annotation");
	while (passed <= ENOUGH && gz_door_refused(door, GZ_QUOTA_TOO_LARGE) == 0)
		passed += pass(flooding, &message, 0);
	assert_in_range(passed, ENOUGH - 1, ENOUGH);
	for (int i = 0; i < 100; i++)
		assert_true(pass(quiet, &few, 0));
	/* What the daemon takes makes room; what it never saw is gone when nothing is left. */
	for (int i = 0; i < 10; i++)
		gz_door_took(door, BODY);
	close(flooding);
	flooding = let_sender_in();
	for (passed = 0; passed < 100 && pass(flooding, &message, 0);)
		passed++;
	assert_in_range(passed, 5, 10 + GZ_DOOR_SENDER_BYTES / COST);
	gz_door_took(door, SIZE_MAX / 2);
	close(flooding);
	flooding = let_sender_in();
	for (int i = 0; i < 100; i++)
		assert_true(pass(flooding, &message, 0));
	gz_door_emptied(door);
	assert_int_equal(gz_door_refused(door, GZ_QUOTA_TOO_LARGE), 2);
	close(flooding);
	close(quiet);
}

static void door_message_without_end_is_refused(void **state)
{
	(void)state;
	enum { BODY = 4000, ENOUGH = GZ_DOOR_MESSAGE_MAX / (BODY + GZ_DOOR_FRAME_COST) };
	int fd = let_sender_in(), passed = 0;
	struct sent last = { 0 }, more = { 0 };
	add_large_frame(&last, 0, BODY);
	add_large_frame(&more, 1, BODY);
	for (int i = 0; i < 2 * ENOUGH; i++)
		assert_true(pass(fd, i % 2 ? &last : &more, 0));
	while (passed < 2 * ENOUGH && pass(fd, &more, 0))
		passed++;
	assert_int_equal(passed, ENOUGH);
	close(fd);
}

static void door_sender_of_an_old_version_is_soon_refused(void **state)
{
	(void)state;
	check_old_version();
}

/* A pair of connected sockets, of which the first is the door's. */
static void open_pair(int fds[2])
{
	assert_int_equal(socketpair(AF_UNIX, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0, fds),
			 0);
}

/* Clients of the control port that keep their connections but say nothing. */
static void door_idle_senders_give_way_the_longest_idle_first(void **state)
{
	(void)state;
	enum { ALL = GZ_DOOR_CONNECTIONS };
	static int fds[ALL + 2][2];
	const int64_t idle_ns = (GZ_DOOR_IDLE_MS + 1) * GZ_NS_PER_MS;
	for (int i = 0; i < ALL + 2; i++)
		open_pair(fds[i]);
	for (int i = 0; i < ALL; i++)
		assert_true(come_with(fds[i][0], "topic", i));
	/* The oldest one sends something once more; the second is then idle for longest. */
	struct sent more = { 0 };
	add_subscription(&more, "topic");
	assert_true(pass(fds[0][0], &more, idle_ns / 2));
	assert_false(come_with(fds[ALL][0], "topic", idle_ns / 2));
	assert_true(come_with(fds[ALL][0], "topic", ALL + idle_ns));
	assert_false(is_ended(fds[0][0]));
	assert_true(is_ended(fds[1][0]));
	assert_false(is_ended(fds[2][0]));
	assert_true(come_with(fds[ALL + 1][0], "topic", ALL + idle_ns));
	assert_true(is_ended(fds[2][0]));
	assert_false(is_ended(fds[3][0]));
	assert_int_equal(gz_door_refused(door, GZ_QUOTA_TOO_MANY), 3);
	for (int i = 0; i < ALL + 2; i++) {
		close(fds[i][0]);
		close(fds[i][1]);
	}
}

/* Local readers may have topics of their own, but not without limit. */
static void door_local_reader_that_floods_is_ended(void **state)
{
	(void)state;
	enum { ENOUGH = GZ_DOOR_TRUSTED_STRANGE_EACH / 201, ALL = GZ_DOOR_TRUSTED_STRANGE / 201 };
	int flooding = open_connection(), reader = open_connection(), passed = 0;
	char topic[201];
	struct sent sent = { 0 };
	fill_topic(topic);
	add_subscription(&sent, topic);
	assert_true(come_with(reader, "gaze.", 0));
	assert_true(come_with(flooding, "gaze.", 0));
	while (passed < 300000 && pass(flooding, &sent, 0) &&
	       gz_door_refused(door, GZ_QUOTA_TOO_LARGE) == 0)
		passed++;
	assert_int_equal(passed, ENOUGH);
	/* However often it comes again. */
	for (int i = 0; i < 1000; i++)
		passed += come_with(flooding, topic, 0) ? 1 : 0;
	assert_in_range(passed, ENOUGH + 1, ALL);
	assert_true(pass(reader, &(struct sent) { 0 }, 0));
	close(flooding);
	close(reader);
}

static void door_limits_can_be_set(void **state)
{
	(void)state;
	struct gz_door_limits limits = gz_door_usual_limits(GZ_DOOR_LOCAL);
	int fds[3][2];
	char topic[201];
	fill_topic(topic);
	limits.connections = 2;
	limits.strange = 200;
	gz_door_destroy(&door);
	assert_int_equal(gz_door_create(GZ_DOOR_READERS, GZ_DOOR_LOCAL, &limits, &door), GZ_OK);
	for (int i = 0; i < 3; i++) {
		open_pair(fds[i]);
		assert_true(come_with(fds[i][0], "gaze.", i));
	}
	assert_true(is_ended(fds[0][0]));
	assert_false(is_ended(fds[1][0]));
	assert_false(come_with(fds[2][0], topic, 3));
	topic[199] = '\0';
	assert_true(come_with(fds[2][0], topic, 4));
	for (int i = 0; i < 3; i++) {
		close(fds[i][0]);
		close(fds[i][1]);
	}
}

/* What is read at the board is no strange topic, and needs no message from the socket. */
static void door_knows_who_wants_messages(void **state)
{
	(void)state;
	enum { READERS = 300 };
	static const char board[] = GZ_BOARD_TOPIC "gaze.";
	int fds[READERS], silent = open_connection();
	struct sent sent = { 0 }, gaze = { 0 };
	add_greeting(&sent);
	add_frame(&sent, 0, "\x01", board, sizeof board - 1);
	add_subscription(&gaze, "gaze.");
	assert_true(enter(silent, 0));
	for (int i = 0; i < READERS; i++) {
		fds[i] = open_connection();
		assert_true(enter(fds[i], 0));
		assert_true(pass(fds[i], &sent, 0));
	}
	assert_int_equal(gz_door_quiet(door, CHANNEL), READERS + 1);
	assert_int_equal(gz_door_quiet(door, CHANNEL + 1), 0);
	assert_true(pass(fds[0], &gaze, 0));
	assert_true(pass(fds[0], &gaze, 0));
	assert_int_equal(gz_door_quiet(door, CHANNEL), READERS);
	gz_door_leave(door, fds[0], 0);
	gz_door_leave(door, fds[1], 0);
	assert_int_equal(gz_door_quiet(door, CHANNEL), READERS - 1);
	/* One that has ended unnoticed is found, one that is there stays. */
	gz_door_look(door, silent, 0);
	assert_int_equal(gz_door_quiet(door, CHANNEL), READERS - 1);
	close(silent);
	gz_door_look(door, silent, 0);
	gz_door_look(door, -1, 0);
	gz_door_look(door, GZ_QUOTA_DESCRIPTORS, 0);
	assert_int_equal(gz_door_quiet(door, CHANNEL), READERS - 2);
	for (int i = 0; i < READERS; i++)
		close(fds[i]);
}

/* A sealed message of CURVE with @p size bytes of content. */
static void add_sealed(struct sent *sent, size_t size)
{
	char content[GZ_DOOR_SEAL_SIZE - 8 + 201] = { 0 };
	assert_true(size <= 201);
	add_frame(sent, 0, "\x07MESSAGE", content, GZ_DOOR_SEAL_SIZE - 8 + size);
}

/* The first commands of CURVE have 200 and about 300 bytes. */
static void add_sealed_handshake(struct sent *sent)
{
	static const unsigned char greeting[64] = { 0xff, 0, 0, 0,   0,   0,   0,   0,  1,
						    0x7f, 3, 1, 'C', 'U', 'R', 'V', 'E' };
	char rest[200] = { 0 };
	add_bytes(sent, greeting, sizeof greeting);
	add_frame(sent, 4, "\x05HELLO", rest, 194);
	add_frame(sent, 4, "\x08INITIATE", rest, 200);
}

static void let_in_with_key(int fd, int64_t now_ns)
{
	struct sent sent = { 0 };
	add_sealed_handshake(&sent);
	add_sealed(&sent, 6);
	assert_true(enter(fd, now_ns));
	assert_true(pass(fd, &sent, now_ns));
}

static void door_sealed_messages_count_whatever_they_are(void **state)
{
	(void)state;
	enum { ENOUGH = GZ_DOOR_TRUSTED_STRANGE_EACH / 201 };
	int flooding = open_connection(), reader = open_connection(), passed = 0;
	int third = open_connection();
	struct sent large = { 0 }, heartbeat = { 0 };
	add_sealed(&large, 201);
	add_sealed(&heartbeat, 7);
	let_in_with_key(reader, 0);
	let_in_with_key(third, 0);
	let_in_with_key(flooding, 0);
	while (passed < 300000 && pass(flooding, &large, 0) &&
	       gz_door_refused(door, GZ_QUOTA_TOO_LARGE) == 0)
		passed++;
	assert_int_equal(passed, ENOUGH);
	/* Heartbeats go on for ever. */
	for (int s = 0; s < 10000; s++)
		assert_true(pass(reader, &heartbeat, s * GZ_NS_PER_S));
	assert_int_equal(gz_door_refused(door, GZ_QUOTA_TOO_LARGE), 1);
	/* A flood of short messages ends, too. */
	passed = 0;
	while (passed < 300000 && pass(third, &heartbeat, 10000 * GZ_NS_PER_S) &&
	       gz_door_refused(door, GZ_QUOTA_TOO_LARGE) == 1)
		passed++;
	const int most = (GZ_DOOR_TRUSTED_READER_COST + 10000 * GZ_DOOR_READER_COST_PER_S +
			  GZ_DOOR_SHARED_COST) /
			 70;
	assert_in_range(passed, 1000, most);
	close(flooding);
	close(reader);
	close(third);
}

/* Strangers without a key that fill the house, or send much, harm nobody who has one. */
static void door_strangers_give_way_to_clients_with_keys(void **state)
{
	(void)state;
	enum { ALL = GZ_DOOR_TRUSTED_CONNECTIONS };
	static int fds[ALL + 1][2];
	struct sent begin = { 0 }, garbage = { 0 };
	const int64_t later_ns = (GZ_DOOR_HANDSHAKE_MS + 1) * GZ_NS_PER_MS;
	add_sealed_handshake(&begin);
	for (int i = 0; i < 10; i++)
		add_frame(&garbage, 4, "\x05HELLO", (const char[200]) { 0 }, 200);
	for (int i = 0; i <= ALL; i++)
		open_pair(fds[i]);
	let_in_with_key(fds[0][0], 0);
	for (int i = 1; i < ALL; i++)
		assert_true(enter(fds[i][0], i));
	/* They are refused beyond what each has for itself, and nobody shares with them. */
	assert_true(pass(fds[1][0], &begin, ALL));
	assert_true(pass(fds[1][0], &garbage, ALL));
	assert_false(pass(fds[1][0], &garbage, ALL));
	assert_true(enter(fds[1][0], ALL));
	let_in_with_key(fds[ALL][0], later_ns);
	assert_true(is_ended(fds[2][0]));
	assert_false(is_ended(fds[0][0]));
	for (int i = 0; i < 500; i++)
		assert_true(enter(fds[2 + i][0], 2 * later_ns));
	assert_false(is_ended(fds[0][0]));
	assert_false(is_ended(fds[ALL][0]));
	for (int i = 0; i <= ALL; i++) {
		close(fds[i][0]);
		close(fds[i][1]);
	}
}

/* A descriptor may be another file by the time its bytes come. */
static void door_asks_nothing_of_other_connections(void **state)
{
	(void)state;
	int fd = open_connection();
	struct sent sent = { .size = 8192 };
	assert_true(pass(fd, &sent, 0));
	assert_true(gz_door_pass(door, -1, 1, sent.bytes, sent.size, 0));
	assert_true(gz_door_pass(door, GZ_QUOTA_DESCRIPTORS, 1, sent.bytes, sent.size, 0));
	assert_true(enter(fd, 0));
	assert_true(
		gz_door_pass(door, fd, gz_connection_identity(fd) + 1, sent.bytes, sent.size, 0));
	assert_false(gz_door_enter(door, GZ_QUOTA_DESCRIPTORS, 1, CHANNEL, 0));
	assert_int_equal(gz_door_refused(door, GZ_QUOTA_TOO_LARGE), 0);
	gz_door_leave(door, -1, 0);
	close(fd);
}

#define TEST(function) cmocka_unit_test_setup_teardown(function, set_up, tear_down)
#define SENDERS_TEST(function) \
	cmocka_unit_test_setup_teardown(function, set_up_for_senders, tear_down)
#define LOCAL_TEST(function) \
	cmocka_unit_test_setup_teardown(function, set_up_for_local_readers, tear_down)
#define KEYS_TEST(function) \
	cmocka_unit_test_setup_teardown(function, set_up_for_readers_with_keys, tear_down)

TEST_SUITE(door)
{
	const struct CMUnitTest tests[] = {
		TEST(zmtp_frames_are_found_in_any_pieces),
		TEST(zmtp_older_versions_are_told_apart),
		TEST(door_readers_of_what_the_daemon_sends_all_come_in),
		TEST(door_strange_topics_of_all_readers_are_limited),
		TEST(door_reader_with_many_strange_topics_is_refused),
		TEST(door_reader_of_an_old_version_has_strange_bytes),
		TEST(door_flood_of_messages_is_ended),
		TEST(door_few_connections_come_in_a_second),
		TEST(door_full_house_ends_the_least_useful),
		TEST(door_asks_nothing_of_other_connections),
		SENDERS_TEST(door_senders_share_what_libzmq_holds),
		SENDERS_TEST(door_message_without_end_is_refused),
		SENDERS_TEST(door_sender_of_an_old_version_is_soon_refused),
		SENDERS_TEST(door_idle_senders_give_way_the_longest_idle_first),
		LOCAL_TEST(door_local_reader_that_floods_is_ended),
		LOCAL_TEST(door_limits_can_be_set),
		LOCAL_TEST(door_knows_who_wants_messages),
		KEYS_TEST(door_sealed_messages_count_whatever_they_are),
		KEYS_TEST(door_strangers_give_way_to_clients_with_keys),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
