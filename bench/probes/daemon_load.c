/* Prints what the gaze daemon costs and how late its messages are: gazed with the simulator, and
 * readers of the stream and of latest in threads of this program. Late is counted from the moment
 * at which the simulated tracker's sample was due at the driver to the moment at which a reader has
 * its message.
 *
 * The daemon's share of a core is compared with that of a thread that wakes as often as there are
 * samples and does nothing else, and with one that also wakes the stream's readers. All are
 * measured in turn, several times, and the medians of all rounds are printed, because the speed of
 * a machine varies.
 *
 * usage: daemon_load [OPTION]..., see --help */
#include <dirent.h>
#include <linux/futex.h>
#include <pthread.h>
#include <signal.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>
#include <zmq.h>

#include "base/clock.h"
#include "base/log.h"
#include "base/option.h"
#include "base/order.h"
#include "client/client.h"
#include "client/stream.h"
#include "protocol/wire.h"

/* Targets, printed beside the results: times a thread that only wakes, ms, KiB, ms. */
static const double CPU_TARGET = 1.8;
static const double LATENCY_TARGET_MS = 0.25;
static const long MEMORY_TARGET_KIB = 20 * 1024;
static const double START_TARGET_MS = 100;

/* How often a reader of latest polls, like a renderer at each frame. */
enum { FRAMES_HZ = 60 };

enum { READERS_MAX = 256, TASKS_MAX = 32, ROUNDS_MAX = 64 };

struct settings {
	double seconds;
	int rounds;
	bool library;
	int rate_hz;
	int streams;
	int latest;
	char topic[64];
	bool help;
};

#define AT(field) offsetof(struct settings, field)

static const struct gz_option options[] = {
	{ "seconds", GZ_OPTION_DOUBLE, AT(seconds), 1, 36000, 0, NULL, "4",
	  "how long to measure in each round, s" },
	{ "rounds", GZ_OPTION_INT, AT(rounds), 1, ROUNDS_MAX, 0, NULL, "5",
	  "how often to measure; medians are printed" },
	{ "library", GZ_OPTION_BOOL, AT(library), 0, 0, 0, NULL, "true",
	  "readers use the client library, which reads the board; false: sockets of ZeroMQ" },
	{ "rate-hz", GZ_OPTION_INT, AT(rate_hz), 30, 4000, 0, NULL, "1200",
	  "of the simulated tracker" },
	{ "streams", GZ_OPTION_INT, AT(streams), 1, READERS_MAX, 0, NULL, "4",
	  "readers of the stream" },
	{ "latest", GZ_OPTION_INT, AT(latest), 0, READERS_MAX, 0, NULL, "4",
	  "readers of the latest gaze" },
	{ "topic", GZ_OPTION_STRING, AT(topic), 0, sizeof(((struct settings *)0)->topic), 0, NULL,
	  "gaze.", "what the stream's readers subscribe to; empty: everything" },
	{ "help", GZ_OPTION_BOOL, AT(help), 0, 0, 0, NULL, "false", "print this and leave" },
};

/* One reader of the stream. */
struct reader {
	pthread_t thread;
	const struct settings *settings;
	void *context;
	char directory[64];
	size_t wanted; /* gaze messages, after the warm-up of one second */
	size_t count;
	double *latency_ms;
	uint64_t first_seq, last_seq;
};

/* A thread of the daemon, as the kernel counts it. */
struct task {
	long id;
	char name[32];
	double cpu_s;
	uint64_t switches;
};

struct usage {
	int64_t time_ns;
	size_t count;
	struct task task[TASKS_MAX];
};

static void *open_socket(const struct reader *reader, const char *channel, const char *topic)
{
	char endpoint[256];
	int unlimited = 0, timeout_ms = 5000, again_ms = 10, conflate = 1;
	void *socket = zmq_socket(reader->context, ZMQ_SUB);
	snprintf(endpoint, sizeof endpoint, "ipc://%s/%s", reader->directory, channel);
	if (strcmp(channel, "latest") == 0)
		zmq_setsockopt(socket, ZMQ_CONFLATE, &conflate, sizeof conflate);
	else
		zmq_setsockopt(socket, ZMQ_RCVHWM, &unlimited, sizeof unlimited);
	zmq_setsockopt(socket, ZMQ_RCVTIMEO, &timeout_ms, sizeof timeout_ms);
	zmq_setsockopt(socket, ZMQ_RECONNECT_IVL, &again_ms, sizeof again_ms);
	zmq_setsockopt(socket, ZMQ_SUBSCRIBE, topic, strlen(topic));
	zmq_connect(socket, endpoint);
	return socket;
}

