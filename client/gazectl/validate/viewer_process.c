#include "client/gazectl/validate/viewer_process.h"

#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <math.h>
#include <signal.h>
#include <spawn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#include "base/clock.h"
#include "base/text.h"
#include "protocol/gaze.h"

#define GZ_LOG_MODULE "gazectl"

extern char **environ;

/* Most arguments passed to gazeview. */
enum { ARGUMENTS_MAX = 40 };

/* Most words of a line: its name and five numbers. */
enum { WORDS_MAX = 6 };

/* How long gazeview may take to end before it is killed; chosen. */
static const int64_t END_PATIENCE_NS = 2 * GZ_NS_PER_S;

struct words {
	int count;
	char *word[WORDS_MAX];
};

static bool split_words(char *line, struct words *words)
{
	words->count = 0;
	for (char *word; (word = gz_number_next_word(&line, " ")) != NULL;) {
		if (words->count == WORDS_MAX)
			return false;
		words->word[words->count++] = word;
	}
	return words->count > 0;
}

static bool parse_word_number(const struct words *words, int i, int64_t max, int64_t *out_value)
{
	long long value;
	if (!gz_number_parse_whole(words->word[i], &value) || value < 0 || value > max)
		return false;
	*out_value = value;
	return true;
}

/* A place on the desktop may be negative. */
static bool parse_word_place(const struct words *words, int i, int *out_px)
{
	long long value;
	if (!gz_number_parse_whole(words->word[i], &value) || value < -GZ_MONITOR_PLACE_MAX_PX ||
	    value > GZ_MONITOR_PLACE_MAX_PX)
		return false;
	*out_px = (int)value;
	return true;
}

static bool parse_screen(const struct words *words, struct gz_viewer_event *event)
{
	struct gz_monitor_place *monitor = &event->monitor;
	int64_t px[2];
	if (words->count != 6 || !parse_word_number(words, 1, GZ_DISPLAY_SIDE_MAX_PX, &px[0]) ||
	    !parse_word_number(words, 2, GZ_DISPLAY_SIDE_MAX_PX, &px[1]) ||
	    !parse_word_place(words, 3, &monitor->at[0]) ||
	    !parse_word_place(words, 4, &monitor->at[1]) ||
	    !gz_number_parse(words->word[5], &monitor->scale))
		return false;
	monitor->px[0] = (int)px[0];
	monitor->px[1] = (int)px[1];
	return monitor->scale >= 0 && monitor->scale <= GZ_MONITOR_SCALE_MAX;
}

static bool parse_shown(const struct words *words, struct gz_viewer_event *event)
{
	int64_t index, count;
	double x, y;
	if (words->count != 6 || !parse_word_number(words, 1, INT32_MAX, &index) ||
	    !parse_word_number(words, 2, INT32_MAX, &count) || index >= count ||
	    !gz_number_parse(words->word[3], &x) || !gz_number_parse(words->word[4], &y) ||
	    !parse_word_number(words, 5, INT64_MAX, &event->time_ns))
		return false;
	event->index = (size_t)index;
	event->count = (size_t)count;
	event->point = (struct gz_point) { (float)x, (float)y };
	return isfinite(event->point.x) && isfinite(event->point.y);
}

static bool parse_hidden(const struct words *words, struct gz_viewer_event *event)
{
	int64_t index;
	if (words->count != 3 || !parse_word_number(words, 1, INT32_MAX, &index) ||
	    !parse_word_number(words, 2, INT64_MAX, &event->time_ns))
		return false;
	event->index = (size_t)index;
	return true;
}

static bool parse_end(const struct words *words, struct gz_viewer_event *event)
{
	return words->count == 2 && parse_word_number(words, 1, INT64_MAX, &event->time_ns);
}

enum gz_result gz_viewer_event_parse(const char *line, struct gz_viewer_event *out_event)
{
	static const struct {
		const char *name;
		enum gz_viewer_event_kind kind;
		bool (*parse)(const struct words *words, struct gz_viewer_event *event);
	} kinds[] = {
		{ "screen", GZ_VIEWER_SCREEN, parse_screen },
		{ "shown", GZ_VIEWER_SHOWN, parse_shown },
		{ "hidden", GZ_VIEWER_HIDDEN, parse_hidden },
		{ "finished", GZ_VIEWER_FINISHED, parse_end },
		{ "cancelled", GZ_VIEWER_CANCELLED, parse_end },
	};
	char text[GZ_VIEWER_LINE_SIZE];
	struct words words;
	size_t length = strlen(line);
	if (length >= sizeof text)
		return GZ_ERR_FORMAT;
	memcpy(text, line, length + 1);
	if (!split_words(text, &words))
		return GZ_ERR_FORMAT;
	for (size_t i = 0; i < sizeof kinds / sizeof kinds[0]; i++) {
		struct gz_viewer_event event = { .kind = kinds[i].kind };
		if (strcmp(words.word[0], kinds[i].name) != 0)
			continue;
		if (!kinds[i].parse(&words, &event))
			return GZ_ERR_FORMAT;
		*out_event = event;
		return GZ_OK;
	}
	return GZ_ERR_FORMAT;
}

