#include "suite.h"

#include "protocol/board/board.h"

#include <errno.h>
#include <fcntl.h>
#include <linux/futex.h>
#include <poll.h>
#include <pthread.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include "base/clock.h"
#include "protocol/board/board_door.h"

static struct gz_board *board;
static struct gz_board_reader *reader;

static int set_up(void **state)
{
	(void)state;
	if (gz_board_create(GZ_BOARD_SIZE_MIN, &board) != GZ_OK)
		return -1;
	return gz_board_open(gz_board_fd(board), &reader) == GZ_OK ? 0 : -1;
}

static int tear_down(void **state)
{
	(void)state;
	gz_board_close(&reader);
	gz_board_close(&reader);
	gz_board_destroy(&board);
	gz_board_destroy(&board);
	return reader || board;
}

static bool write_text(const char *topic, const char *body, int64_t time_ns)
{
	const struct gz_board_message message = {
		.topic = topic,
		.topic_size = strlen(topic),
		.body = body,
		.body_size = strlen(body),
		.time_ns = time_ns,
		.is_gaze = strncmp(topic, "gaze", 4) == 0,
	};
	return gz_board_write(board, &message);
}

/* Write a message of @p size bytes, each of which is @p number's lowest. */
static void write_filled(unsigned number, size_t size)
{
	static unsigned char bytes[GZ_BOARD_BODY_MAX];
	memset(bytes, (int)(number & 0xff), size);
	const struct gz_board_message message = { .topic = (const char *)&number,
						  .topic_size = sizeof number,
						  .body = bytes,
						  .body_size = size,
						  .time_ns = number };
	assert_true(gz_board_write(board, &message));
}

/* The number of a message of write_filled(), which must be whole. */
static unsigned check_filled(const struct gz_board_record *record)
{
	unsigned number;
	const unsigned char *bytes = record->body;
	assert_int_equal(record->topic_size, sizeof number);
	memcpy(&number, record->topic, sizeof number);
	assert_int_equal(record->time_ns, number);
	for (size_t i = 0; i < record->body_size; i++)
		if (bytes[i] != (number & 0xff))
			fail_msg("byte %zu of message %u is %u", i, number, bytes[i]);
	return number;
}

static void assert_next(const char *topic, const char *body)
{
	struct gz_board_record record;
	assert_int_equal(gz_board_next(reader, &record), GZ_OK);
	assert_int_equal(record.topic_size, strlen(topic));
	assert_memory_equal(record.topic, topic, record.topic_size);
	assert_int_equal(record.body_size, strlen(body));
	assert_memory_equal(record.body, body, record.body_size);
}

static void assert_none_left(void)
{
	struct gz_board_record record;
	assert_false(gz_board_has_next(reader));
	assert_int_equal(gz_board_next(reader, &record), GZ_ERR_TIMEOUT);
}

static void messages_are_read_in_order_once_they_are_shown(void **state)
{
	(void)state;
	struct gz_board_record record;
	assert_none_left();
	assert_true(write_text("gaze.3d.01.", "one", 1));
	assert_true(write_text("", "two, which is longer than a word", 2));
	assert_none_left();
	gz_board_show(board, false);
	assert_true(write_text("12345678", "", 3));
	assert_next("gaze.3d.01.", "one");
	assert_int_equal(gz_board_next(reader, &record), GZ_OK);
	assert_int_equal(record.time_ns, 2);
	assert_int_equal(record.topic_size, 0);
	assert_none_left();
	gz_board_show(board, true);
	assert_next("12345678", "");
	assert_none_left();
	assert_int_equal(gz_board_overtaken(reader), 0);
}

static void messages_of_every_size_are_whole_wherever_they_lie(void **state)
{
	(void)state;
	struct gz_board_record record;
	for (unsigned i = 0; i < 3000; i++) {
		size_t size = i % 37 == 0 ? GZ_BOARD_BODY_MAX : i % 300;
		write_filled(i, size);
		gz_board_show(board, false);
		assert_int_equal(gz_board_next(reader, &record), GZ_OK);
		assert_int_equal(record.body_size, size);
		assert_int_equal(check_filled(&record), i);
	}
	assert_none_left();
}

