/* gazed: creates the daemon's parts, runs them, and destroys them in reverse order. */
#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/signalfd.h>
#include <unistd.h>
#include <zmq.h>

#include "daemon/config.h"
#include "daemon/handed_sockets.h"
#include "daemon/lsl/lsl_outlet.h"
#include "daemon/process.h"
#include "daemon/publisher.h"
#include "daemon/recorder.h"
#include "daemon/requests.h"
#include "daemon/service.h"

#define GZ_LOG_MODULE "gazed"

/* zmq.h hides this option of libzmq 4.3. With it off, a message is copied: else the smallest one
 * keeps the 8 KiB with which it was received. Older versions have no such option. */
#ifndef ZMQ_ZERO_COPY_RECV
#define ZMQ_ZERO_COPY_RECV 10
#endif

/* Everything that lives as long as the daemon. */
struct daemon {
	struct gz_config config;
	struct gz_log log;
	char directory[GZ_PATH_SIZE];
	int lock_fd;
	int signal_fd;
	struct gz_notify notify;
	struct gz_handed_sockets handed;
	void *context;
	struct gz_network network;
	struct gz_publisher *publisher;
	struct gz_recorder *recorder;
	struct gz_inlet_counts inlet_counts;
	struct gz_pointer_feed *pointer;
	struct gz_lsl_outlet *lsl; /* NULL: switched off */
	struct gz_requests *requests;
	struct gz_service *service;
};

/* The signals that end the daemon are read from a signalfd. They are blocked before any thread
 * starts, so that every thread inherits that. SIGXFSZ and SIGPIPE are ignored: a file beyond the
 * size limit and a reader that left are reported as errors of write(). */
static enum gz_result block_ending_signals(struct daemon *daemon)
{
	sigset_t ending;
	sigemptyset(&ending);
	sigaddset(&ending, SIGTERM);
	sigaddset(&ending, SIGINT);
	sigaddset(&ending, SIGHUP);
	signal(SIGXFSZ, SIG_IGN);
	signal(SIGPIPE, SIG_IGN);
	sigprocmask(SIG_BLOCK, &ending, NULL);
	daemon->signal_fd = signalfd(-1, &ending, SFD_CLOEXEC | SFD_NONBLOCK);
	if (daemon->signal_fd >= 0)
		return GZ_OK;
	gz_err(&daemon->log, "cannot wait for signals: %s", strerror(errno));
	return GZ_ERR_IO;
}

static enum gz_result take_runtime_directory(struct daemon *daemon)
{
	enum gz_result result = gz_runtime_directory(daemon->directory, sizeof daemon->directory);
	if (result != GZ_OK) {
		gz_err(&daemon->log, "the path of the runtime directory is too long; set "
				     "GAZECAST_RUNTIME_DIR to a shorter one");
		return result;
	}
	result = gz_runtime_directory_prepare(daemon->directory, &daemon->log);
	if (result == GZ_OK)
		result = gz_lock_take(daemon->directory, &daemon->log, &daemon->lock_fd);
	return result;
}

static enum gz_result open_daemon_sockets(struct daemon *daemon)
{
	daemon->context = zmq_ctx_new();
	if (!daemon->context)
		return GZ_ERR_NO_MEM;
	zmq_ctx_set(daemon->context, ZMQ_ZERO_COPY_RECV, 0);
	daemon->network = (struct gz_network) {
		.config = &daemon->config,
		.directory = daemon->directory,
		.handed = &daemon->handed,
		.context = daemon->context,
		.log = &daemon->log,
	};
	enum gz_result result = gz_network_open(&daemon->network);
	if (result == GZ_OK)
		result = gz_publisher_create(&daemon->network, &daemon->publisher);
	if (result == GZ_OK)
		result = gz_recorder_create(&daemon->log, &daemon->recorder);
	if (result == GZ_OK)
		result = gz_pointer_feed_create(&daemon->pointer);
	if (result != GZ_OK)
		return result;
	const struct gz_requests_parts parts = {
		.config = &daemon->config,
		.context = daemon->context,
		.directory = daemon->directory,
		.network = &daemon->network,
		.publisher = daemon->publisher,
		.recorder = daemon->recorder,
		.inlet_counts = &daemon->inlet_counts,
		.pointer = daemon->pointer,
		.log = &daemon->log,
	};
	result = gz_requests_create(&parts, &daemon->requests);
	gz_handed_sockets_close(&daemon->handed, &daemon->log);
	return result == GZ_OK ? gz_guard_start(daemon->network.guard) : result;
}

/* --record: begin the recording before the first sample. */
static enum gz_result record_from_start(struct daemon *daemon)
{
	char directory[GZ_PATH_SIZE], path[GZ_PATH_SIZE], message[GZ_PATH_SIZE + 256];
	int fd;
	if (!daemon->config.record[0])
		return GZ_OK;
	enum gz_result result = gz_config_recording_directory(&daemon->config, &daemon->log,
							      directory, sizeof directory);
	if (result != GZ_OK)
		return result;
	result = gz_recording_create(directory, daemon->config.record, &fd, path, message,
				     sizeof message);
	if (result != GZ_OK) {
		gz_err(&daemon->log, "--record: %s", message);
		return result;
	}
	return gz_service_record(daemon->service, fd, path);
}