static void close_socket(void *socket)
{
	int linger = 0;
	zmq_setsockopt(socket, ZMQ_LINGER, &linger, sizeof linger);
	zmq_close(socket);
}

static void take(struct reader *reader, const struct gz_gaze *gaze, int64_t now_ns)
{
	/* Caches, queues and the processor's clock settle first. */
	if (gaze->seq < (uint64_t)reader->settings->rate_hz)
		return;
	if (reader->count == 0)
		reader->first_seq = gaze->seq;
	reader->last_seq = gaze->seq;
	/* The simulator delivers at the moment of exposure: no latency and no skew are set. */
	reader->latency_ms[reader->count++] = gz_ns_to_ms(now_ns - gaze->host_ns);
}

static void *read_stream_by_library(void *user)
{
	struct reader *reader = user;
	char endpoint[256];
	const char *const topics[] = { reader->settings->topic, NULL };
	struct gz_stream *stream = NULL;
	struct gz_message message;
	snprintf(endpoint, sizeof endpoint, "ipc://%s/stream", reader->directory);
	if (gz_stream_open_with_keys(endpoint, topics, NULL, NULL, &stream) != GZ_OK)
		abort();
	while (reader->count < reader->wanted && gz_stream_read(stream, 5000, &message) == GZ_OK)
		if (message.kind == GZ_MESSAGE_GAZE)
			take(reader, &message.gaze, message.received_ns);
	gz_stream_close(&stream);
	return NULL;
}

static void *read_latest_by_library(void *user)
{
	struct reader *reader = user;
	char endpoint[256];
	struct gz_client *client = NULL;
	struct gz_gaze gaze;
	snprintf(endpoint, sizeof endpoint, "ipc://%s/latest", reader->directory);
	if (gz_client_open_with_keys(endpoint, NULL, NULL, &client) != GZ_OK)
		abort();
	int64_t begin_ns = gz_clock_now_ns();
	size_t frames = (size_t)((reader->settings->seconds + 1) * FRAMES_HZ);
	for (size_t i = 1; i <= frames; i++) {
		gz_clock_sleep_until_ns(begin_ns + (int64_t)i * GZ_NS_PER_S / FRAMES_HZ);
		if (gz_client_latest(client, &gaze, NULL) == GZ_OK)
			reader->count++;
	}
	gz_client_close(&client);
	return NULL;
}

static void *read_stream(void *user)
{
	struct reader *reader = user;
	void *socket = open_socket(reader, "stream", reader->settings->topic);
	char topic[80];
	unsigned char bytes[GZ_WIRE_MESSAGE_SIZE];
	struct gz_gaze gaze;
	while (reader->count < reader->wanted) {
		int length = zmq_recv(socket, topic, sizeof topic, 0);
		int size = length < 0 ? -1 : zmq_recv(socket, bytes, sizeof bytes, 0);
		int64_t now_ns = gz_clock_now_ns();
		if (size < 0)
			break;
		if (length >= 5 && memcmp(topic, GZ_TOPIC_GAZE, 5) == 0 &&
		    gz_wire_decode_gaze(bytes, (size_t)size, &gaze) == GZ_OK)
			take(reader, &gaze, now_ns);
	}
	close_socket(socket);
	return NULL;
}

static void *read_latest(void *user)
{
	struct reader *reader = user;
	void *socket = open_socket(reader, "latest", "");
	unsigned char bytes[GZ_WIRE_MESSAGE_SIZE];
	struct gz_gaze gaze;
	int64_t begin_ns = gz_clock_now_ns();
	size_t frames = (size_t)((reader->settings->seconds + 1) * FRAMES_HZ);
	for (size_t i = 1; i <= frames; i++) {
		gz_clock_sleep_until_ns(begin_ns + (int64_t)i * GZ_NS_PER_S / FRAMES_HZ);
		int size = zmq_recv(socket, bytes, sizeof bytes, ZMQ_DONTWAIT);
		if (size > 0 && gz_wire_decode_gaze(bytes, (size_t)size, &gaze) == GZ_OK)
			reader->count++;
	}
	close_socket(socket);
	return NULL;
}