static void messages_that_are_too_long_are_left_out(void **state)
{
	(void)state;
	static char text[GZ_BOARD_BODY_MAX + 2];
	memset(text, 'x', sizeof text - 1);
	assert_false(write_text("t", text, 1));
	assert_true(write_text("t", text + 1, 1));
	text[GZ_BOARD_TOPIC_MAX + 1] = '\0';
	assert_false(write_text(text, "b", 1));
	assert_true(write_text(text + 1, "b", 1));
}

static void overtaken_reader_goes_on_with_the_oldest_that_is_left(void **state)
{
	(void)state;
	struct gz_board_record record;
	/* Each takes 8 words of 3 + 1 + 4, and the board has 8192. */
	for (unsigned i = 0; i < 2000; i++)
		write_filled(i, 32);
	gz_board_show(board, false);
	for (unsigned i = 2000 - 1024; i < 2000; i++) {
		assert_int_equal(gz_board_next(reader, &record), GZ_OK);
		assert_int_equal(check_filled(&record), i);
	}
	assert_none_left();
	assert_int_equal(gz_board_overtaken(reader), 1);
}

static void reader_overtaken_by_what_is_not_shown_yet_waits_for_it(void **state)
{
	(void)state;
	struct gz_board_record record;
	write_filled(0, 32);
	gz_board_show(board, false);
	for (unsigned i = 1; i < 2000; i++)
		write_filled(i, 32);
	assert_int_equal(gz_board_next(reader, &record), GZ_ERR_TIMEOUT);
	gz_board_show(board, false);
	assert_int_equal(gz_board_next(reader, &record), GZ_OK);
	assert_int_equal(check_filled(&record), 2000 - 1024);
}

static void skipping_goes_to_the_first_message_of_a_time(void **state)
{
	(void)state;
	for (int i = 0; i < 10; i++)
		assert_true(write_text("t", i < 5 ? "old" : "new", 100 + i));
	gz_board_show(board, false);
	assert_int_equal(gz_board_skip(reader, 105), GZ_OK);
	assert_next("t", "new");
	assert_int_equal(gz_board_skip(reader, 1000), GZ_OK);
	assert_none_left();
	assert_true(write_text("t", "later", 110));
	gz_board_show(board, false);
	assert_next("t", "later");
}

/* In a time namespace, a reader's clock may be ahead of the daemon's. */
static void skipping_concerns_only_what_is_there(void **state)
{
	(void)state;
	struct gz_board_record record;
	assert_true(write_text("gaze.3d.01.", "old", 100));
	gz_board_show(board, false);
	assert_int_equal(gz_board_skip(reader, 1000000), GZ_OK);
	assert_none_left();
	assert_int_equal(gz_board_newest(reader, &record), GZ_ERR_TIMEOUT);
	assert_true(write_text("gaze.3d.01.", "new", 101));
	gz_board_show(board, false);
	assert_int_equal(gz_board_newest(reader, &record), GZ_OK);
	assert_memory_equal(record.body, "new", 3);
	assert_next("gaze.3d.01.", "new");
}

static void newest_gaze_is_read_once(void **state)
{
	(void)state;
	struct gz_board_record record;
	assert_int_equal(gz_board_newest(reader, &record), GZ_ERR_TIMEOUT);
	assert_true(write_text("gaze.3d.01.", "first", 1));
	assert_true(write_text("gaze.3d.01.", "second", 2));
	assert_true(write_text("status", "other", 3));
	assert_int_equal(gz_board_newest(reader, &record), GZ_ERR_TIMEOUT);
	gz_board_show(board, false);
	assert_int_equal(gz_board_newest(reader, &record), GZ_OK);
	assert_int_equal(record.body_size, 6);
	assert_memory_equal(record.body, "second", 6);
	assert_int_equal(gz_board_newest(reader, &record), GZ_ERR_TIMEOUT);
	assert_next("gaze.3d.01.", "first");
}

