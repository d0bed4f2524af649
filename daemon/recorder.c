#include "daemon/recorder.h"

#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <pthread.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/eventfd.h>
#include <time.h>
#include <unistd.h>

#include "base/clock.h"
#include "daemon/disk_sync.h"
#include "protocol/gaze.h"
#include "protocol/gaze_log.h"

#define GZ_LOG_MODULE "recorder"

#define SUFFIX ".gzl"

/* Longest name, characters. */
enum { NAME_MAX_LENGTH = 64 };

/* Recordings begun within the same second are numbered. Chosen: more do not occur. */
enum { NUMBERS = 100 };

bool gz_recording_name_valid(const char *name)
{
	static const char allowed[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz"
				      "0123456789._-";
	size_t length = strlen(name);
	return length >= 1 && length <= NAME_MAX_LENGTH && strspn(name, allowed) == length;
}

static bool ends_in_suffix(const char *name)
{
	size_t length = strlen(name), suffix = strlen(SUFFIX);
	return length > suffix && strcmp(name + length - suffix, SUFFIX) == 0;
}

static enum gz_result create_recording_file(const char *directory, const char *name, int *out_fd,
					    char *out_path, char *message, size_t message_size)
{
	char path[GZ_PATH_SIZE];
	int length = snprintf(path, sizeof path, "%s/%s%s", directory, name,
			      ends_in_suffix(name) ? "" : SUFFIX);
	if (length < 0 || (size_t)length >= sizeof path) {
		snprintf(message, message_size,
			 "%s: the path is too long; choose a shorter name or directory", directory);
		return GZ_ERR_FULL;
	}
	int fd = open(path, O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0600);
	if (fd >= 0) {
		*out_fd = fd;
		memcpy(out_path, path, sizeof path);
		return GZ_OK;
	}
	if (errno == EEXIST) {
		snprintf(message, message_size, "%s exists; choose another name", path);
		return GZ_ERR_BUSY;
	}
	snprintf(message, message_size, "cannot create %s: %s; see recording.directory", path,
		 strerror(errno));
	return errno == EACCES || errno == EPERM ? GZ_ERR_ACCESS : GZ_ERR_IO;
}

static void name_recording_by_time(int number, char *name, size_t size)
{
	char text[32];
	time_t now = time(NULL);
	struct tm utc;
	gmtime_r(&now, &utc);
	strftime(text, sizeof text, "gaze-%Y%m%dT%H%M%SZ", &utc);
	if (number == 0)
		snprintf(name, size, "%s", text);
	else
		snprintf(name, size, "%s-%d", text, number + 1);
}

enum gz_result gz_recording_create(const char *directory, const char *name, int *out_fd,
				   char *out_path, char *message, size_t message_size)
{
	if (name[0] && !gz_recording_name_valid(name)) {
		snprintf(
			message, message_size,
			"this is not a valid name for a recording; allowed: 1 to %d of A-Z a-z 0-9 "
			". _ -",
			NAME_MAX_LENGTH);
		return GZ_ERR_INVAL;
	}
	if (name[0])
		return create_recording_file(directory, name, out_fd, out_path, message,
					     message_size);
	enum gz_result result = GZ_ERR_BUSY;
	for (int i = 0; i < NUMBERS && result == GZ_ERR_BUSY; i++) {
		char chosen[NAME_MAX_LENGTH];
		name_recording_by_time(i, chosen, sizeof chosen);
		result = create_recording_file(directory, chosen, out_fd, out_path, message,
					       message_size);
	}
	return result;
}

struct gz_ring {
	size_t mask;
	struct gz_ring_slot *slots;
	/* Both only count up. Each is written by one thread only, on a cache line of its own. */
	_Alignas(64) atomic_size_t pushed;
	_Alignas(64) atomic_size_t popped;
};

enum gz_result gz_ring_create(size_t capacity, struct gz_ring **out_ring)
{
	if (capacity < 2 || (capacity & (capacity - 1)) != 0)
		return GZ_ERR_INVAL;
	struct gz_ring *ring = aligned_alloc(64, sizeof *ring);
	if (!ring)
		return GZ_ERR_NO_MEM;
	ring->mask = capacity - 1;
	ring->slots = calloc(capacity, sizeof *ring->slots);
	atomic_init(&ring->pushed, 0);
	atomic_init(&ring->popped, 0);
	if (!ring->slots) {
		free(ring);
		return GZ_ERR_NO_MEM;
	}
	*out_ring = ring;
	return GZ_OK;
}

size_t gz_ring_room(const struct gz_ring *ring)
{
	size_t pushed = atomic_load_explicit(&ring->pushed, memory_order_relaxed);
	size_t popped = atomic_load_explicit(&ring->popped, memory_order_acquire);
	return ring->mask + 1 - (pushed - popped);
}

/* Copy only the fields that the record's kind fills: most records are samples, and the text is the
 * larger part. */
static void copy_record(struct gz_gaze_log_record *to, const struct gz_gaze_log_record *from)
{
	if (from->kind != GZ_GAZE_LOG_SAMPLE) {
		*to = *from;
		return;
	}
	to->kind = from->kind;
	to->sample = from->sample;
}

bool gz_ring_push(struct gz_ring *ring, uint32_t session, const struct gz_gaze_log_record *record)
{
	if (gz_ring_room(ring) == 0)
		return false;
	size_t pushed = atomic_load_explicit(&ring->pushed, memory_order_relaxed);
	struct gz_ring_slot *slot = &ring->slots[pushed & ring->mask];
	slot->session = session;
	copy_record(&slot->record, record);
	atomic_store_explicit(&ring->pushed, pushed + 1, memory_order_release);
	return true;
}

const struct gz_ring_slot *gz_ring_front(struct gz_ring *ring)
{
	size_t popped = atomic_load_explicit(&ring->popped, memory_order_relaxed);
	size_t pushed = atomic_load_explicit(&ring->pushed, memory_order_acquire);
	return popped == pushed ? NULL : &ring->slots[popped & ring->mask];
}

void gz_ring_pop(struct gz_ring *ring)
{
	size_t popped = atomic_load_explicit(&ring->popped, memory_order_relaxed);
	atomic_store_explicit(&ring->popped, popped + 1, memory_order_release);
}

void gz_ring_destroy(struct gz_ring **ring)
{
	if (!ring || !*ring)
		return;
	free((*ring)->slots);
	free(*ring);
	*ring = NULL;
}

/* The phase decides which thread may write the shared fields of a recording: the pushing thread in
 * IDLE and FAILED, the recorder's thread in the others. */
enum phase {
	PHASE_IDLE,
	PHASE_RUNNING,
	PHASE_FINISHING,
	PHASE_FAILED,
};

struct gz_recorder {
	const struct gz_log *log;
	struct gz_ring *ring;
	pthread_t thread;
	bool has_thread;
	int wake_fd;  /* eventfd: a recording has begun or shall end, or the thread shall quit */
	int event_fd; /* eventfd for others: the phase has changed */
	atomic_int phase;
	atomic_bool quit;
	atomic_uint_fast64_t samples;

	/* Shared, see enum phase. */
	uint32_t session; /* number of the recording */
	int fd;
	char path[GZ_PATH_SIZE];
	struct gz_gaze_log_header header;

	/* Guards only error, which is written and read once per recording. */
	pthread_mutex_t error_mutex;
	char error[GZ_REASON_SIZE];

	/* The pushing thread's. */
	uint64_t missing; /* samples that found the ring full since the last record */
	struct gz_ratelimit complaints;

	/* The recorder's thread's. */
	struct gz_gaze_log_writer writer;
	struct gz_disk_sync *disk_sync;
	int64_t next_sync_ns;
	bool has_synced; /* the file's name is in the directory on the disk, or soon will be */
};

static void signal_event(int fd)
{
	uint64_t one = 1;
	ssize_t n = write(fd, &one, sizeof one);
	(void)n; /* fails only if the event is signalled already */
}

static enum phase phase_of(const struct gz_recorder *recorder)
{
	return (enum phase)atomic_load_explicit(&recorder->phase, memory_order_acquire);
}

static void set_phase(struct gz_recorder *recorder, enum phase phase)
{
	atomic_store_explicit(&recorder->phase, phase, memory_order_release);
	signal_event(recorder->event_fd);
}

static void set_error(struct gz_recorder *recorder, const char *text)
{
	pthread_mutex_lock(&recorder->error_mutex);
	snprintf(recorder->error, sizeof recorder->error, "%s", text);
	pthread_mutex_unlock(&recorder->error_mutex);
}

/* End a recording that cannot continue; what is in the file stays. */
static void fail_recording(struct gz_recorder *recorder, int error)
{
	char text[GZ_REASON_SIZE];
	const char *remedy = error == ENOSPC || error == EDQUOT || error == EFBIG
				     ? "free some space and start a new recording"
				     : "check the disk and start a new recording";
	snprintf(text, sizeof text, "%s; %s", strerror(error), remedy);
	gz_err(recorder->log, "%s: recording stopped after %llu samples: %s", recorder->path,
	       (unsigned long long)recorder->writer.samples, text);
	(void)gz_disk_sync_wait(recorder->disk_sync); /* the file is in use until then */
	/* A file without even its header is useless. */
	if (recorder->writer.size == 0)
		unlink(recorder->path);
	close(recorder->fd);
	atomic_store(&recorder->samples, recorder->writer.samples);
	set_error(recorder, text);
	set_phase(recorder, PHASE_FAILED);
}

static enum gz_result open_recording(struct gz_recorder *recorder)
{
	enum gz_result result =
		gz_gaze_log_writer_begin(&recorder->writer, recorder->fd, &recorder->header);
	if (result == GZ_OK)
		result = gz_gaze_log_writer_flush(&recorder->writer);
	recorder->next_sync_ns = gz_clock_now_ns();
	recorder->has_synced = false;
	return result;
}

/* Write this recording's records from the ring into the file, and drop those of an earlier
 * recording. At most one ring's worth at a time: with a source as fast as this loop it would never
 * end, and the samples must be counted and synced now and then. */
static enum gz_result drain_ring(struct gz_recorder *recorder)
{
	const struct gz_ring_slot *slot;
	enum gz_result result = GZ_OK;
	for (int i = 0; i < GZ_RECORDER_RING && result == GZ_OK; i++) {
		slot = gz_ring_front(recorder->ring);
		if (!slot)
			break;
		if (slot->session == recorder->session)
			result = gz_gaze_log_writer_add(&recorder->writer, &slot->record);
		gz_ring_pop(recorder->ring);
	}
	if (result == GZ_OK)
		result = gz_gaze_log_writer_flush(&recorder->writer);
	atomic_store_explicit(&recorder->samples, recorder->writer.samples, memory_order_relaxed);
	return result;
}

static void directory_of(const char *path, char out_directory[GZ_PATH_SIZE])
{
	snprintf(out_directory, GZ_PATH_SIZE, "%s", path);
	char *slash = strrchr(out_directory, '/');
	if (slash)
		slash[slash == out_directory] = '\0';
	else
		snprintf(out_directory, GZ_PATH_SIZE, ".");
}

/* Have the file synced beside this thread, which goes on writing; the first time with its name in
 * the directory. A disk that needs longer than the interval is asked again once it is done. */
static enum gz_result request_sync(struct gz_recorder *recorder)
{
	char directory[GZ_PATH_SIZE];
	directory_of(recorder->path, directory);
	enum gz_result result = gz_disk_sync_request(recorder->disk_sync, recorder->fd,
						     recorder->has_synced ? NULL : directory);
	if (result == GZ_ERR_BUSY)
		return GZ_OK;
	recorder->has_synced = true;
	recorder->next_sync_ns = gz_clock_now_ns() + GZ_RECORDER_SYNC_MS * GZ_NS_PER_MS;
	return result;
}

/* Sync all of the file, and wait for it. */
static enum gz_result sync_whole_file(struct gz_recorder *recorder)
{
	enum gz_result result = gz_disk_sync_wait(recorder->disk_sync);
	if (result == GZ_OK)
		result = request_sync(recorder);
	if (result == GZ_OK)
		result = gz_disk_sync_wait(recorder->disk_sync);
	return result;
}

static enum gz_result finish_recording(struct gz_recorder *recorder)
{
	/* Nothing is pushed any more, so one ring's worth is everything. */
	enum gz_result result = drain_ring(recorder);
	if (result == GZ_OK)
		result = gz_gaze_log_writer_end(&recorder->writer);
	if (result == GZ_OK)
		result = sync_whole_file(recorder);
	if (result != GZ_OK)
		return result;
	close(recorder->fd);
	atomic_store(&recorder->samples, recorder->writer.samples);
	gz_info(recorder->log, "%s: %llu samples recorded", recorder->path,
		(unsigned long long)recorder->writer.samples);
	set_phase(recorder, PHASE_IDLE);
	return GZ_OK;
}

static void wait_for_recording(struct gz_recorder *recorder, int timeout_ms)
{
	struct pollfd wake = { .fd = recorder->wake_fd, .events = POLLIN };
	uint64_t count;
	if (poll(&wake, 1, timeout_ms) > 0 && read(recorder->wake_fd, &count, sizeof count) < 0)
		return; /* the event was already consumed */
}

/* Write one recording, from its header to its end. */
static void write_recording(struct gz_recorder *recorder)
{
	enum gz_result result = open_recording(recorder);
	while (result == GZ_OK && phase_of(recorder) == PHASE_RUNNING) {
		wait_for_recording(recorder, GZ_RECORDER_DRAIN_MS);
		result = drain_ring(recorder);
		if (result == GZ_OK && gz_clock_now_ns() >= recorder->next_sync_ns)
			result = request_sync(recorder);
	}
	if (result == GZ_OK)
		result = finish_recording(recorder);
	if (result != GZ_OK)
		fail_recording(recorder, result == GZ_ERR_IO ? errno : EINVAL);
}

static void *recorder_run(void *user)
{
	struct gz_recorder *recorder = user;
	for (;;) {
		enum phase phase = phase_of(recorder);
		if (phase == PHASE_RUNNING || phase == PHASE_FINISHING)
			write_recording(recorder);
		else if (atomic_load(&recorder->quit))
			return NULL;
		else
			wait_for_recording(recorder, -1);
	}
}

enum gz_result gz_recorder_create(const struct gz_log *log, struct gz_recorder **out_recorder)
{
	struct gz_recorder *recorder = calloc(1, sizeof *recorder);
	if (!recorder)
		return GZ_ERR_NO_MEM;
	recorder->log = log;
	pthread_mutex_init(&recorder->error_mutex, NULL);
	recorder->wake_fd = eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
	recorder->event_fd = eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
	enum gz_result result = gz_ring_create(GZ_RECORDER_RING, &recorder->ring);
	if (result == GZ_OK)
		result = gz_disk_sync_create(log, &recorder->disk_sync);
	if (result == GZ_OK && (recorder->wake_fd < 0 || recorder->event_fd < 0))
		result = GZ_ERR_IO;
	if (result == GZ_OK && pthread_create(&recorder->thread, NULL, recorder_run, recorder) != 0)
		result = GZ_ERR_NO_MEM;
	if (result != GZ_OK) {
		gz_err(log, "cannot start the recorder: %s", gz_result_text(result));
		gz_recorder_destroy(&recorder);
		return result;
	}
	recorder->has_thread = true;
	*out_recorder = recorder;
	return GZ_OK;
}

int gz_recorder_event_fd(const struct gz_recorder *recorder)
{
	return recorder->event_fd;
}

void gz_recorder_get_status(const struct gz_recorder *recorder, struct gz_recorder_status *out)
{
	enum phase phase = phase_of(recorder);
	*out = (struct gz_recorder_status) {
		.state = phase == PHASE_IDLE     ? GZ_RECORDING_OFF
			 : phase == PHASE_FAILED ? GZ_RECORDING_FAILED
						 : GZ_RECORDING_ON,
		.finishing = phase == PHASE_FINISHING,
		.samples = atomic_load(&recorder->samples),
	};
	if (phase != PHASE_FAILED)
		return;
	struct gz_recorder *writable = (struct gz_recorder *)recorder;
	pthread_mutex_lock(&writable->error_mutex);
	memcpy(out->error, recorder->error, sizeof out->error);
	pthread_mutex_unlock(&writable->error_mutex);
}

enum gz_result gz_recorder_start(struct gz_recorder *recorder, int fd, const char *path,
				 const struct gz_gaze_log_header *header)
{
	enum phase phase = phase_of(recorder);
	if (phase == PHASE_RUNNING || phase == PHASE_FINISHING)
		return GZ_ERR_BUSY;
	recorder->session++;
	recorder->fd = fd;
	recorder->missing = 0;
	snprintf(recorder->path, sizeof recorder->path, "%s", path);
	recorder->header = *header;
	atomic_store(&recorder->samples, 0);
	set_phase(recorder, PHASE_RUNNING);
	signal_event(recorder->wake_fd);
	return GZ_OK;
}

void gz_recorder_get_path(const struct gz_recorder *recorder, char *path)
{
	memcpy(path, recorder->path, sizeof recorder->path);
}

bool gz_recorder_running(const struct gz_recorder *recorder)
{
	return phase_of(recorder) == PHASE_RUNNING;
}

bool gz_recorder_has_room(const struct gz_recorder *recorder)
{
	return gz_ring_room(recorder->ring) >= GZ_RECORDER_RING / 2;
}

/* Record how many samples found the ring full, before the record that follows them. */
static void push_gap(struct gz_recorder *recorder, int64_t host_ns)
{
	struct gz_gaze_log_record gap = {
		.kind = GZ_GAZE_LOG_GAP,
		.host_ns = host_ns,
		.missing = recorder->missing,
		.text = "the disk was too slow",
	};
	uint64_t held_back;
	gz_ring_push(recorder->ring, recorder->session, &gap);
	if (gz_ratelimit_pass(&recorder->complaints, gz_clock_now_ns(), GZ_NS_PER_S, &held_back))
		gz_warn(recorder->log,
			"%s: %llu samples are missing: the disk was too slow (%llu more gaps since "
			"the last message)",
			recorder->path, (unsigned long long)recorder->missing,
			(unsigned long long)held_back);
	recorder->missing = 0;
}

/* Samples that the log will lack if there is no room for @p record. */
static uint64_t missing_with(const struct gz_gaze_log_record *record)
{
	return record->kind == GZ_GAZE_LOG_SAMPLE ? 1
	       : record->kind == GZ_GAZE_LOG_GAP  ? record->missing
						  : 0;
}

void gz_recorder_push(struct gz_recorder *recorder, const struct gz_gaze_log_record *record)
{
	if (!gz_recorder_running(recorder))
		return;
	bool sample = record->kind == GZ_GAZE_LOG_SAMPLE;
	/* One slot stays free for a gap record. After a loss half of the ring must be free again,
	 * so that a disk that is slightly too slow causes few long gaps instead of many short ones.
	 */
	size_t needed = recorder->missing ? GZ_RECORDER_RING / 2 : 2;
	if (gz_ring_room(recorder->ring) < needed) {
		recorder->missing += missing_with(record);
		return;
	}
	if (recorder->missing)
		push_gap(recorder, sample ? record->sample.host_ns : record->host_ns);
	gz_ring_push(recorder->ring, recorder->session, record);
}

void gz_recorder_stop(struct gz_recorder *recorder)
{
	int running = PHASE_RUNNING;
	if (!gz_recorder_running(recorder))
		return;
	if (recorder->missing)
		push_gap(recorder, gz_clock_now_ns());
	/* Unless it has failed in the meantime. */
	atomic_compare_exchange_strong(&recorder->phase, &running, PHASE_FINISHING);
	signal_event(recorder->event_fd);
	signal_event(recorder->wake_fd);
}

void gz_recorder_destroy(struct gz_recorder **recorder)
{
	if (!recorder || !*recorder)
		return;
	struct gz_recorder *r = *recorder;
	if (r->has_thread) {
		gz_recorder_stop(r);
		atomic_store(&r->quit, true);
		signal_event(r->wake_fd);
		pthread_join(r->thread, NULL);
	}
	if (r->wake_fd >= 0)
		close(r->wake_fd);
	if (r->event_fd >= 0)
		close(r->event_fd);
	gz_disk_sync_destroy(&r->disk_sync);
	gz_ring_destroy(&r->ring);
	pthread_mutex_destroy(&r->error_mutex);
	free(r);
	*recorder = NULL;
}
