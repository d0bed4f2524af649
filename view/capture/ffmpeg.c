#include "view/capture/ffmpeg.h"

#include <errno.h>
#include <fcntl.h>
#include <pthread.h>
#include <signal.h>
#include <spawn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include "base/file.h"
#include "protocol/gaze.h"

#define GZ_LOG_MODULE "video"

extern char **environ;

/* Even sides, and colours converted to BT.709. */
static const char even_filter[] =
	"pad=ceil(iw/2)*2:ceil(ih/2)*2,"
	"scale=out_color_matrix=bt709:out_range=tv:flags=accurate_rnd+full_chroma_int,"
	"format=yuv420p";

enum { WORDS_SIZE = 384, TAIL_SIZE = 1024, ARGUMENTS_MAX = 48 };

struct gz_ffmpeg {
	const struct gz_log *log;
	char path[GZ_PATH_SIZE];
	int width, height;
	pid_t child;
	int pictures; /* pipe to ffmpeg's standard input */
	int words;    /* memory file for its standard error */
	bool broken;  /* ffmpeg no longer reads */
};

/* Arguments of a command; the texts are borrowed. */
struct arguments {
	const char *words[ARGUMENTS_MAX];
	size_t count;
};

static void append_arguments(struct arguments *arguments, const char *const *words)
{
	for (; *words && arguments->count + 1 < ARGUMENTS_MAX; words++)
		arguments->words[arguments->count++] = *words;
	arguments->words[arguments->count] = NULL;
}

/* Codec arguments. x264's authors call constant rate factor 18 visually lossless or nearly so; 24
 * is about the same for VP9. faststart puts the index first, for browsers. */
static void append_coding(struct arguments *arguments, const char *path)
{
	static const char *const even[] = {
		"-vf",   even_filter,  "-colorspace", "bt709", "-color_primaries",
		"bt709", "-color_trc", "bt709",       NULL,
	};
	static const char *const h264[] = { "-c:v", "libx264", "-crf", "18", NULL };
	static const char *const vp9[] = { "-c:v", "libvpx-vp9", "-crf", "24", "-b:v", "0", NULL };
	static const char *const faststart[] = { "-movflags", "+faststart", NULL };
	const bool movie = gz_path_ends(path, ".mp4") || gz_path_ends(path, ".m4v") ||
			   gz_path_ends(path, ".mov");
	if (movie || gz_path_ends(path, ".mkv")) {
		append_arguments(arguments, even);
		append_arguments(arguments, h264);
	} else if (gz_path_ends(path, ".webm")) {
		append_arguments(arguments, even);
		append_arguments(arguments, vp9);
	}
	if (movie)
		append_arguments(arguments, faststart);
}

/* The child gets its three standard files, no other file of ours, and default signals. It has a
 * process group of its own, so that Ctrl-C in the terminal does not end the video before we do. */
static int spawn_ffmpeg(struct gz_ffmpeg *ffmpeg, int input, char *const *words)
{
	posix_spawn_file_actions_t files;
	posix_spawnattr_t attributes;
	sigset_t none, all;
	sigemptyset(&none);
	sigfillset(&all);
	posix_spawn_file_actions_init(&files);
	posix_spawnattr_init(&attributes);
	posix_spawn_file_actions_adddup2(&files, input, STDIN_FILENO);
	posix_spawn_file_actions_addopen(&files, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
	posix_spawn_file_actions_adddup2(&files, ffmpeg->words, STDERR_FILENO);
	posix_spawn_file_actions_addclosefrom_np(&files, STDERR_FILENO + 1);
	posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP | POSIX_SPAWN_SETSIGMASK |
						      POSIX_SPAWN_SETSIGDEF);
	posix_spawnattr_setpgroup(&attributes, 0);
	posix_spawnattr_setsigmask(&attributes, &none);
	posix_spawnattr_setsigdefault(&attributes, &all);
	int error = posix_spawnp(&ffmpeg->child, words[0], &files, &attributes, words, environ);
	posix_spawnattr_destroy(&attributes);
	posix_spawn_file_actions_destroy(&files);
	return error;
}

static int start_child(struct gz_ffmpeg *ffmpeg, const struct gz_ffmpeg_params *params, int input)
{
	char size[32], rate[32], name[GZ_PATH_SIZE + 8];
	snprintf(size, sizeof size, "%dx%d", params->width, params->height);
	snprintf(rate, sizeof rate, "%.9g", params->fps);
	snprintf(name, sizeof name, "file:%s",
		 params->path); /* "file:" protects names such as "a:b" */
	/* Without -xerror ffmpeg 5.1 exits with 0 when the disk fills up. */
	const char *const taken[] = {
		"ffmpeg", "-hide_banner", "-nostats", "-loglevel", "error",  "-xerror",
		"-y",     "-f",           "rawvideo", "-pix_fmt",  "rgb0",   "-s",
		size,     "-framerate",   rate,       "-i",        "pipe:0", NULL,
	};
	const char *const target[] = { name, NULL };
	struct arguments arguments = { .count = 0 };
	append_arguments(&arguments, taken);
	append_coding(&arguments, params->path);
	append_arguments(&arguments, target);
	char *words[ARGUMENTS_MAX]; /* posix_spawn() does not change them */
	memcpy(words, arguments.words, sizeof words);
	return spawn_ffmpeg(ffmpeg, input, words);
}

static enum gz_result tell_start(const struct gz_log *log, const char *path, int error)
{
	if (error == ENOENT) {
		gz_err(log,
		       "%s: ffmpeg, which writes videos, was not found; install the package ffmpeg",
		       path);
		return GZ_ERR_NOT_FOUND;
	}
	gz_err(log, "%s: ffmpeg cannot be started: %s", path, strerror(error));
	return GZ_ERR_IO;
}