static pid_t spawn(const char *directory, const struct settings *settings)
{
	char rate[16], readers[16];
	snprintf(rate, sizeof rate, "%d", settings->rate_hz);
	snprintf(readers, sizeof readers, "%d", settings->streams);
	setenv("GAZECAST_RUNTIME_DIR", directory, 1);
	setenv("GZ_LOG", "*:warn", 1);
	pid_t pid = fork();
	if (pid == 0) {
		execl(GAZED_PROGRAM, "gazed", "--config", "/dev/null", "--tcp", "off", "--driver",
		      "sim", "--sim.rate_hz", rate, "--sim.latency_ms", "0",
		      "--sim.latency_jitter_ms", "0", "--sim.clock_skew_ppm", "0", "--wait-readers",
		      readers, (char *)NULL);
		_exit(127);
	}
	return pid;
}

/* From the start of the program to its first answer. */
static double start_ms(void *context, const char *directory, int64_t begin_ns)
{
	char endpoint[256], answer[64];
	int again_ms = 1, timeout_ms = 5000;
	void *socket = zmq_socket(context, ZMQ_REQ);
	snprintf(endpoint, sizeof endpoint, "ipc://%s/control", directory);
	zmq_setsockopt(socket, ZMQ_RECONNECT_IVL, &again_ms, sizeof again_ms);
	zmq_setsockopt(socket, ZMQ_RCVTIMEO, &timeout_ms, sizeof timeout_ms);
	zmq_connect(socket, endpoint);
	zmq_send(socket, "v", 1, 0);
	int size = zmq_recv(socket, answer, sizeof answer, 0);
	double ms = gz_ns_to_ms(gz_clock_now_ns() - begin_ns);
	close_socket(socket);
	return size > 0 ? ms : -1;
}

/* The number behind @p key in a file of /proc, 0 if it is not there. */
static long read_number(const char *path, const char *key)
{
	char line[256];
	long number = 0;
	FILE *file = fopen(path, "re");
	while (file && fgets(line, sizeof line, file))
		if (strncmp(line, key, strlen(key)) == 0)
			number = atol(line + strlen(key));
	if (file)
		fclose(file);
	return number;
}

static void read_task(pid_t pid, long id, struct task *task)
{
	char path[128];
	unsigned long long run_ns = 0;
	*task = (struct task) { .id = id };
	snprintf(path, sizeof path, "/proc/%d/task/%ld/schedstat", (int)pid, id);
	FILE *file = fopen(path, "re");
	if (file) {
		if (fscanf(file, "%llu", &run_ns) != 1)
			run_ns = 0;
		fclose(file);
	}
	task->cpu_s = 1e-9 * (double)run_ns;
	snprintf(path, sizeof path, "/proc/%d/task/%ld/comm", (int)pid, id);
	file = fopen(path, "re");
	if (file) {
		if (fscanf(file, "%31s", task->name) != 1)
			task->name[0] = '\0';
		fclose(file);
	}
	snprintf(path, sizeof path, "/proc/%d/task/%ld/status", (int)pid, id);
	task->switches = (uint64_t)read_number(path, "voluntary_ctxt_switches:");
}

static void read_usage(pid_t pid, struct usage *usage)
{
	char path[64];
	snprintf(path, sizeof path, "/proc/%d/task", (int)pid);
	*usage = (struct usage) { .time_ns = gz_clock_now_ns() };
	DIR *directory = opendir(path);
	if (!directory)
		return;
	for (struct dirent *entry; (entry = readdir(directory)) && usage->count < TASKS_MAX;) {
		if (entry->d_name[0] != '.')
			read_task(pid, atol(entry->d_name), &usage->task[usage->count++]);
	}
	closedir(directory);
}

/* A thread of the daemon, over a round. */
struct thread_share {
	char name[32];
	double share; /* of a core */
	double wakes; /* for each sample */
};

/* What one round gave. */
struct round {
	double share; /* of a core, all threads of the daemon */
	double bare;  /* the same for a thread that only wakes */
	double wakes; /* and for one that also wakes the readers */
	size_t thread_count;
	struct thread_share thread[TASKS_MAX];
	double p50_ms[READERS_MAX], p99_ms[READERS_MAX], worst_ms[READERS_MAX];
	uint64_t samples, missing; /* all readers of the stream */
	uint64_t frames;           /* all readers of latest: reads that gave a gaze */
	long memory_kib;
	double started_ms;
};