static enum gz_result start_daemon(struct daemon *daemon)
{
	gz_notify_open(&daemon->notify, &daemon->log);
	gz_handed_sockets_take_over(&daemon->handed, &daemon->log);
	gz_open_files_allow(&daemon->log);
	enum gz_result result = gz_privileges_drop(daemon->config.user, &daemon->log);
	if (result == GZ_OK)
		result = block_ending_signals(daemon);
	if (result == GZ_OK)
		result = take_runtime_directory(daemon);
	if (result == GZ_OK)
		result = open_daemon_sockets(daemon);
	if (result == GZ_OK && daemon->config.lsl)
		result = gz_lsl_outlet_create(daemon->config.lsl_library, daemon->config.lsl_name,
					      &daemon->log, &daemon->lsl);
	if (result != GZ_OK)
		return result;
	const struct gz_service_parts parts = {
		.config = &daemon->config,
		.context = daemon->context,
		.publisher = daemon->publisher,
		.recorder = daemon->recorder,
		.inlet_counts = &daemon->inlet_counts,
		.pointer = daemon->pointer,
		.lsl = daemon->lsl,
		.guard = daemon->network.guard,
		.notify = &daemon->notify,
		.log = &daemon->log,
	};
	result = gz_service_create(&parts, &daemon->service);
	if (result == GZ_OK)
		result = record_from_start(daemon);
	if (result == GZ_OK)
		result = gz_service_start(daemon->service);
	return result;
}

static void say_hello(const struct daemon *daemon)
{
	const int port = gz_publisher_port(daemon->publisher);
	const char *control = daemon->config.control_endpoint, *colon = strrchr(control, ':');
	gz_privileges_advise(&daemon->log);
	gz_info(&daemon->log, "gazed %s with %s, stream at ipc://%s/stream", GAZECAST_VERSION,
		daemon->config.driver, daemon->directory);
	if (port > 0)
		gz_info(&daemon->log, "%s: control at %.*s:%d, stream at tcp://%s:%d",
			daemon->config.tcp == GZ_TCP_CURVE ? "for clients with a key"
							   : "for Pupil clients",
			colon ? (int)(colon - control) : 0, control,
			gz_requests_port(daemon->requests), daemon->config.address, port);
}

static void stop_daemon(struct daemon *daemon)
{
	gz_service_destroy(&daemon->service);
	gz_recorder_destroy(&daemon->recorder);
	/* After the recording is complete, because this calls a library of others. */
	gz_lsl_outlet_destroy(&daemon->lsl);
	gz_requests_destroy(&daemon->requests);
	gz_pointer_feed_destroy(&daemon->pointer);
	gz_publisher_destroy(&daemon->publisher);
	gz_network_close(&daemon->network);
	if (daemon->context)
		zmq_ctx_term(daemon->context);
	gz_notify_close(&daemon->notify);
	if (daemon->signal_fd >= 0)
		close(daemon->signal_fd);
	if (daemon->lock_fd >= 0)
		close(daemon->lock_fd);
}

static enum gz_result run_daemon(struct daemon *daemon)
{
	enum gz_result result = start_daemon(daemon);
	if (result == GZ_OK) {
		say_hello(daemon);
		result = gz_requests_run(daemon->requests, daemon->signal_fd);
		gz_notify_stopping(&daemon->notify);
		gz_requests_quit_service(daemon->requests);
	}
	stop_daemon(daemon);
	return result;
}

/* If a descriptor from 0 to 2 is closed at the start, a socket or a recording would get its number,
 * and log messages would go into it. */
static bool claim_standard_streams(void)
{
	int fd;
	do
		fd = open("/dev/null", O_RDWR);
	while (fd >= 0 && fd <= STDERR_FILENO);
	if (fd < 0)
		return false;
	close(fd);
	return true;
}

/* Check that everything printed has reached its file. */
static enum gz_result finish_printing(const struct gz_log *log)
{
	if (fflush(stdout) == 0 && !ferror(stdout))
		return GZ_OK;
	gz_err(log, "cannot write to standard output; is the disk full?");
	return GZ_ERR_IO;
}

int main(int argc, char **argv)
{
	if (!claim_standard_streams())
		return EXIT_FAILURE;
	struct daemon *daemon = calloc(1, sizeof *daemon);
	if (!daemon)
		return EXIT_FAILURE;
	daemon->lock_fd = -1;
	daemon->signal_fd = -1;
	daemon->notify.fd = -1;
	gz_log_init(&daemon->log, NULL, NULL, NULL);
	enum gz_result result = gz_config_read(argc, argv, &daemon->log, &daemon->config);
	if (result == GZ_OK && daemon->config.help)
		gz_config_print_help(&daemon->config, stdout);
	else if (result == GZ_OK && daemon->config.version)
		puts("gazed " GAZECAST_VERSION);
	else if (result == GZ_OK && daemon->config.print_config)
		gz_config_print_file(&daemon->config, stdout);
	else if (result == GZ_OK)
		result = run_daemon(daemon);
	if (result == GZ_OK)
		result = finish_printing(&daemon->log);
	free(daemon);
	return result == GZ_OK ? EXIT_SUCCESS : EXIT_FAILURE;
}