static void newest_gaze_is_not_read_once_it_is_overwritten_or_too_old(void **state)
{
	(void)state;
	struct gz_board_record record;
	assert_true(write_text("gaze.3d.01.", "old", 1));
	for (unsigned i = 2; i < 2000; i++)
		write_filled(i, 32);
	gz_board_show(board, false);
	assert_int_equal(gz_board_newest(reader, &record), GZ_ERR_TIMEOUT);
	assert_true(write_text("gaze.3d.01.", "old", 2000));
	gz_board_show(board, false);
	assert_int_equal(gz_board_skip(reader, 2001), GZ_OK);
	assert_int_equal(gz_board_newest(reader, &record), GZ_ERR_TIMEOUT);
	assert_true(write_text("gaze.3d.01.", "new", 2001));
	gz_board_show(board, false);
	assert_int_equal(gz_board_newest(reader, &record), GZ_OK);
	assert_memory_equal(record.body, "new", 3);
}

static void reader_cannot_write_to_the_memory(void **state)
{
	(void)state;
	int fd = gz_board_fd(board);
	size_t size = GZ_BOARD_HEADER_SIZE + GZ_BOARD_SIZE_MIN;
	assert_ptr_equal(mmap(NULL, size, PROT_READ | PROT_WRITE, MAP_SHARED, fd, 0), MAP_FAILED);
	void *memory = mmap(NULL, size, PROT_READ, MAP_SHARED, fd, 0);
	assert_ptr_not_equal(memory, MAP_FAILED);
	assert_int_not_equal(mprotect(memory, size, PROT_READ | PROT_WRITE), 0);
	munmap(memory, size);
	assert_int_equal(pwrite(fd, "x", 1, 64), -1);
	assert_int_not_equal(ftruncate(fd, 0), 0);
	assert_int_not_equal(ftruncate(fd, (off_t)(2 * size)), 0);
	assert_int_not_equal(
		fallocate(fd, FALLOC_FL_PUNCH_HOLE | FALLOC_FL_KEEP_SIZE, 0, (off_t)size), 0);
	assert_int_equal(fcntl(fd, F_ADD_SEALS, F_SEAL_WRITE), -1);
}

static void board_of_an_odd_size_is_refused(void **state)
{
	(void)state;
	struct gz_board *odd = NULL;
	assert_int_equal(gz_board_create(GZ_BOARD_SIZE_MIN / 2, &odd), GZ_ERR_INVAL);
	assert_int_equal(gz_board_create(GZ_BOARD_SIZE_MIN + 8, &odd), GZ_ERR_INVAL);
	assert_null(odd);
}

/* A memory that another program might offer as a board. Owned by the caller. */
static int make_memory(const void *header, size_t header_size, size_t size, int seals)
{
	int fd = memfd_create("test-board", MFD_CLOEXEC | MFD_ALLOW_SEALING);
	assert_true(fd >= 0);
	assert_int_equal(ftruncate(fd, (off_t)size), 0);
	assert_int_equal(pwrite(fd, header, header_size, 0), header_size);
	assert_int_equal(fcntl(fd, F_ADD_SEALS, seals), 0);
	return fd;
}

static void assert_no_board(const char *magic, uint64_t claimed, size_t size, int seals)
{
	struct {
		char magic[8];
		uint64_t size;
	} header = { .size = claimed };
	struct gz_board_reader *stranger = NULL;
	memcpy(header.magic, magic, sizeof header.magic);
	int fd = make_memory(&header, sizeof header, size, seals);
	assert_int_equal(gz_board_open(fd, &stranger), GZ_ERR_UNSUPPORTED);
	assert_null(stranger);
	close(fd);
}