/* Close the files and free. The child has ended or was never started. */
static void release_ffmpeg(struct gz_ffmpeg *ffmpeg)
{
	if (ffmpeg->pictures >= 0)
		close(ffmpeg->pictures);
	if (ffmpeg->words >= 0)
		close(ffmpeg->words);
	free(ffmpeg);
}

enum gz_result gz_ffmpeg_start(const struct gz_ffmpeg_params *params, const struct gz_log *log,
			       struct gz_ffmpeg **out_ffmpeg)
{
	int ends[2] = { -1, -1 };
	struct gz_ffmpeg *ffmpeg = calloc(1, sizeof *ffmpeg);
	if (!ffmpeg)
		return GZ_ERR_NO_MEM;
	*ffmpeg = (struct gz_ffmpeg) {
		.log = log,
		.width = params->width,
		.height = params->height,
		.pictures = -1,
		.words = memfd_create("ffmpeg", MFD_CLOEXEC),
	};
	snprintf(ffmpeg->path, sizeof ffmpeg->path, "%s", params->path);
	int error = ffmpeg->words < 0 || pipe2(ends, O_CLOEXEC) != 0 ? errno : 0;
	ffmpeg->pictures = ends[1];
	if (!error)
		error = start_child(ffmpeg, params, ends[0]);
	if (ends[0] >= 0)
		close(ends[0]);
	if (error) {
		release_ffmpeg(ffmpeg);
		return tell_start(log, params->path, error);
	}
	*out_ffmpeg = ffmpeg;
	return GZ_OK;
}

/* Writing to a pipe without a reader raises SIGPIPE. Block it here and consume it before it can end
 * the program. */
static bool write_quietly(int fd, const uint8_t *bytes, size_t size)
{
	sigset_t pipe_signal, before;
	const struct timespec at_once = { 0 };
	sigemptyset(&pipe_signal);
	sigaddset(&pipe_signal, SIGPIPE);
	pthread_sigmask(SIG_BLOCK, &pipe_signal, &before);
	bool done = gz_write_all(fd, bytes, size) == size;
	if (!done && !sigismember(&before, SIGPIPE))
		while (sigtimedwait(&pipe_signal, NULL, &at_once) < 0 && errno == EINTR)
			;
	pthread_sigmask(SIG_SETMASK, &before, NULL);
	return done;
}

enum gz_result gz_ffmpeg_write(struct gz_ffmpeg *ffmpeg, const struct gz_image *image)
{
	if (image->width != ffmpeg->width || image->height != ffmpeg->height)
		return GZ_ERR_INVAL;
	const size_t size = (size_t)image->width * (size_t)image->height * 4;
	if (!ffmpeg->broken && !write_quietly(ffmpeg->pictures, image->pixels, size))
		ffmpeg->broken = true;
	return ffmpeg->broken ? GZ_ERR_IO : GZ_OK;
}

/* The last two lines of ffmpeg's messages (the last alone may only name the file), without control
 * characters. */
static void find_last_words(int fd, char *words, size_t size)
{
	char tail[TAIL_SIZE];
	const off_t end = lseek(fd, 0, SEEK_END);
	ssize_t length = pread(fd, tail, sizeof tail, end > TAIL_SIZE ? end - TAIL_SIZE : 0);
	words[0] = '\0';
	while (length > 0 && (tail[length - 1] == '\n' || tail[length - 1] == '\r'))
		length--;
	if (length <= 0)
		return;
	const char *last = memrchr(tail, '\n', (size_t)length);
	const char *before = last ? memrchr(tail, '\n', (size_t)(last - tail)) : NULL;
	const char *begin = before ? before + 1 : tail;
	size_t used = 0;
	for (; begin < tail + length && used + 2 < size; begin++) {
		if (*begin == '\n')
			words[used++] = ';';
		words[used++] = (unsigned char)*begin < ' ' || *begin == '\x7f' ? ' ' : *begin;
	}
	words[used] = '\0';
}

static void tell_end(const struct gz_ffmpeg *ffmpeg, int status)
{
	char words[WORDS_SIZE];
	find_last_words(ffmpeg->words, words, sizeof words);
	if (words[0])
		gz_err(ffmpeg->log,
		       "%s: the video is incomplete: ffmpeg: \"%s\"; check that the folder is "
		       "writable and has space, and that the ending is a video's",
		       ffmpeg->path, words);
	else if (WIFSIGNALED(status))
		gz_err(ffmpeg->log, "%s: the video is incomplete: ffmpeg was ended by signal %d",
		       ffmpeg->path, WTERMSIG(status));
	else
		gz_err(ffmpeg->log, "%s: the video is incomplete: ffmpeg exited with status %d",
		       ffmpeg->path, WIFEXITED(status) ? WEXITSTATUS(status) : -1);
}

enum gz_result gz_ffmpeg_end(struct gz_ffmpeg **ffmpeg)
{
	struct gz_ffmpeg *self = *ffmpeg;
	int status = 0;
	*ffmpeg = NULL;
	if (!self)
		return GZ_OK;
	close(self->pictures);
	self->pictures = -1;
	while (waitpid(self->child, &status, 0) < 0 && errno == EINTR)
		;
	const bool good = !self->broken && WIFEXITED(status) && WEXITSTATUS(status) == 0;
	if (!good)
		tell_end(self, status);
	release_ffmpeg(self);
	return good ? GZ_OK : GZ_ERR_IO;
}
