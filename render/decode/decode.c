#include "render/decode/decode.h"

#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <poll.h>
#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "base/clock.h"
#include "base/file.h"
#include "base/utf8.h"
#include "render/decode/decode_process.h"

#define GZ_LOG_MODULE "decode"

/* How often goes_on() is asked, ms. */
#define POLL_MS 50

/* How long and how often sealing is tried, ms (chosen). */
#define SEAL_PATIENCE_MS 500
#define SEAL_RETRY_MS    5

/* One decoding. */
struct run {
	const struct gz_decode_job *job;
	struct gz_decode_process process;
	struct gz_decode_message message; /* the first `filled` bytes of the next one */
	size_t filled;
	uint64_t messages;
	int lines, errors;    /* of the log */
	double share;         /* of the newest step */
	int32_t steps;        /* of the newest step */
	int64_t moved_ns;     /* when it last made progress */
	bool accepted, ended; /* header and end have come */
	uint32_t series;      /* of the list so far */
	uint32_t remarks;     /* pictures' rows and refusals so far */
	enum gz_result result;
	struct gz_decode_header header;
	struct gz_decode_place place;
};

static enum gz_result refuse_decoder(const struct run *run, enum gz_result result, const char *what)
{
	gz_err(run->job->log, "%s: its decoder %s; the file was not read", run->job->path, what);
	return result;
}

static enum gz_result take_line(struct run *run)
{
	struct gz_decode_message *message = &run->message;
	if (message->detail < GZ_LOG_DEBUG || message->detail > GZ_LOG_ERROR ||
	    !memchr(message->text, 0, sizeof message->text))
		return refuse_decoder(run, GZ_ERR_PROTOCOL, "sent a malformed line");
	const enum gz_log_level level = (enum gz_log_level)message->detail;
	if (run->lines++ >= GZ_DECODE_LINES_MAX)
		return GZ_OK;
	run->errors += level == GZ_LOG_ERROR;
	gz_utf8_clean(message->text);
	if (gz_log_wants(run->job->log, level, GZ_LOG_MODULE))
		gz_log_write(run->job->log, level, GZ_LOG_MODULE, "%s", message->text);
	return GZ_OK;
}

static enum gz_result take_step(struct run *run)
{
	const struct gz_decode_message *message = &run->message;
	if (!(message->share >= 0 && message->share <= 1))
		return refuse_decoder(run, GZ_ERR_PROTOCOL, "sent a step outside of 0 to 1");
	if (message->share > run->share || message->detail > run->steps)
		run->moved_ns = gz_clock_now_ns();
	run->share = message->share > run->share ? message->share : run->share;
	run->steps = message->detail > run->steps ? message->detail : run->steps;
	return GZ_OK;
}