static void take_shares(const struct settings *settings, const struct usage *before,
			const struct usage *after, struct round *round)
{
	double seconds = gz_ns_to_s(after->time_ns - before->time_ns);
	for (size_t i = 0; i < after->count; i++) {
		double cpu_s = after->task[i].cpu_s;
		uint64_t switches = after->task[i].switches;
		for (size_t j = 0; j < before->count; j++) {
			if (before->task[j].id != after->task[i].id)
				continue;
			cpu_s -= before->task[j].cpu_s;
			switches -= before->task[j].switches;
		}
		struct thread_share *thread = &round->thread[round->thread_count++];
		memcpy(thread->name, after->task[i].name, sizeof thread->name);
		thread->share = cpu_s / seconds;
		thread->wakes = (double)switches / seconds / settings->rate_hz;
		round->share += thread->share;
	}
}

/* Threads that wait for the next number of a futex. */
struct sleepers {
	_Atomic uint32_t number;
	atomic_bool quit;
};

static void *sleep_on_number(void *user)
{
	struct sleepers *sleepers = user;
	for (;;) {
		/* Before the look at quit: what is told after it changes this number. */
		const uint32_t number = atomic_load(&sleepers->number);
		if (atomic_load(&sleepers->quit))
			return NULL;
		syscall(SYS_futex, &sleepers->number, FUTEX_WAIT, number, NULL, NULL, 0);
	}
}

static void wake_sleepers(struct sleepers *sleepers)
{
	atomic_fetch_add(&sleepers->number, 1);
	syscall(SYS_futex, &sleepers->number, FUTEX_WAKE, READERS_MAX, NULL, NULL, 0);
}

/* What the machine takes for waking a thread as often as there are samples.
 * @param sleepers  threads that it wakes each time; NULL: none */
static double wake_share(const struct settings *settings, struct sleepers *sleepers)
{
	struct timespec before, after;
	prctl(PR_SET_TIMERSLACK, 1);
	clock_gettime(CLOCK_THREAD_CPUTIME_ID, &before);
	int64_t begin_ns = gz_clock_now_ns();
	int wakes = (int)(settings->seconds * settings->rate_hz);
	for (int i = 1; i <= wakes; i++) {
		gz_clock_sleep_until_ns(begin_ns + i * GZ_NS_PER_S / settings->rate_hz);
		if (sleepers)
			wake_sleepers(sleepers);
	}
	clock_gettime(CLOCK_THREAD_CPUTIME_ID, &after);
	return ((double)(after.tv_sec - before.tv_sec) +
		1e-9 * (double)(after.tv_nsec - before.tv_nsec)) /
	       settings->seconds;
}

/* The same with as many sleepers as there are readers of the stream. */
static double reader_wake_share(const struct settings *settings)
{
	struct sleepers sleepers = { .number = 0 };
	pthread_t threads[READERS_MAX];
	for (int i = 0; i < settings->streams; i++)
		if (pthread_create(&threads[i], NULL, sleep_on_number, &sleepers) != 0)
			abort();
	double share = wake_share(settings, &sleepers);
	atomic_store(&sleepers.quit, true);
	wake_sleepers(&sleepers);
	for (int i = 0; i < settings->streams; i++)
		pthread_join(threads[i], NULL);
	return share;
}

static double percentile(const double *sorted, size_t count, double part)
{
	return sorted[(size_t)(part * (double)(count - 1) + 0.5)];
}

static void take_latency(struct round *round, int number, struct reader *reader)
{
	double *ms = reader->latency_ms;
	if (reader->count == 0)
		return;
	round->samples += reader->count;
	round->missing += reader->last_seq - reader->first_seq + 1 - reader->count;
	qsort(ms, reader->count, sizeof *ms, gz_compare_doubles);
	round->p50_ms[number] = percentile(ms, reader->count, 0.5);
	round->p99_ms[number] = percentile(ms, reader->count, 0.99);
	round->worst_ms[number] = ms[reader->count - 1];
}

static long most_memory_kib(pid_t pid)
{
	char path[64];
	snprintf(path, sizeof path, "/proc/%d/status", (int)pid);
	return read_number(path, "VmHWM:");
}

