/* Prints what the gaze daemon costs and how late its messages are: gazed with the simulator, and
 * readers of the stream and of latest in threads of this program. Late is counted from the moment
 * at which the simulated tracker's sample was due at the driver to the moment at which a reader has
 * its message.
 *
 * usage: daemon_load [OPTION]..., see --help */
#include <dirent.h>
#include <pthread.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>
#include <zmq.h>

#include "base/clock.h"
#include "base/log.h"
#include "base/option.h"
#include "base/order.h"
#include "protocol/wire.h"

/* Targets, printed beside the results: part of a core, ms, KiB, ms. */
static const double CPU_TARGET = 0.05;
static const double LATENCY_TARGET_MS = 0.25;
static const long MEMORY_TARGET_KIB = 20 * 1024;
static const double START_TARGET_MS = 100;

/* How often a reader of latest polls, like a renderer at each frame. */
enum { FRAMES_HZ = 60 };

enum { READERS_MAX = 256, TASKS_MAX = 32 };

struct settings {
	double seconds;
	int rate_hz;
	int streams;
	int latest;
	char topic[64];
	bool help;
};

#define AT(field) offsetof(struct settings, field)

static const struct gz_option options[] = {
	{ "seconds", GZ_OPTION_DOUBLE, AT(seconds), 1, 36000, 0, NULL, "10",
	  "how long to measure, s" },
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

static void take(struct reader *reader, const void *bytes, size_t size, int64_t now_ns)
{
	struct gz_gaze gaze;
	if (gz_wire_decode_gaze(bytes, size, &gaze) != GZ_OK)
		return;
	/* Caches, queues and the processor's clock settle first. */
	if (gaze.seq < (uint64_t)reader->settings->rate_hz)
		return;
	if (reader->count == 0)
		reader->first_seq = gaze.seq;
	reader->last_seq = gaze.seq;
	/* The simulator delivers at the moment of exposure: no latency and no skew are set. */
	reader->latency_ms[reader->count++] = gz_ns_to_ms(now_ns - gaze.host_ns);
}

static void *read_stream(void *user)
{
	struct reader *reader = user;
	void *socket = open_socket(reader, "stream", reader->settings->topic);
	char topic[80];
	unsigned char bytes[GZ_WIRE_MESSAGE_SIZE];
	while (reader->count < reader->wanted) {
		int length = zmq_recv(socket, topic, sizeof topic, 0);
		int size = length < 0 ? -1 : zmq_recv(socket, bytes, sizeof bytes, 0);
		int64_t now_ns = gz_clock_now_ns();
		if (size < 0)
			break;
		if (length >= 5 && memcmp(topic, GZ_TOPIC_GAZE, 5) == 0)
			take(reader, bytes, (size_t)size, now_ns);
	}
	close_socket(socket);
	return NULL;
}

static void *read_latest(void *user)
{
	struct reader *reader = user;
	void *socket = open_socket(reader, "latest", "");
	unsigned char bytes[GZ_WIRE_MESSAGE_SIZE];
	int64_t begin_ns = gz_clock_now_ns();
	size_t frames = (size_t)((reader->settings->seconds + 1) * FRAMES_HZ);
	for (size_t i = 1; i <= frames; i++) {
		gz_clock_sleep_until_ns(begin_ns + (int64_t)i * GZ_NS_PER_S / FRAMES_HZ);
		int size = zmq_recv(socket, bytes, sizeof bytes, ZMQ_DONTWAIT);
		if (size > 0 && reader->count < reader->wanted)
			take(reader, bytes, (size_t)size, gz_clock_now_ns());
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

static void print_usage(const struct settings *settings, const struct usage *before,
			const struct usage *after)
{
	double seconds = gz_ns_to_s(after->time_ns - before->time_ns), sum = 0;
	for (size_t i = 0; i < after->count; i++) {
		double cpu_s = after->task[i].cpu_s;
		uint64_t switches = after->task[i].switches;
		for (size_t j = 0; j < before->count; j++) {
			if (before->task[j].id != after->task[i].id)
				continue;
			cpu_s -= before->task[j].cpu_s;
			switches -= before->task[j].switches;
		}
		sum += cpu_s / seconds;
		if (cpu_s > 0)
			printf("  thread %-16s %5.2f %% of a core, wakes %.2f times a sample\n",
			       after->task[i].name, 100 * cpu_s / seconds,
			       (double)switches / seconds / settings->rate_hz);
	}
	printf("gazed at %d Hz, %d readers of '%s', %d of latest: %.2f %% of a core (target %.0f "
	       "%%: %s)\n",
	       settings->rate_hz, settings->streams, settings->topic, settings->latest, 100 * sum,
	       100 * CPU_TARGET, sum < CPU_TARGET ? "met" : "missed");
}

/* What the machine takes for waking a thread as often as there are samples, and nothing else: the
 * floor under the daemon's share, which wakes two. */
static double bare_wake_share(int rate_hz)
{
	struct timespec before, after;
	prctl(PR_SET_TIMERSLACK, 1);
	clock_gettime(CLOCK_THREAD_CPUTIME_ID, &before);
	int64_t begin_ns = gz_clock_now_ns();
	for (int i = 1; i <= rate_hz; i++)
		gz_clock_sleep_until_ns(begin_ns + i * GZ_NS_PER_S / rate_hz);
	clock_gettime(CLOCK_THREAD_CPUTIME_ID, &after);
	return (double)(after.tv_sec - before.tv_sec) +
	       1e-9 * (double)(after.tv_nsec - before.tv_nsec);
}

static double percentile(const double *sorted, size_t count, double part)
{
	return sorted[(size_t)(part * (double)(count - 1) + 0.5)];
}

static void print_reader(int number, struct reader *reader)
{
	double *ms = reader->latency_ms;
	uint64_t gaps = reader->last_seq - reader->first_seq + 1 - reader->count;
	qsort(ms, reader->count, sizeof *ms, gz_compare_doubles);
	double p99_ms = percentile(ms, reader->count, 0.99);
	printf("stream reader %d: %zu samples, %llu missing; sample to subscriber p50 %.3f ms, "
	       "p99 %.3f ms, p99.9 %.3f ms, worst %.3f ms (target p99 %.2f ms: %s)\n",
	       number, reader->count, (unsigned long long)gaps, percentile(ms, reader->count, 0.5),
	       p99_ms, percentile(ms, reader->count, 0.999), ms[reader->count - 1],
	       LATENCY_TARGET_MS, p99_ms < LATENCY_TARGET_MS ? "met" : "missed");
}

static void print_memory(pid_t pid)
{
	char path[64];
	snprintf(path, sizeof path, "/proc/%d/status", (int)pid);
	long now_kib = read_number(path, "VmRSS:"), most_kib = read_number(path, "VmHWM:");
	printf("resident memory %ld KiB, most %ld KiB (target %ld KiB: %s)\n", now_kib, most_kib,
	       MEMORY_TARGET_KIB, most_kib < MEMORY_TARGET_KIB ? "met" : "missed");
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
		if (!readers[i].latency_ms ||
		    pthread_create(&readers[i].thread, NULL, is_stream ? read_stream : read_latest,
				   &readers[i]) != 0)
			abort();
	}
}

static int measure_load(const char *directory, const struct settings *settings)
{
	static struct reader readers[2 * READERS_MAX];
	struct usage before, after;
	bool complete = true;
	void *context = zmq_ctx_new();
	int64_t begin_ns = gz_clock_now_ns();
	pid_t pid = spawn(directory, settings);
	double started_ms = start_ms(context, directory, begin_ns);
	start_readers(readers, settings, directory, context);
	/* Start-up is not counted: from the end of the warm-up, roughly. */
	gz_clock_sleep_until_ns(gz_clock_now_ns() + GZ_NS_PER_S);
	read_usage(pid, &before);
	for (int i = 0; i < settings->streams; i++) {
		pthread_join(readers[i].thread, NULL);
		complete &= readers[i].count == readers[i].wanted;
	}
	read_usage(pid, &after);
	print_memory(pid);
	kill(pid, SIGTERM);
	waitpid(pid, NULL, 0);
	printf("first answer %.1f ms after the start (target %.0f ms: %s)\n", started_ms,
	       START_TARGET_MS, started_ms < START_TARGET_MS ? "met" : "missed");
	print_usage(settings, &before, &after);
	printf("a thread that only wakes %d times a second: %.2f %% of a core here and now\n",
	       settings->rate_hz, 100 * bare_wake_share(settings->rate_hz));
	for (int i = 0; i < settings->streams + settings->latest; i++) {
		if (i >= settings->streams)
			pthread_join(readers[i].thread, NULL);
		else if (readers[i].count > 0)
			print_reader(i + 1, &readers[i]);
		free(readers[i].latency_ms);
	}
	zmq_ctx_term(context);
	return complete ? EXIT_SUCCESS : EXIT_FAILURE;
}

static void remove_directory(const char *directory)
{
	static const char *const names[] = { "stream", "latest", "control", "inlet", "lock" };
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