static void memory_that_is_no_board_is_refused(void **state)
{
	(void)state;
	const size_t size = GZ_BOARD_SIZE_MIN, whole = GZ_BOARD_HEADER_SIZE + size;
	const int sealed = F_SEAL_SHRINK | F_SEAL_GROW | F_SEAL_FUTURE_WRITE;
	struct gz_board_reader *stranger = NULL;
	assert_no_board("GZBOARD\3", size, whole, sealed); /* another version */
	assert_no_board("somewhat", size, whole, sealed);
	assert_no_board(GZ_BOARD_MAGIC, 2 * size, whole, sealed);
	assert_no_board(GZ_BOARD_MAGIC, size, whole - 8, sealed); /* cut short */
	assert_no_board(GZ_BOARD_MAGIC, size, GZ_BOARD_HEADER_SIZE, sealed);
	assert_no_board(GZ_BOARD_MAGIC, size, 100, sealed);
	/* It might shrink under the reader, which would end the program. */
	assert_no_board(GZ_BOARD_MAGIC, size, whole, F_SEAL_GROW | F_SEAL_FUTURE_WRITE);
	assert_no_board(GZ_BOARD_MAGIC, size, whole, F_SEAL_SHRINK | F_SEAL_GROW);
	int pipes[2];
	assert_int_equal(pipe2(pipes, O_CLOEXEC), 0);
	assert_int_equal(gz_board_open(pipes[0], &stranger), GZ_ERR_UNSUPPORTED);
	assert_int_equal(gz_board_open(-1, &stranger), GZ_ERR_UNSUPPORTED);
	close(pipes[0]);
	close(pipes[1]);
}

/* Words of a board by their places in the file, as docs/protocol.md tells them. */
enum { SIZE_WORD = 1, HEAD_WORD = 8, NEWEST_WORD = 9, TAIL_WORD = 16, FIRST_WORD = 512 };

/* @return what reading gives that reads to the end of a board with these words */
static enum gz_result read_words(const uint64_t *words)
{
	static uint64_t memory[FIRST_WORD + GZ_BOARD_SIZE_MIN / 8];
	struct gz_board_reader *stranger = NULL;
	struct gz_board_record record;
	memset(memory, 0, sizeof memory);
	memcpy(memory, words, (FIRST_WORD + 8) * sizeof *words);
	memcpy(memory, GZ_BOARD_MAGIC, 8);
	memory[SIZE_WORD] = GZ_BOARD_SIZE_MIN;
	int fd = make_memory(memory, sizeof memory, sizeof memory,
			     F_SEAL_SHRINK | F_SEAL_GROW | F_SEAL_WRITE);
	assert_int_equal(gz_board_open(fd, &stranger), GZ_OK);
	close(fd);
	enum gz_result newest = gz_board_newest(stranger, &record), next;
	do
		next = gz_board_next(stranger, &record);
	while (next == GZ_OK);
	gz_board_close(&stranger);
	return newest == GZ_ERR_PROTOCOL ? newest : next;
}

static void garbage_on_a_board_is_found(void **state)
{
	(void)state;
	static uint64_t words[FIRST_WORD + 8];
	uint64_t *first = words + FIRST_WORD;
	const uint64_t none = UINT64_MAX;
	/* A message of one word of topic and one of body, which is fine. */
	words[HEAD_WORD] = 5;
	words[NEWEST_WORD] = none;
	first[0] = 5 | UINT64_C(8) << 32;
	first[2] = 8;
	assert_int_equal(read_words(words), GZ_ERR_TIMEOUT);
	first[0] = 4 | UINT64_C(8) << 32; /* sizes that contradict each other */
	assert_int_equal(read_words(words), GZ_ERR_PROTOCOL);
	first[0] = 0;
	assert_int_equal(read_words(words), GZ_ERR_PROTOCOL);
	first[0] = 5 | UINT64_C(8) << 32;
	first[2] = UINT64_MAX;
	assert_int_equal(read_words(words), GZ_ERR_PROTOCOL);
	first[2] = 8;
	words[HEAD_WORD] = 4; /* it ends before its end */
	assert_int_equal(read_words(words), GZ_ERR_PROTOCOL);
	words[HEAD_WORD] = none; /* more than fits */
	assert_int_equal(read_words(words), GZ_ERR_PROTOCOL);
	words[HEAD_WORD] = 5;
	words[NEWEST_WORD] = 5;
	assert_int_equal(read_words(words), GZ_ERR_PROTOCOL);
	words[NEWEST_WORD] = 0;
	words[TAIL_WORD] = 7; /* as while messages are written */
	assert_int_equal(read_words(words), GZ_ERR_TIMEOUT);
}

/* Write numbers until told to stop, as fast as possible. */
static atomic_bool stopped;