/* The path of gazeview in the directory of this program. @return whether it can be run */
static bool find_gazeview_beside(char *path, size_t size)
{
	static const char name[] = "gazeview";
	ssize_t length = readlink("/proc/self/exe", path, size - 1);
	if (length <= 0)
		return false;
	path[length] = '\0';
	char *slash = strrchr(path, '/');
	if (!slash || (size_t)(slash + 1 - path) + sizeof name > size)
		return false;
	memcpy(slash + 1, name, sizeof name);
	return access(path, X_OK) == 0;
}

/* Start a program whose standard output is @p write_end of a pipe. @return 0, or an errno */
static int spawn_with_output(const char *path, char *const *argv, int write_end, pid_t *out_process)
{
	posix_spawn_file_actions_t actions;
	int failure = posix_spawn_file_actions_init(&actions);
	if (failure != 0)
		return failure;
	failure = posix_spawn_file_actions_adddup2(&actions, write_end, STDOUT_FILENO);
	if (failure == 0)
		failure = posix_spawnp(out_process, path, &actions, NULL, argv, environ);
	posix_spawn_file_actions_destroy(&actions);
	return failure;
}

enum gz_result gz_viewer_process_start(struct gz_viewer_process *viewer, const char *program,
				       const char *const *arguments, const struct gz_log *log)
{
	char path[GZ_PATH_SIZE];
	char *argv[ARGUMENTS_MAX + 2] = { path };
	int ends[2];
	snprintf(path, sizeof path, "%s", program);
	if (!program[0] && !find_gazeview_beside(path, sizeof path))
		snprintf(path, sizeof path, "gazeview");
	for (int i = 0; i < ARGUMENTS_MAX && arguments[i]; i++)
		argv[i + 1] = (char *)arguments[i]; /* posix_spawnp() does not change them */
	if (pipe2(ends, O_CLOEXEC) != 0) {
		gz_err(log, "cannot make a pipe for gazeview: %s", strerror(errno));
		return GZ_ERR_NO_MEM;
	}
	*viewer = (struct gz_viewer_process) { .out = ends[0], .log = log };
	fcntl(ends[0], F_SETFL, O_NONBLOCK);
	int failure = spawn_with_output(path, argv, ends[1], &viewer->process);
	close(ends[1]);
	if (failure == 0)
		return GZ_OK;
	close(ends[0]);
	*viewer = (struct gz_viewer_process) { .out = -1 };
	gz_err(log, "cannot start %s: %s; install gazeview, or give its path with --gazeview PATH",
	       path, strerror(failure));
	return failure == ENOENT || failure == EACCES ? GZ_ERR_NOT_FOUND : GZ_ERR_NO_MEM;
}

/* Cut the first line off the buffer. @return whether there is a complete one */
static bool cut_line(struct gz_viewer_process *viewer, char line[GZ_VIEWER_LINE_SIZE])
{
	char *end = memchr(viewer->buffer, '\n', viewer->used);
	if (!end)
		return false;
	size_t length = (size_t)(end - viewer->buffer);
	memcpy(line, viewer->buffer, length);
	line[length] = '\0';
	viewer->used -= length + 1;
	memmove(viewer->buffer, end + 1, viewer->used);
	return true;
}

enum gz_result gz_viewer_process_read(struct gz_viewer_process *viewer,
				      struct gz_viewer_event *out_event)
{
	char line[GZ_VIEWER_LINE_SIZE];
	if (!cut_line(viewer, line)) {
		if (viewer->out < 0)
			return GZ_ERR_TIMEOUT;
		ssize_t n = read(viewer->out, viewer->buffer + viewer->used,
				 sizeof viewer->buffer - viewer->used);
		if (n < 0 && (errno == EAGAIN || errno == EINTR))
			return GZ_ERR_TIMEOUT;
		if (n <= 0) { /* also if a line does not fit the buffer */
			close(viewer->out);
			viewer->out = -1;
			*out_event = (struct gz_viewer_event) { .kind = GZ_VIEWER_GONE };
			return GZ_OK;
		}
		viewer->used += (size_t)n;
		if (!cut_line(viewer, line))
			return GZ_ERR_TIMEOUT;
	}
	if (gz_viewer_event_parse(line, out_event) == GZ_OK)
		return GZ_OK;
	gz_err(viewer->log,
	       "gazeview printed \"%s\", which gazectl does not understand: are both of the same "
	       "version?",
	       line);
	return GZ_ERR_FORMAT;
}

static bool wait_for_end(pid_t process, int *status)
{
	int64_t deadline_ns = gz_clock_now_ns() + END_PATIENCE_NS;
	while (waitpid(process, status, WNOHANG) == 0) {
		if (gz_clock_now_ns() > deadline_ns)
			return false;
		gz_clock_sleep_until_ns(gz_clock_now_ns() + 5 * GZ_NS_PER_MS);
	}
	return true;
}

int gz_viewer_process_end(struct gz_viewer_process *viewer)
{
	int status = 0;
	if (viewer->process == 0)
		return -1;
	bool open = viewer->out >= 0;
	if (open)
		close(viewer->out);
	if (open)
		kill(viewer->process, SIGTERM);
	if (!wait_for_end(viewer->process, &status)) {
		kill(viewer->process, SIGKILL);
		waitpid(viewer->process, &status, 0);
	}
	*viewer = (struct gz_viewer_process) { .out = -1 };
	return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}
