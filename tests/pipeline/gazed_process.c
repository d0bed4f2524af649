#include "suite.h"

#include "gazed_process.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <grp.h>
#include <poll.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>
#include <zmq.h>

#include "base/clock.h"
#include "protocol/wire.h"

enum { ARGUMENTS_MAX = 32 };

/* Daemons of one test that have not ended yet. */
static pid_t running[8];

static void note_running(pid_t from, pid_t to)
{
	for (size_t i = 0; i < sizeof running / sizeof *running; i++) {
		if (running[i] == from) {
			running[i] = to;
			return;
		}
	}
	fail_msg("too many daemons in one test");
}

void gazed_kill_all(void)
{
	for (size_t i = 0; i < sizeof running / sizeof *running; i++) {
		if (running[i] == 0)
			continue;
		kill(running[i], SIGKILL);
		waitpid(running[i], NULL, 0);
		running[i] = 0;
	}
}

void gazed_place_make(struct gazed_place *place)
{
	snprintf(place->directory, sizeof place->directory, "/tmp/gz_gazed_XXXXXX");
	assert_non_null(mkdtemp(place->directory));
	snprintf(place->recordings, sizeof place->recordings, "%s/rec", place->directory);
	assert_int_equal(mkdir(place->recordings, 0700), 0);
}

static void remove_files(const char *directory)
{
	DIR *handle = opendir(directory);
	struct dirent *entry;
	while (handle && (entry = readdir(handle))) {
		char path[512];
		snprintf(path, sizeof path, "%s/%s", directory, entry->d_name);
		if (entry->d_name[0] != '.')
			unlink(path);
	}
	if (handle)
		closedir(handle);
}

void gazed_place_remove(struct gazed_place *place)
{
	remove_files(place->recordings);
	rmdir(place->recordings);
	remove_files(place->directory);
	rmdir(place->directory);
}

static bool contains(const char *const *arguments, const char *wanted)
{
	for (; *arguments; arguments++) {
		if (strcmp(*arguments, wanted) == 0)
			return true;
	}
	return false;
}

/* The command line: what every test needs, except options that @p start gives itself. */
static void make_arguments(const struct gazed_start *start, const char **argv)
{
	int argc = 0;
	argv[argc++] = "gazed";
	argv[argc++] = "--recording.directory";
	argv[argc++] = start->place->recordings;
	if (!contains(start->arguments, "--config")) {
		argv[argc++] = "--config";
		argv[argc++] = "/dev/null";
	}
	if (!contains(start->arguments, "--control"))
		argv[argc++] = "--tcp=off";
	for (int i = 0; start->arguments[i]; i++) {
		assert_true(argc < ARGUMENTS_MAX - 1);
		argv[argc++] = start->arguments[i];
	}
	argv[argc] = NULL;
}

/* Runs in the child: hand over sockets as systemd does. LISTEN_PID is there, so nothing is
 * allocated. */
static void hand_over(const struct gazed_start *start)
{
	static char pid[32];
	for (int i = 0; i < start->handed_count; i++) {
		if (dup2(start->handed[i], STDERR_FILENO + 1 + i) < 0)
			_exit(126);
	}
	snprintf(pid, sizeof pid, "LISTEN_PID=%ld", (long)getpid());
	putenv(pid);
}

/* Runs in the child: system calls only. */
static void become_gazed(const struct gazed_start *start, const struct gazed_process *process,
			 const char **argv)
{
	int fd = open(process->log, O_WRONLY | O_CREAT | O_TRUNC, 0600);
	struct rlimit limit = { start->file_size_max, start->file_size_max };
	if (fd < 0 || dup2(fd, STDERR_FILENO) < 0 ||
	    (start->file_size_max && setrlimit(RLIMIT_FSIZE, &limit) != 0))
		_exit(126);
	if (start->user && (setgroups(1, &start->group) != 0 || setgid(start->user) != 0 ||
			    setuid(start->user) != 0))
		_exit(126);
	hand_over(start);
	for (fd = 0; start->without_streams && fd <= STDERR_FILENO; fd++)
		close(fd);
	execv(GAZED_PROGRAM, (char **)argv);
	_exit(127);
}