static void *write_much(void *user)
{
	unsigned *written = user;
	while (!atomic_load(&stopped) || *written < 20000) {
		write_filled(*written, (*written * 7) % 900);
		*written += 1;
		if (*written % 3 == 0)
			gz_board_show(board, true);
	}
	gz_board_show(board, true);
	return NULL;
}

/* What a reader in a thread reads; every message must be whole and newer than the last. */
static void *read_much(void *user)
{
	unsigned *count = user, last = 0;
	struct gz_board_reader *mine = NULL;
	struct gz_board_record record;
	assert_int_equal(gz_board_open(gz_board_fd(board), &mine), GZ_OK);
	while (*count < 3000) {
		enum gz_result result = gz_board_next(mine, &record);
		if (result == GZ_ERR_TIMEOUT) {
			gz_board_wait(mine, PATIENCE_NS);
			continue;
		}
		assert_int_equal(result, GZ_OK);
		unsigned number = check_filled(&record);
		assert_true(*count == 0 || number > last);
		last = number;
		*count += 1;
		if (*count % 64 == 0 && gz_board_newest(mine, &record) == GZ_OK)
			check_filled(&record);
	}
	gz_board_close(&mine);
	return NULL;
}

static void readers_beside_a_fast_writer_read_whole_messages(void **state)
{
	(void)state;
	enum { READERS = 3 };
	pthread_t writer, threads[READERS];
	unsigned written = 0, counts[READERS] = { 0 };
	atomic_store(&stopped, false);
	for (int i = 0; i < READERS; i++)
		assert_int_equal(pthread_create(&threads[i], NULL, read_much, &counts[i]), 0);
	assert_int_equal(pthread_create(&writer, NULL, write_much, &written), 0);
	for (int i = 0; i < READERS; i++)
		pthread_join(threads[i], NULL);
	atomic_store(&stopped, true);
	pthread_join(writer, NULL);
	for (int i = 0; i < READERS; i++)
		assert_int_equal(counts[i], 3000);
}

static void *show_later(void *user)
{
	(void)user;
	gz_clock_sleep_until_ns(gz_clock_now_ns() + 20 * GZ_NS_PER_MS);
	assert_true(write_text("t", "woken", 1));
	gz_board_show(board, true);
	return NULL;
}

static void waiting_ends_with_a_message_or_with_its_time(void **state)
{
	(void)state;
	pthread_t thread;
	int64_t begin_ns = gz_clock_now_ns();
	assert_int_equal(gz_board_wait(reader, 5 * GZ_NS_PER_MS), GZ_ERR_TIMEOUT);
	assert_true(gz_clock_now_ns() - begin_ns >= 5 * GZ_NS_PER_MS);
	assert_int_equal(pthread_create(&thread, NULL, show_later, NULL), 0);
	while (!gz_board_has_next(reader))
		assert_int_equal(gz_board_wait(reader, PATIENCE_NS), GZ_OK);
	assert_next("t", "woken");
	pthread_join(thread, NULL);
	assert_true(gz_clock_now_ns() - begin_ns < PATIENCE_NS);
}

/* Readers that wake each other: all messages have nearly the same time, as if there were many. */

enum { CHAIN_READERS = 6, SELFISH_READERS = 6 };

static atomic_uint chain_heard[CHAIN_READERS];

static void *read_chain(void *user)
{
	atomic_uint *heard = user;
	struct gz_board_reader *mine = NULL;
	struct gz_board_record record;
	assert_int_equal(gz_board_open(gz_board_fd(board), &mine), GZ_OK);
	while (!atomic_load(&stopped)) {
		if (gz_board_next(mine, &record) == GZ_OK)
			atomic_fetch_add(heard, 1);
		else
			gz_board_wait(mine, PATIENCE_NS);
	}
	gz_board_close(&mine);
	return NULL;
}

/* Give threads the time to wait at the board. If one does not, its wake-up is not tested. */
static void let_threads_wait(void)
{
	gz_clock_sleep_until_ns(gz_clock_now_ns() + 10 * GZ_NS_PER_MS);
}

static void ring_once(int64_t time_ns)
{
	assert_true(write_text("t", "ring", time_ns));
	gz_board_show(board, true);
}