static void start_readers(struct reader *readers, const struct settings *settings,
			  const char *directory, void *context)
{
	int count = settings->streams + settings->latest;
	for (int i = 0; i < count; i++) {
		bool is_stream = i < settings->streams;
		readers[i] = (struct reader) {
			.settings = settings,
			.context = context,
			.wanted = (size_t)(settings->seconds * settings->rate_hz),
		};
		snprintf(readers[i].directory, sizeof readers[i].directory, "%s", directory);
		readers[i].latency_ms = calloc(readers[i].wanted, sizeof(double));
		void *(*const reads[2][2])(void *) = {
			{ read_latest, read_stream },
			{ read_latest_by_library, read_stream_by_library },
		};
		if (!readers[i].latency_ms ||
		    pthread_create(&readers[i].thread, NULL, reads[settings->library][is_stream],
				   &readers[i]) != 0)
			abort();
	}
}

/* @return whether all samples came */
static bool measure_round(const char *directory, const struct settings *settings,
			  struct round *round)
{
	static struct reader readers[2 * READERS_MAX];
	struct usage before, after;
	bool complete = true;
	*round = (struct round) { 0 };
	void *context = zmq_ctx_new();
	int64_t begin_ns = gz_clock_now_ns();
	pid_t pid = spawn(directory, settings);
	round->started_ms = start_ms(context, directory, begin_ns);
	start_readers(readers, settings, directory, context);
	/* Start-up is not counted: from the end of the warm-up, roughly. */
	gz_clock_sleep_until_ns(gz_clock_now_ns() + GZ_NS_PER_S);
	read_usage(pid, &before);
	gz_clock_sleep_until_ns(before.time_ns +
				(int64_t)((settings->seconds - 0.2) * GZ_NS_PER_S));
	read_usage(pid, &after);
	for (int i = 0; i < settings->streams; i++) {
		pthread_join(readers[i].thread, NULL);
		complete &= readers[i].count == readers[i].wanted;
		take_latency(round, i, &readers[i]);
	}
	take_shares(settings, &before, &after, round);
	round->memory_kib = most_memory_kib(pid);
	kill(pid, SIGTERM);
	waitpid(pid, NULL, 0);
	for (int i = settings->streams; i < settings->streams + settings->latest; i++) {
		pthread_join(readers[i].thread, NULL);
		round->frames += readers[i].count;
	}
	for (int i = 0; i < settings->streams + settings->latest; i++)
		free(readers[i].latency_ms);
	zmq_ctx_term(context);
	round->bare = wake_share(settings, NULL);
	round->wakes = reader_wake_share(settings);
	return complete;
}

/* The median over all rounds of the double at @p offset in a round. */
static double median(const struct round *rounds, int count, size_t offset)
{
	double value[ROUNDS_MAX] = { 0 };
	for (int i = 0; i < count; i++)
		memcpy(&value[i], (const char *)&rounds[i] + offset, sizeof value[i]);
	qsort(value, (size_t)count, sizeof *value, gz_compare_doubles);
	return (value[count / 2] + value[(count - 1) / 2]) / 2;
}

#define MEDIAN(field) median(rounds, count, offsetof(struct round, field))

static const char *verdict(bool met)
{
	return met ? "met" : "missed";
}

static void print_threads(const struct round *rounds, int count)
{
	/* The threads are the same in every round, and listed in the order of their start. */
	for (size_t i = 0; i < rounds[0].thread_count; i++) {
		size_t at = offsetof(struct round, thread) + i * sizeof rounds[0].thread[0];
		double share = median(rounds, count, at + offsetof(struct thread_share, share));
		if (share > 0)
			printf("  thread %-16s %5.2f %% of a core, wakes %.2f times a sample\n",
			       rounds[0].thread[i].name, 100 * share,
			       median(rounds, count, at + offsetof(struct thread_share, wakes)));
	}
}