void gazed_spawn(const struct gazed_start *start, struct gazed_process *out)
{
	static int number;
	char count[16];
	const char *argv[ARGUMENTS_MAX];
	make_arguments(start, argv);
	setenv("GAZECAST_RUNTIME_DIR", start->place->directory, 1);
	snprintf(out->log, sizeof out->log, "%s/said-%d", start->place->directory, number++);
	snprintf(count, sizeof count, "%d", start->handed_count);
	setenv("LISTEN_PID", "0", 1);
	setenv("LISTEN_FDS", count, 1);
	out->pid = fork();
	assert_true(out->pid >= 0);
	if (out->pid == 0)
		become_gazed(start, out, argv);
	note_running(0, out->pid);
}

long gazed_resident_kib(const struct gazed_process *process)
{
	char path[64];
	long pages = 0;
	snprintf(path, sizeof path, "/proc/%d/statm", (int)process->pid);
	FILE *file = fopen(path, "re");
	assert_non_null(file);
	assert_int_equal(fscanf(file, "%*s %ld", &pages), 1);
	fclose(file);
	return pages * (sysconf(_SC_PAGESIZE) / 1024);
}

const char *gazed_said(const struct gazed_process *process)
{
	static char text[16384];
	FILE *file = fopen(process->log, "r");
	size_t length = file ? fread(text, 1, sizeof text - 1, file) : 0;
	text[length] = '\0';
	if (file)
		fclose(file);
	return text;
}

static void *connect_request(void *context, const struct gazed_place *place)
{
	char endpoint[128];
	int linger = 0;
	void *socket = zmq_socket(context, ZMQ_REQ);
	snprintf(endpoint, sizeof endpoint, "ipc://%s/control", place->directory);
	zmq_setsockopt(socket, ZMQ_LINGER, &linger, sizeof linger);
	assert_int_equal(zmq_connect(socket, endpoint), 0);
	return socket;
}

/* The answer to @p request, or NULL after @p timeout_ms. */
static const char *request_within(const struct gazed_place *place, const char *request,
				  int timeout_ms, double *out_ms)
{
	static char answer[2048];
	void *context = zmq_ctx_new();
	void *socket = connect_request(context, place);
	zmq_setsockopt(socket, ZMQ_RCVTIMEO, &timeout_ms, sizeof timeout_ms);
	int64_t begin_ns = gz_clock_now_ns();
	zmq_send(socket, request, strlen(request), 0);
	int length = zmq_recv(socket, answer, sizeof answer - 1, 0);
	if (out_ms)
		*out_ms = gz_ns_to_ms(gz_clock_now_ns() - begin_ns);
	if (length >= 0)
		answer[length < (int)sizeof answer ? length : (int)sizeof answer - 1] = '\0';
	zmq_close(socket);
	zmq_ctx_term(context);
	return length >= 0 ? answer : NULL;
}

const char *gazed_request(const struct gazed_place *place, const char *request, double *out_ms)
{
	const char *answer = request_within(place, request, PATIENCE_MS, out_ms);
	if (!answer)
		fail_msg("no answer to \"%s\"", request);
	return answer;
}

void gazed_wait_ready(const struct gazed_place *place, struct gazed_process *process)
{
	int64_t deadline_ns = gz_clock_now_ns() + PATIENCE_NS;
	while (gz_clock_now_ns() < deadline_ns) {
		if (request_within(place, "v", 50, NULL))
			return;
		if (waitpid(process->pid, NULL, WNOHANG) != 0) {
			note_running(process->pid, 0);
			fail_msg("gazed ended: %s", gazed_said(process));
		}
	}
	fail_msg("gazed does not answer: %s", gazed_said(process));
}

int gazed_wait_exit(struct gazed_process *process)
{
	int status;
	/* A file descriptor of the process becomes readable when it ends. */
	int fd = (int)syscall(SYS_pidfd_open, process->pid, 0);
	struct pollfd end = { .fd = fd, .events = POLLIN };
	if (fd >= 0 && poll(&end, 1, PATIENCE_MS) == 0) {
		gazed_kill_all();
		fail_msg("gazed does not end: %s", gazed_said(process));
	}
	if (fd >= 0)
		close(fd);
	assert_int_equal(waitpid(process->pid, &status, 0), process->pid);
	note_running(process->pid, 0);
	if (strstr(gazed_said(process), "Sanitizer: "))
		fail_msg("%s", gazed_said(process));
	return WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
}

int gazed_stop(struct gazed_process *process, int signal)
{
	assert_int_equal(kill(process->pid, signal), 0);
	return gazed_wait_exit(process);
}