/* Whether all readers hear @p rings within @p patience_ns, without a further one. */
static bool all_hear(unsigned rings, int64_t patience_ns)
{
	int64_t until_ns = gz_clock_now_ns() + patience_ns;
	for (int i = 0; i < CHAIN_READERS;) {
		if (atomic_load(&chain_heard[i]) >= rings)
			i++;
		else if (gz_clock_now_ns() > until_ns)
			return false;
		else
			gz_clock_sleep_until_ns(gz_clock_now_ns() + GZ_NS_PER_MS);
	}
	return true;
}

static void start_chain(pthread_t threads[CHAIN_READERS])
{
	for (int i = 0; i < CHAIN_READERS; i++) {
		atomic_store(&chain_heard[i], 0);
		assert_int_equal(pthread_create(&threads[i], NULL, read_chain, &chain_heard[i]), 0);
	}
	let_threads_wait();
}

static void stop_chain(pthread_t threads[CHAIN_READERS])
{
	atomic_store(&stopped, true);
	ring_once(PATIENCE_NS); /* so late that all are woken at once */
	for (int i = 0; i < CHAIN_READERS; i++)
		pthread_join(threads[i], NULL);
}

static void readers_wake_each_other(void **state)
{
	(void)state;
	pthread_t threads[CHAIN_READERS];
	atomic_store(&stopped, false);
	start_chain(threads);
	for (unsigned i = 1; i <= 20; i++) {
		ring_once(i);
		assert_true(all_hear(i, PATIENCE_NS / 2));
		let_threads_wait();
	}
	stop_chain(threads);
}

/* Byte 80 is the futex, as docs/protocol.md tells. */
enum { BELL_BYTE = 80 };

/* A program that waits for messages but wakes nobody. It waits again before others do. */
static void *wait_and_wake_nobody(void *user)
{
	const unsigned char *memory = user;
	while (!atomic_load(&stopped)) {
		uint32_t ring;
		memcpy(&ring, memory + BELL_BYTE, sizeof ring);
		syscall(SYS_futex, memory + BELL_BYTE, FUTEX_WAIT_BITSET, ring, NULL, NULL,
			UINT32_C(1) << ring % 32);
	}
	return NULL;
}

/* After that the writer wakes all readers itself. */
static void readers_that_wake_nobody_hold_up_one_message(void **state)
{
	(void)state;
	pthread_t selfish[SELFISH_READERS], threads[CHAIN_READERS];
	void *memory =
		mmap(NULL, GZ_BOARD_HEADER_SIZE, PROT_READ, MAP_SHARED, gz_board_fd(board), 0);
	assert_ptr_not_equal(memory, MAP_FAILED);
	atomic_store(&stopped, false);
	/* They wait first, so they are woken first. */
	for (int i = 0; i < SELFISH_READERS; i++)
		assert_int_equal(pthread_create(&selfish[i], NULL, wait_and_wake_nobody, memory),
				 0);
	let_threads_wait();
	start_chain(threads);
	unsigned held_up = 0;
	for (unsigned i = 1; i <= 20; i++) {
		ring_once(i);
		held_up += !all_hear(i, PATIENCE_NS / 20);
		let_threads_wait();
	}
	assert_true(held_up <= 1);
	stop_chain(threads);
	for (int i = 0; i < SELFISH_READERS; i++)
		pthread_join(selfish[i], NULL);
	munmap(memory, GZ_BOARD_HEADER_SIZE);
}

/* The door. */

static char door_path[64];

static enum gz_result take_answer(int fd, int *out_fd)
{
	struct pollfd answer = { .fd = fd, .events = POLLIN };
	poll(&answer, 1, PATIENCE_MS);
	return gz_board_door_take(fd, out_fd);
}