static void print_cpu(const struct settings *settings, const struct round *rounds, int count)
{
	double ratio[ROUNDS_MAX] = { 0 };
	for (int i = 0; i < count; i++)
		ratio[i] = rounds[i].share / rounds[i].bare;
	qsort(ratio, (size_t)count, sizeof *ratio, gz_compare_doubles);
	double middle = (ratio[count / 2] + ratio[(count - 1) / 2]) / 2;
	printf("gazed at %d Hz, %d readers of '%s', %d of latest, %s: medians of %d rounds\n",
	       settings->rate_hz, settings->streams, settings->topic, settings->latest,
	       settings->library ? "with the client library" : "with sockets of ZeroMQ", count);
	print_threads(rounds, count);
	printf("  whole daemon            %5.2f %% of a core\n", 100 * MEDIAN(share));
	printf("a thread that only wakes  %5.2f %% of a core\n", 100 * MEDIAN(bare));
	printf("one that wakes the stream's readers  %5.2f %% of a core, %.2f times that\n",
	       100 * MEDIAN(wakes), MEDIAN(wakes) / MEDIAN(bare));
	printf("ratio %.2f, in single rounds %.2f to %.2f (target %.1f: %s)\n", middle, ratio[0],
	       ratio[count - 1], CPU_TARGET, verdict(middle <= CPU_TARGET));
}

static void print_latency(const struct settings *settings, const struct round *rounds, int count)
{
	uint64_t samples = 0, missing = 0, frames = 0;
	for (int i = 0; i < count; i++) {
		samples += rounds[i].samples;
		missing += rounds[i].missing;
		frames += rounds[i].frames;
	}
	for (int i = 0; i < settings->streams; i++) {
		size_t reader = (size_t)i * sizeof(double);
		double p99_ms = median(rounds, count, offsetof(struct round, p99_ms) + reader);
		printf("stream reader %d: sample to subscriber p50 %.3f ms, p99 %.3f ms, worst "
		       "%.3f ms (target p99 %.2f ms: %s)\n",
		       i + 1, median(rounds, count, offsetof(struct round, p50_ms) + reader),
		       p99_ms, median(rounds, count, offsetof(struct round, worst_ms) + reader),
		       LATENCY_TARGET_MS, verdict(p99_ms <= LATENCY_TARGET_MS));
	}
	printf("%llu samples read, %llu missing; latest gave a gaze %llu times\n",
	       (unsigned long long)samples, (unsigned long long)missing,
	       (unsigned long long)frames);
}

static int measure_load(const char *directory, const struct settings *settings)
{
	static struct round rounds[ROUNDS_MAX];
	int count = settings->rounds;
	bool complete = true;
	long memory_kib = 0;
	for (int i = 0; i < count; i++) {
		complete &= measure_round(directory, settings, &rounds[i]);
		if (rounds[i].memory_kib > memory_kib)
			memory_kib = rounds[i].memory_kib;
	}
	print_cpu(settings, rounds, count);
	print_latency(settings, rounds, count);
	double started_ms = MEDIAN(started_ms);
	printf("resident memory, most %ld KiB (target %ld KiB: %s)\n", memory_kib,
	       MEMORY_TARGET_KIB, verdict(memory_kib < MEMORY_TARGET_KIB));
	printf("first answer %.1f ms after the start (target %.0f ms: %s)\n", started_ms,
	       START_TARGET_MS, verdict(started_ms < START_TARGET_MS));
	return complete ? EXIT_SUCCESS : EXIT_FAILURE;
}

static void remove_directory(const char *directory)
{
	static const char *const names[] = {
		"stream", "latest", "control", "inlet", "board", "lock"
	};
	char path[128];
	for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
		snprintf(path, sizeof path, "%s/%s", directory, names[i]);
		unlink(path);
	}
	rmdir(directory);
}

int main(int argc, char **argv)
{
	struct settings settings = { 0 };
	struct gz_log log;
	const struct gz_option_binding binding = { options, sizeof options / sizeof *options,
						   &settings, NULL };
	char directory[] = "/tmp/gz_load_XXXXXX";
	gz_log_init(&log, NULL, NULL, NULL);
	if (gz_options_preset(&binding) != GZ_OK ||
	    gz_options_read_arguments(&binding, 1, argc, argv, NULL, &log) != GZ_OK)
		return EXIT_FAILURE;
	if (settings.help) {
		gz_options_print_help(&binding, 1, stdout);
		return EXIT_SUCCESS;
	}
	if (!mkdtemp(directory)) {
		perror("mkdtemp");
		return EXIT_FAILURE;
	}
	int result = measure_load(directory, &settings);
	remove_directory(directory);
	return result;
}
