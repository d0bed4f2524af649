/* Prints what the gaze daemon costs and how late its messages are: gazed with the simulator at
 * 1200 Hz and two readers of the stream, of everything on it or of one topic. Late is counted from
 * the moment at which the simulated tracker's sample was due at the driver to the moment at which a
 * reader has its message.
 *
 * usage: gaze_latency [SECONDS [TOPIC]] */
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
#include "protocol/wire.h"

enum { READERS = 2, RATE_HZ = 1200 };

/* Left out at the start: caches, queues and the processor's clock settle. */
enum { WARM_UP = RATE_HZ };

/* Targets, printed beside the results: part of a core, and ms. */
static const double CPU_TARGET = 0.05;
static const double LATENCY_TARGET_MS = 0.3;

struct reader {
	pthread_t thread;
	const char *directory, *topic;
	size_t wanted; /* gaze messages, after the warm-up */
	size_t count;
	double *latency_ms;
	uint64_t first_seq, last_seq;
	uint64_t messages;
};

static void *open_socket(void *context, const char *directory, const char *topic)
{
	char endpoint[256];
	int unlimited = 0, timeout_ms = 5000, again_ms = 10;
	void *socket = zmq_socket(context, ZMQ_SUB);
	snprintf(endpoint, sizeof endpoint, "ipc://%s/stream", directory);
	zmq_setsockopt(socket, ZMQ_RCVHWM, &unlimited, sizeof unlimited);
	zmq_setsockopt(socket, ZMQ_RCVTIMEO, &timeout_ms, sizeof timeout_ms);
	zmq_setsockopt(socket, ZMQ_RECONNECT_IVL, &again_ms, sizeof again_ms);
	zmq_setsockopt(socket, ZMQ_SUBSCRIBE, topic, strlen(topic));
	zmq_connect(socket, endpoint);
	return socket;
}

static void take(struct reader *reader, size_t seen, const void *bytes, size_t size, int64_t now_ns)
{
	struct gz_gaze gaze;
	if (gz_wire_decode_gaze(bytes, size, &gaze) != GZ_OK || seen < WARM_UP)
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
	void *context = zmq_ctx_new();
	void *socket = open_socket(context, reader->directory, reader->topic);
	char topic[80];
	unsigned char bytes[GZ_WIRE_MESSAGE_SIZE];
	int linger = 0;
	size_t seen = 0;
	while (reader->count < reader->wanted) {
		int length = zmq_recv(socket, topic, sizeof topic, 0);
		int size = length < 0 ? -1 : zmq_recv(socket, bytes, sizeof bytes, 0);
		int64_t now_ns = gz_clock_now_ns();
		if (size < 0)
			break;
		reader->messages++;
		if (length >= 5 && memcmp(topic, GZ_TOPIC_GAZE, 5) == 0)
			take(reader, seen++, bytes, (size_t)size, now_ns);
	}
	zmq_setsockopt(socket, ZMQ_LINGER, &linger, sizeof linger);
	zmq_close(socket);
	zmq_ctx_term(context);
	return NULL;
}

static pid_t spawn(const char *directory)
{
	setenv("GAZECAST_RUNTIME_DIR", directory, 1);
	setenv("GZ_LOG", "*:warn", 1);
	pid_t pid = fork();
	if (pid == 0) {
		execl(GAZED_PROGRAM, "gazed", "--config", "/dev/null", "--tcp", "off", "--driver",
		      "sim", "--sim.rate_hz", "1200", "--sim.latency_ms", "0",
		      "--sim.latency_jitter_ms", "0", "--sim.clock_skew_ppm", "0", "--wait-readers",
		      "2", (char *)NULL);
		_exit(127);
	}
	return pid;
}