/* Give the memfd its size for good, and the decoder the address space for it. */
static enum gz_result size_voxel_memory(const struct run *run)
{
	const pid_t pid = run->process.pid;
	struct rlimit limit;
	if (!run->place.in_scratch &&
	    (ftruncate(run->process.memory, (off_t)run->place.bytes) != 0 ||
	     fcntl(run->process.memory, F_ADD_SEALS, F_SEAL_SHRINK | F_SEAL_GROW) != 0)) {
		gz_err(run->job->log, "%s: no memory for %zu MiB of voxels: %s", run->job->path,
		       run->place.bytes >> 20, strerror(errno));
		return GZ_ERR_NO_MEM;
	}
	if (prlimit(pid, RLIMIT_AS, NULL, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY)
		return GZ_OK; /* none: the decoder has said so, or has just died */
	limit.rlim_cur = GZ_DECODE_WORK_BYTES + run->place.bytes;
	if (limit.rlim_max != RLIM_INFINITY && limit.rlim_cur > limit.rlim_max)
		limit.rlim_cur = limit.rlim_max;
	(void)prlimit(pid, RLIMIT_AS, &limit, NULL); /* without it the decoder says: no memory */
	return GZ_OK;
}

static enum gz_result take_header(struct run *run)
{
	const struct gz_decode_header *header = &run->message.header;
	if (run->accepted || run->series > 0)
		return refuse_decoder(run, GZ_ERR_PROTOCOL, "sent a malformed header");
	enum gz_result result = run->job->accept(run->job->user, header, &run->place);
	if (result == GZ_OK)
		result = size_voxel_memory(run);
	if (result != GZ_OK)
		return result;
	run->accepted = true;
	run->header = *header;
	run->moved_ns = gz_clock_now_ns();
	const char answer = run->place.in_scratch ? GZ_DECODE_INTO_SCRATCH : GZ_DECODE_INTO_MEMORY;
	/* If it has died in the meantime, its pipe of messages tells that. */
	(void)gz_write_all(run->process.answers, &answer, 1);
	return GZ_OK;
}

/* Whether two headers agree in all that the memory of the voxels depends on. */
static bool same_voxels(const struct gz_decode_header *a, const struct gz_decode_header *b)
{
	return memcmp(a->dims, b->dims, sizeof a->dims) == 0 && a->type == b->type &&
	       a->oriented == b->oriented && a->labels == b->labels && a->colour == b->colour &&
	       memcmp(a->spacing, b->spacing, sizeof a->spacing) == 0;
}

static enum gz_result take_good_end(struct run *run)
{
	const struct gz_decode_header *header = &run->message.header;
	if (!run->accepted)
		return refuse_decoder(run, GZ_ERR_PROTOCOL, "ended without voxels");
	if (!same_voxels(header, &run->header) || !isfinite(header->slope) || header->slope == 0 ||
	    !isfinite(header->intercept))
		return refuse_decoder(run, GZ_ERR_PROTOCOL, "ended with another header");
	run->header = *header;
	return GZ_OK;
}

/* The decoder's own result. */
static enum gz_result take_end(struct run *run)
{
	static const enum gz_result allowed[] = { GZ_ERR_NOT_FOUND,   GZ_ERR_IO,     GZ_ERR_FORMAT,
						  GZ_ERR_UNSUPPORTED, GZ_ERR_NO_MEM, GZ_ERR_INVAL };
	run->ended = true;
	if (run->message.detail == GZ_OK)
		return take_good_end(run);
	for (size_t i = 0; i < sizeof allowed / sizeof allowed[0]; i++) {
		if (run->message.detail != (int32_t)allowed[i])
			continue;
		if (run->errors == 0)
			refuse_decoder(run, allowed[i], gz_result_text(allowed[i]));
		return allowed[i];
	}
	return refuse_decoder(run, GZ_ERR_PROTOCOL, "ended with an unknown result");
}

/* Whether a text of a message ends within its room; it is cleaned then. */
static bool clean_field(char *text, size_t size)
{
	if (!memchr(text, 0, size))
		return false;
	gz_utf8_clean(text);
	return true;
}

static enum gz_result take_listed_series(struct run *run)
{
	struct gz_decode_series *series = &run->message.series;
	const bool whole = clean_field(series->uid, sizeof series->uid) &&
			   clean_field(series->date, sizeof series->date) &&
			   clean_field(series->modality, sizeof series->modality) &&
			   clean_field(series->patient, sizeof series->patient) &&
			   clean_field(series->description, sizeof series->description) &&
			   clean_field(series->reason, sizeof series->reason);
	if (!run->job->listener || run->accepted || !whole || series->slices < 0 ||
	    run->series >= GZ_DECODE_SERIES_MAX)
		return refuse_decoder(run, GZ_ERR_PROTOCOL, "sent a malformed series");
	run->series++;
	run->moved_ns = gz_clock_now_ns();
	const enum gz_result result = run->job->listener->series(run->job->listener->user, series);
	return result == GZ_OK ? GZ_OK : refuse_decoder(run, result, gz_result_text(result));
}

/* Whether the number in a message is that of a series, of which it is not told without end. */
static bool remark_allowed(struct run *run)
{
	const int32_t index = run->message.detail;
	const uint32_t most = run->series * (GZ_DECODE_PICTURE_BANDS + 1);
	if (index < 0 || (uint32_t)index >= run->series || run->remarks >= most)
		return false;
	run->remarks++;
	run->moved_ns = gz_clock_now_ns();
	return true;
}

static enum gz_result take_series_picture(struct run *run)
{
	const struct gz_decode_picture *picture = &run->message.picture;
	if (picture->band >= GZ_DECODE_PICTURE_BANDS || !remark_allowed(run))
		return refuse_decoder(run, GZ_ERR_PROTOCOL, "sent a malformed picture");
	run->job->listener->picture(run->job->listener->user, (uint32_t)run->message.detail,
				    picture);
	return GZ_OK;
}

static enum gz_result take_refusal(struct run *run)
{
	char *why = run->message.text;
	if (!clean_field(why, sizeof run->message.text) || !remark_allowed(run))
		return refuse_decoder(run, GZ_ERR_PROTOCOL, "sent a malformed refusal");
	run->job->listener->refused(run->job->listener->user, (uint32_t)run->message.detail, why);
	return GZ_OK;
}

static enum gz_result take_list_end(struct run *run)
{
	if (run->series == 0)
		return refuse_decoder(run, GZ_ERR_PROTOCOL, "ended an empty list");
	run->ended = true;
	return GZ_ERR_CHOICE;
}

static enum gz_result take_message(struct run *run)
{
	if (++run->messages > GZ_DECODE_MESSAGES_MAX || run->lines > 100 * GZ_DECODE_LINES_MAX)
		return refuse_decoder(run, GZ_ERR_PROTOCOL, "floods with messages");
	switch (run->message.kind) {
	case GZ_DECODE_STEP:
		return take_step(run);
	case GZ_DECODE_LINE:
		return take_line(run);
	case GZ_DECODE_HEADER:
		return take_header(run);
	case GZ_DECODE_ENDED:
		return take_end(run);
	case GZ_DECODE_SERIES:
		return take_listed_series(run);
	case GZ_DECODE_PICTURE:
		return take_series_picture(run);
	case GZ_DECODE_REFUSED:
		return take_refusal(run);
	case GZ_DECODE_LISTED:
		return take_list_end(run);
	default:
		return refuse_decoder(run, GZ_ERR_PROTOCOL, "sent something that is not a message");
	}
}

/* The pipe ended before the decoder said that it did: why. */
static enum gz_result explain_death(struct run *run)
{
	char what[128];
	const int status = gz_decode_process_stop(&run->process);
	if (WIFSIGNALED(status) && WTERMSIG(status) == SIGXCPU)
		return refuse_decoder(run, GZ_ERR_TIMEOUT, "took too much processor time");
	if (WIFSIGNALED(status) && WTERMSIG(status) == SIGKILL)
		return refuse_decoder(run, GZ_ERR_PROTOCOL, "was killed");
	if (WIFSIGNALED(status))
		snprintf(what, sizeof what, "crashed (%s)", strsignal(WTERMSIG(status)));
	else
		snprintf(what, sizeof what, "ended without a result (status %d)",
			 WEXITSTATUS(status));
	return refuse_decoder(run, GZ_ERR_PROTOCOL, what);
}

/* Take what the pipe holds, up to one message. */
static enum gz_result read_message(struct run *run)
{
	const ssize_t got = read(run->process.messages, (char *)&run->message + run->filled,
				 sizeof run->message - run->filled);
	if (got < 0)
		return errno == EAGAIN || errno == EINTR ? GZ_OK : explain_death(run);
	if (got == 0)
		return explain_death(run);
	run->filled += (size_t)got;
	if (run->filled < sizeof run->message)
		return GZ_OK;
	run->filled = 0;
	return take_message(run);
}

static enum gz_result check_patience(const struct run *run)
{
	const int patience_ms =
		run->job->patience_ms > 0 ? run->job->patience_ms : GZ_DECODE_PATIENCE_MS;
	char what[96];
	if (gz_clock_now_ns() - run->moved_ns <= patience_ms * GZ_NS_PER_MS)
		return GZ_OK;
	snprintf(what, sizeof what, "made no progress for %g s", patience_ms / 1e3);
	return refuse_decoder(run, GZ_ERR_TIMEOUT, what);
}

static enum gz_result watch_decoder(struct run *run)
{
	int64_t asked_ns = 0;
	while (!run->ended) {
		const int64_t now_ns = gz_clock_now_ns();
		if (now_ns - asked_ns >= POLL_MS * GZ_NS_PER_MS) {
			if (!run->job->goes_on(run->job->user, run->share))
				return GZ_ERR_CANCELLED;
			asked_ns = now_ns;
		}
		struct pollfd pipe_end = { .fd = run->process.messages, .events = POLLIN };
		const int ready = poll(&pipe_end, 1, POLL_MS);
		enum gz_result result = ready > 0 ? read_message(run) : GZ_OK;
		if (result == GZ_OK && !run->ended)
			result = check_patience(run);
		if (result != GZ_OK)
			return result;
	}
	return GZ_OK;
}

/* Seal the memfd against writing. A process that looks at the decoder in /proc keeps its memory for
 * a moment after its end. */
static bool seal_voxels(int fd)
{
	const int64_t until_ns = gz_clock_now_ns() + SEAL_PATIENCE_MS * GZ_NS_PER_MS;
	while (fcntl(fd, F_ADD_SEALS, F_SEAL_WRITE | F_SEAL_SEAL) != 0) {
		if (errno != EBUSY || gz_clock_now_ns() > until_ns)
			return false;
		gz_clock_sleep_until_ns(gz_clock_now_ns() + SEAL_RETRY_MS * GZ_NS_PER_MS);
	}
	return true;
}

/* Once no process has it, nobody writes to it any more: sealed, and mapped to be read. */
static enum gz_result map_voxels(struct run *run, struct gz_decoded *out_decoded)
{
	const struct gz_decode_job *job = run->job;
	const int fd = run->place.in_scratch ? job->scratch_fd : run->process.memory;
	(void)gz_decode_process_stop(&run->process);
	if (!run->place.in_scratch && !seal_voxels(fd))
		return refuse_decoder(run, GZ_ERR_PROTOCOL, "left its memory to another process");
	/* A private mapping that is only read is the pages of the file itself. */
	void *voxels = mmap(NULL, run->place.bytes, PROT_READ, MAP_PRIVATE, fd, 0);
	if (voxels == MAP_FAILED) {
		gz_err(job->log, "%s: cannot map its %zu MiB of voxels: %s", job->path,
		       run->place.bytes >> 20, strerror(errno));
		return GZ_ERR_NO_MEM;
	}
	out_decoded->header = run->header;
	out_decoded->voxels = voxels;
	out_decoded->mapped = run->place.bytes;
	return GZ_OK;
}

static void report_dropped_lines(const struct run *run)
{
	if (run->lines > GZ_DECODE_LINES_MAX)
		gz_warn(run->job->log, "%s: %d further lines of its decoder are left out",
			run->job->path, run->lines - GZ_DECODE_LINES_MAX);
}

enum gz_result gz_decode_run(const struct gz_decode_job *job, struct gz_decoded *out_decoded)
{
	struct run run = { .job = job, .moved_ns = gz_clock_now_ns() };
	enum gz_result result = gz_decode_process_start(job, &run.process);
	if (result == GZ_OK)
		result = watch_decoder(&run);
	if (result == GZ_OK)
		result = map_voxels(&run, out_decoded);
	gz_decode_process_end(&run.process);
	if (result != GZ_ERR_CANCELLED)
		report_dropped_lines(&run);
	return result;
}