void reader_open(struct reader *reader, const struct gazed_place *place, const char *topic)
{
	char endpoint[128];
	int unlimited = 0, linger = 0, again_ms = 20;
	*reader = (struct reader) { .context = zmq_ctx_new() };
	reader->socket = zmq_socket(reader->context, ZMQ_SUB);
	assert_non_null(reader->socket);
	snprintf(endpoint, sizeof endpoint, "ipc://%s/stream", place->directory);
	zmq_setsockopt(reader->socket, ZMQ_RCVHWM, &unlimited, sizeof unlimited);
	zmq_setsockopt(reader->socket, ZMQ_LINGER, &linger, sizeof linger);
	zmq_setsockopt(reader->socket, ZMQ_RECONNECT_IVL, &again_ms, sizeof again_ms);
	zmq_setsockopt(reader->socket, ZMQ_SUBSCRIBE, topic, strlen(topic));
	assert_int_equal(zmq_connect(reader->socket, endpoint), 0);
}

static void keep(struct reader *reader, const char *topic, const void *bytes, size_t size)
{
	if (reader->count == reader->room) {
		reader->room = reader->room ? 2 * reader->room : 4096;
		reader->messages =
			realloc(reader->messages, reader->room * sizeof *reader->messages);
		assert_non_null(reader->messages);
	}
	struct received *message = &reader->messages[reader->count++];
	snprintf(message->topic, sizeof message->topic, "%s", topic);
	message->size = size;
	message->bytes = malloc(size + 1);
	assert_non_null(message->bytes);
	memcpy(message->bytes, bytes, size);
	struct gz_gaze gaze;
	if (strncmp(topic, GZ_TOPIC_GAZE, strlen(GZ_TOPIC_GAZE)) == 0) {
		assert_int_equal(gz_wire_decode_gaze(bytes, size, &gaze), GZ_OK);
		reader->gaze_count++;
		reader->newest_seq = gaze.seq;
	} else if (strcmp(topic, GZ_TOPIC_STATUS) == 0) {
		assert_int_equal(gz_wire_decode_status(bytes, size, &reader->status), GZ_OK);
		reader->status_count++;
	}
}

bool reader_receive(struct reader *reader, int timeout_ms)
{
	char topic[80];
	unsigned char bytes[GZ_WIRE_MESSAGE_SIZE];
	zmq_setsockopt(reader->socket, ZMQ_RCVTIMEO, &timeout_ms, sizeof timeout_ms);
	int topic_length = zmq_recv(reader->socket, topic, sizeof topic - 1, 0);
	if (topic_length < 0)
		return false;
	assert_true(topic_length < (int)sizeof topic - 1);
	topic[topic_length] = '\0';
	int size = zmq_recv(reader->socket, bytes, sizeof bytes, 0);
	int more;
	size_t more_size = sizeof more;
	assert_int_equal(zmq_getsockopt(reader->socket, ZMQ_RCVMORE, &more, &more_size), 0);
	assert_int_equal(more, 0);
	assert_true(size > 0 && size <= (int)sizeof bytes);
	keep(reader, topic, bytes, (size_t)size);
	return true;
}

void reader_receive_gaze(struct reader *reader, size_t count)
{
	while (reader->gaze_count < count) {
		if (!reader_receive(reader, PATIENCE_MS))
			fail_msg("%zu of %zu gaze messages", reader->gaze_count, count);
	}
}

void reader_wait_recording(struct reader *reader, enum gz_recording_state state)
{
	int64_t deadline_ns = gz_clock_now_ns() + PATIENCE_NS;
	while (reader->status_count == 0 || reader->status.recording.state != state) {
		reader_receive(reader, 1000);
		if (gz_clock_now_ns() > deadline_ns)
			fail_msg("recording is %s, waited for %s",
				 gz_recording_state_name(reader->status.recording.state),
				 gz_recording_state_name(state));
	}
}

void reader_drain(struct reader *reader, int quiet_ms)
{
	while (reader_receive(reader, quiet_ms))
		;
}

void reader_hang_up(struct reader *reader)
{
	if (!reader->socket)
		return;
	zmq_close(reader->socket);
	zmq_ctx_term(reader->context);
	reader->socket = NULL;
}

void reader_close(struct reader *reader)
{
	reader_hang_up(reader);
	for (size_t i = 0; i < reader->count; i++)
		free(reader->messages[i].bytes);
	free(reader->messages);
}