static double cpu_seconds(pid_t pid)
{
	clockid_t clock;
	struct timespec t;
	if (clock_getcpuclockid(pid, &clock) != 0 || clock_gettime(clock, &t) != 0)
		return 0;
	return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* What the machine takes for waking a thread as often as there are samples, and nothing else: the
 * floor under the daemon's share, which wakes two. */
static double bare_wake_share(void)
{
	enum { WAKES = RATE_HZ };
	struct timespec before, after;
	prctl(PR_SET_TIMERSLACK, 1);
	clock_gettime(CLOCK_THREAD_CPUTIME_ID, &before);
	int64_t begin_ns = gz_clock_now_ns();
	for (int i = 1; i <= WAKES; i++)
		gz_clock_sleep_until_ns(begin_ns + i * GZ_NS_PER_S / RATE_HZ);
	clock_gettime(CLOCK_THREAD_CPUTIME_ID, &after);
	return (double)(after.tv_sec - before.tv_sec) +
	       1e-9 * (double)(after.tv_nsec - before.tv_nsec);
}

static int compare(const void *a, const void *b)
{
	double x = *(const double *)a, y = *(const double *)b;
	return (x > y) - (x < y);
}

static double percentile(const double *sorted, size_t count, double part)
{
	return sorted[(size_t)(part * (double)(count - 1) + 0.5)];
}

static void print_reader(int number, struct reader *reader)
{
	double *ms = reader->latency_ms;
	uint64_t gaps = reader->last_seq - reader->first_seq + 1 - reader->count;
	qsort(ms, reader->count, sizeof *ms, compare);
	double p99_ms = percentile(ms, reader->count, 0.99);
	printf("reader %d: %zu samples, %llu missing; sample to subscriber p50 %.3f ms, "
	       "p99 %.3f ms, p99.9 %.3f ms, worst %.3f ms (target p99 %.2f ms: %s)\n",
	       number, reader->count, (unsigned long long)gaps, percentile(ms, reader->count, 0.5),
	       p99_ms, percentile(ms, reader->count, 0.999), ms[reader->count - 1],
	       LATENCY_TARGET_MS, p99_ms < LATENCY_TARGET_MS ? "met" : "missed");
}

static int measure(const char *directory, double seconds, const char *topic)
{
	struct reader readers[READERS];
	bool complete = true;
	pid_t pid = spawn(directory);
	for (int i = 0; i < READERS; i++) {
		readers[i] = (struct reader) { .directory = directory,
					       .topic = topic,
					       .wanted = (size_t)(seconds * RATE_HZ) };
		readers[i].latency_ms = calloc(readers[i].wanted, sizeof(double));
		if (!readers[i].latency_ms ||
		    pthread_create(&readers[i].thread, NULL, read_stream, &readers[i]) != 0)
			abort();
	}
	/* Start-up is not counted: from the end of the warm-up, roughly. */
	gz_clock_sleep_until_ns(gz_clock_now_ns() + GZ_NS_PER_S);
	double cpu_s = cpu_seconds(pid), begin_s = gz_ns_to_s(gz_clock_now_ns());
	for (int i = 0; i < READERS; i++) {
		pthread_join(readers[i].thread, NULL);
		complete &= readers[i].count == readers[i].wanted;
	}
	double part = (cpu_seconds(pid) - cpu_s) / (gz_ns_to_s(gz_clock_now_ns()) - begin_s);
	kill(pid, SIGTERM);
	waitpid(pid, NULL, 0);
	printf("gazed at %d Hz, %d readers of '%s': %.2f %% of a core (target %.0f %%: %s)\n",
	       RATE_HZ, READERS, topic, 100 * part, 100 * CPU_TARGET,
	       part < CPU_TARGET ? "met" : "missed");
	printf("a thread that only wakes %d times a second: %.2f %% of a core here and now\n",
	       RATE_HZ, 100 * bare_wake_share());
	for (int i = 0; i < READERS; i++) {
		if (readers[i].count > 0)
			print_reader(i + 1, &readers[i]);
		free(readers[i].latency_ms);
	}
	return complete ? EXIT_SUCCESS : EXIT_FAILURE;
}

int main(int argc, char **argv)
{
	double seconds = argc > 1 ? atof(argv[1]) : 10;
	char directory[] = "/tmp/gz_latency_XXXXXX", path[64];
	if (!(seconds >= 1 && seconds <= 3600) || !mkdtemp(directory)) {
		fputs("usage: gaze_latency [SECONDS [TOPIC]], 1 to 3600 s\n", stderr);
		return EXIT_FAILURE;
	}
	int result = measure(directory, seconds, argc > 2 ? argv[2] : "");
	static const char *const names[] = { "stream", "latest", "control", "inlet", "lock" };
	for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
		snprintf(path, sizeof path, "%s/%s", directory, names[i]);
		unlink(path);
	}
	rmdir(directory);
	return result;
}