static void door_gives_the_board_to_those_who_ask(void **state)
{
	(void)state;
	struct gz_board_reader *guest = NULL;
	struct gz_board_record record;
	int door, first, second, fd;
	assert_int_equal(gz_board_door_open(door_path, &door), GZ_OK);
	assert_int_equal(gz_board_door_serve(door, gz_board_fd(board)), GZ_ERR_TIMEOUT);
	assert_int_equal(gz_board_door_ask(door_path, &first), GZ_OK);
	assert_int_equal(gz_board_door_take(first, &fd), GZ_ERR_TIMEOUT);
	assert_int_equal(gz_board_door_ask(door_path, &second), GZ_OK);
	close(second); /* it does not wait */
	assert_int_equal(gz_board_door_serve(door, gz_board_fd(board)), GZ_OK);
	assert_int_equal(gz_board_door_serve(door, gz_board_fd(board)), GZ_OK);
	assert_int_equal(take_answer(first, &fd), GZ_OK);
	assert_int_equal(gz_board_open(fd, &guest), GZ_OK);
	assert_true(gz_board_is_same(guest, gz_board_fd(board)));
	close(fd);
	close(first);
	assert_true(write_text("t", "hello", 1));
	gz_board_show(board, false);
	assert_int_equal(gz_board_next(guest, &record), GZ_OK);
	/* What it holds stays when the writer is gone. */
	gz_board_destroy(&board);
	assert_memory_equal(record.body, "hello", 5);
	assert_int_equal(gz_board_next(guest, &record), GZ_ERR_TIMEOUT);
	gz_board_close(&guest);
	close(door);
}

static void door_without_a_daemon_is_not_found(void **state)
{
	(void)state;
	int door, fd;
	char longer[200];
	memset(longer, 'x', sizeof longer - 1);
	longer[sizeof longer - 1] = '\0';
	unlink(door_path);
	assert_int_equal(gz_board_door_ask(door_path, &fd), GZ_ERR_NOT_FOUND);
	assert_int_equal(gz_board_door_open(door_path, &door), GZ_OK);
	close(door); /* as after a daemon that was killed */
	assert_int_equal(gz_board_door_ask(door_path, &fd), GZ_ERR_NOT_FOUND);
	assert_int_equal(gz_board_door_open(door_path, &door), GZ_OK);
	assert_int_equal(gz_board_door_ask(door_path, &fd), GZ_OK);
	close(door); /* before an answer */
	assert_int_equal(take_answer(fd, &door), GZ_ERR_PROTOCOL);
	close(fd);
	assert_int_equal(gz_board_door_ask(longer, &fd), GZ_ERR_FULL);
	assert_int_equal(gz_board_door_open(longer, &fd), GZ_ERR_FULL);
}

static int set_up_door(void **state)
{
	snprintf(door_path, sizeof door_path, "/tmp/gz-board-%ld", (long)getpid());
	return set_up(state);
}

static int tear_down_door(void **state)
{
	unlink(door_path);
	return tear_down(state);
}

#define TEST(function)      cmocka_unit_test_setup_teardown(function, set_up, tear_down)
#define DOOR_TEST(function) cmocka_unit_test_setup_teardown(function, set_up_door, tear_down_door)

TEST_SUITE(board)
{
	const struct CMUnitTest tests[] = {
		TEST(messages_are_read_in_order_once_they_are_shown),
		TEST(messages_of_every_size_are_whole_wherever_they_lie),
		TEST(messages_that_are_too_long_are_left_out),
		TEST(overtaken_reader_goes_on_with_the_oldest_that_is_left),
		TEST(reader_overtaken_by_what_is_not_shown_yet_waits_for_it),
		TEST(skipping_goes_to_the_first_message_of_a_time),
		TEST(skipping_concerns_only_what_is_there),
		TEST(newest_gaze_is_read_once),
		TEST(newest_gaze_is_not_read_once_it_is_overwritten_or_too_old),
		TEST(reader_cannot_write_to_the_memory),
		TEST(board_of_an_odd_size_is_refused),
		TEST(memory_that_is_no_board_is_refused),
		TEST(garbage_on_a_board_is_found),
		TEST(readers_beside_a_fast_writer_read_whole_messages),
		TEST(waiting_ends_with_a_message_or_with_its_time),
		TEST(readers_wake_each_other),
		TEST(readers_that_wake_nobody_hold_up_one_message),
		DOOR_TEST(door_gives_the_board_to_those_who_ask),
		DOOR_TEST(door_without_a_daemon_is_not_found),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
