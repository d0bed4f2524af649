#include "render/data/byte_stream.h"

#include <bzlib.h>
#include <errno.h>
#include <fcntl.h>
#include <pthread.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zlib.h>
#include <zstd.h>

#define GZ_LOG_MODULE "volume"

/* Chosen: a block is a fraction of a millisecond of decoding, the ring fits a second-level cache.
 */
#define BLOCK_BYTES ((size_t)256 << 10)
enum { BLOCKS = 4 };

struct block {
	uint8_t *bytes;
	size_t size; /* bytes in it */
	enum gz_result result;
};

struct gz_byte_ahead {
	gz_byte_source *source;
	void *user;
	uint64_t left; /* bytes to read; used by the thread alone */
	pthread_t thread;
	pthread_mutex_t mutex;
	pthread_cond_t changed;
	uint64_t made, taken; /* blocks; mutex guards these and the next two */
	bool through;         /* no more will be made */
	bool ending;
	struct block
		blocks[BLOCKS]; /* [taken, made) belong to the reader, the others to the thread */
	size_t at;              /* bytes read of the first; used by the reader alone */
	uint8_t memory[BLOCKS * BLOCK_BYTES];
};

/* The block to fill next; NULL if the reader wants no more. */
static struct block *await_free_block(struct gz_byte_ahead *ahead)
{
	pthread_mutex_lock(&ahead->mutex);
	while (!ahead->ending && ahead->made - ahead->taken == BLOCKS)
		pthread_cond_wait(&ahead->changed, &ahead->mutex);
	struct block *block = ahead->ending ? NULL : &ahead->blocks[ahead->made % BLOCKS];
	pthread_mutex_unlock(&ahead->mutex);
	return block;
}

static void hand_over_block(struct gz_byte_ahead *ahead, bool through)
{
	pthread_mutex_lock(&ahead->mutex);
	ahead->made++;
	ahead->through = through;
	pthread_cond_signal(&ahead->changed);
	pthread_mutex_unlock(&ahead->mutex);
}

static void *make_blocks(void *user)
{
	struct gz_byte_ahead *ahead = user;
	struct block *block;
	bool through = false;
	while (!through && (block = await_free_block(ahead))) {
		const size_t wanted = ahead->left < BLOCK_BYTES ? (size_t)ahead->left : BLOCK_BYTES;
		block->size = 0;
		block->result = ahead->source(ahead->user, block->bytes, wanted, &block->size);
		ahead->left -= block->size;
		through = block->result != GZ_OK || block->size < wanted || ahead->left == 0;
		hand_over_block(ahead, through);
	}
	return NULL;
}

enum gz_result gz_byte_ahead_start(gz_byte_source *source, void *user, uint64_t bytes,
				   struct gz_byte_ahead **out_ahead)
{
	struct gz_byte_ahead *ahead = malloc(sizeof *ahead);
	if (!ahead)
		return GZ_ERR_NO_MEM;
	memset(ahead, 0, offsetof(struct gz_byte_ahead, memory));
	ahead->source = source;
	ahead->user = user;
	ahead->left = bytes;
	for (int i = 0; i < BLOCKS; i++)
		ahead->blocks[i].bytes = ahead->memory + (size_t)i * BLOCK_BYTES;
	pthread_mutex_init(&ahead->mutex, NULL);
	pthread_cond_init(&ahead->changed, NULL);
	if (pthread_create(&ahead->thread, NULL, make_blocks, ahead) != 0) {
		pthread_cond_destroy(&ahead->changed);
		pthread_mutex_destroy(&ahead->mutex);
		free(ahead);
		return GZ_ERR_NO_MEM;
	}
	*out_ahead = ahead;
	return GZ_OK;
}

/* The block to read next; NULL if no more will come. */
static struct block *await_made_block(struct gz_byte_ahead *ahead)
{
	pthread_mutex_lock(&ahead->mutex);
	while (ahead->made == ahead->taken && !ahead->through)
		pthread_cond_wait(&ahead->changed, &ahead->mutex);
	struct block *block =
		ahead->made == ahead->taken ? NULL : &ahead->blocks[ahead->taken % BLOCKS];
	pthread_mutex_unlock(&ahead->mutex);
	return block;
}

static void give_block_back(struct gz_byte_ahead *ahead)
{
	pthread_mutex_lock(&ahead->mutex);
	ahead->taken++;
	ahead->at = 0;
	pthread_cond_signal(&ahead->changed);
	pthread_mutex_unlock(&ahead->mutex);
}

enum gz_result gz_byte_ahead_read(struct gz_byte_ahead *ahead, void *buffer, size_t size,
				  size_t *out_got)
{
	size_t got = 0;
	struct block *block;
	while (got < size && (block = await_made_block(ahead))) {
		if (block->result != GZ_OK)
			return block->result; /* it stays the next block, so each further read fails
						 too */
		const size_t there = block->size - ahead->at;
		const size_t part = there < size - got ? there : size - got;
		memcpy((uint8_t *)buffer + got, block->bytes + ahead->at, part);
		got += part;
		ahead->at += part;
		if (ahead->at == block->size)
			give_block_back(ahead);
	}
	*out_got = got;
	return GZ_OK;
}

void gz_byte_ahead_end(struct gz_byte_ahead **ahead)
{
	struct gz_byte_ahead *a = *ahead;
	if (!a)
		return;
	pthread_mutex_lock(&a->mutex);
	a->ending = true;
	pthread_cond_signal(&a->changed);
	pthread_mutex_unlock(&a->mutex);
	pthread_join(a->thread, NULL);
	pthread_cond_destroy(&a->changed);
	pthread_mutex_destroy(&a->mutex);
	free(a);
	*ahead = NULL;
}

#define INPUT_SIZE ((size_t)128 << 10)

/* Fewer bytes are decoded without a thread (chosen: a few milliseconds of decoding). */
#define AHEAD_BYTES_LEAST ((uint64_t)1 << 20)

/* Best ratio of deflate: 1032 to 1, zlib's technical details (zlib.net/zlib_tech.html). */
#define ZLIB_RATIO 1032
/* Best ratio of zstd: a block of 128 KiB from a header of 3 bytes and one byte to repeat, RFC 8878,
 * 3.1.1.2. */
#define ZSTD_RATIO 32768
/* Best ratio of bzip2: a block holds 900000 bytes after its first step, which turns 259 equal bytes
 * into 5 (bzip2 and libbzip2, "Memory management"; compress.c), and takes at least 24 bytes: its
 * magic number, checksum, and tables. */
#define BZIP2_RATIO (900000 / 5 * 259 / 24)
/* Added to the window bits, it makes zlib accept both zlib and gzip headers (zlib.h,
 * inflateInit2). */
#define ZLIB_AUTOMATIC 32

struct gz_byte_stream {
	const char *path;
	const struct gz_log *log;
	enum gz_coding coding;
	gz_byte_source *source; /* of plain bytes, instead of the file */
	void *source_user;
	gz_byte_skipper *skip; /* optional, of the source */
	int fd;
	uint64_t stored; /* bytes from the offset to the end of the file */
	uint8_t *input;  /* compressed bytes read, of which [input_at, input_size) are left */
	size_t input_at, input_size;
	z_stream zlib;
	bool zlib_ready;
	bz_stream bzip2;
	bool bzip2_ready;
	ZSTD_DCtx *zstd;
	bool began;  /* the first member */
	bool inside; /* a member or frame has begun and not ended */
	bool hungry; /* the decoder needs input to go on */
	bool ended;
	struct gz_byte_ahead *ahead; /* while it runs, its thread owns the decoder above */
};

enum gz_result gz_file_open(const char *path, const struct gz_log *log, int *out_fd,
			    uint64_t *out_size)
{
	struct stat status;
	/* O_NONBLOCK: opening a pipe without a writer would block for ever. */
	const int fd = open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK);
	if (fd < 0 || fstat(fd, &status) != 0) {
		const int saved = errno;
		gz_err(log, "%s: cannot open the file: %s; check its name and permissions", path,
		       strerror(saved));
		if (fd >= 0)
			close(fd);
		return saved == ENOENT || saved == ENOTDIR ? GZ_ERR_NOT_FOUND : GZ_ERR_IO;
	}
	if (!S_ISREG(status.st_mode)) {
		gz_err(log, "%s: not a regular file; name the file that holds the data", path);
		close(fd);
		return GZ_ERR_FORMAT;
	}
	*out_fd = fd;
	*out_size = (uint64_t)status.st_size;
	return GZ_OK;
}

static enum gz_result open_at_offset(struct gz_byte_stream *stream, uint64_t offset)
{
	uint64_t size;
	const enum gz_result result = gz_file_open(stream->path, stream->log, &stream->fd, &size);
	if (result != GZ_OK)
		return result;
	if (size < offset) {
		gz_err(stream->log,
		       "%s: truncated: data should begin at byte %llu, the file has %llu; fetch it "
		       "again",
		       stream->path, (unsigned long long)offset, (unsigned long long)size);
		return GZ_ERR_FORMAT;
	}
	stream->stored = size - offset;
	if (lseek(stream->fd, (off_t)offset, SEEK_SET) < 0)
		return GZ_ERR_IO;
	(void)posix_fadvise(stream->fd, 0, 0, POSIX_FADV_SEQUENTIAL); /* only a hint */
	return GZ_OK;
}

static enum gz_result open_decoder(struct gz_byte_stream *stream)
{
	if (stream->coding == GZ_CODING_PLAIN)
		return GZ_OK;
	stream->input = malloc(INPUT_SIZE);
	if (stream->coding == GZ_CODING_ZLIB)
		stream->zlib_ready =
			inflateInit2(&stream->zlib, MAX_WBITS + ZLIB_AUTOMATIC) == Z_OK;
	else if (stream->coding == GZ_CODING_BZIP2)
		stream->bzip2_ready = BZ2_bzDecompressInit(&stream->bzip2, 0, 0) == BZ_OK;
	else
		stream->zstd = ZSTD_createDCtx();
	if (stream->input && (stream->zlib_ready || stream->bzip2_ready || stream->zstd))
		return GZ_OK;
	gz_err(stream->log, "%s: no memory to decompress it", stream->path);
	return GZ_ERR_NO_MEM;
}

static struct gz_byte_stream *new_stream(const char *path, enum gz_coding coding,
					 const struct gz_log *log)
{
	struct gz_byte_stream *stream = calloc(1, sizeof *stream);
	if (!stream) {
		gz_err(log, "%s: no memory to read it", path);
		return NULL;
	}
	stream->path = path;
	stream->log = log;
	stream->coding = coding;
	stream->fd = -1;
	stream->hungry = true;
	return stream;
}

enum gz_result gz_byte_stream_open(const char *path, enum gz_coding coding, uint64_t offset,
				   const struct gz_log *log, struct gz_byte_stream **out_stream)
{
	struct gz_byte_stream *stream = new_stream(path, coding, log);
	if (!stream)
		return GZ_ERR_NO_MEM;
	enum gz_result result = open_at_offset(stream, offset);
	if (result == GZ_OK)
		result = open_decoder(stream);
	if (result != GZ_OK) {
		gz_byte_stream_close(&stream);
		return result;
	}
	*out_stream = stream;
	return GZ_OK;
}

enum gz_result gz_byte_stream_from(gz_byte_source *source, void *user, uint64_t bound,
				   const char *path, const struct gz_log *log,
				   struct gz_byte_stream **out_stream)
{
	struct gz_byte_stream *stream = new_stream(path, GZ_CODING_PLAIN, log);
	if (!stream)
		return GZ_ERR_NO_MEM;
	stream->source = source;
	stream->source_user = user;
	stream->stored = bound;
	*out_stream = stream;
	return GZ_OK;
}

void gz_byte_stream_skip_by(struct gz_byte_stream *stream, gz_byte_skipper *skip)
{
	stream->skip = skip;
}

uint64_t gz_byte_stream_bound(const struct gz_byte_stream *stream)
{
	static const uint64_t ratios[] = { 1, ZLIB_RATIO, ZSTD_RATIO, BZIP2_RATIO };
	uint64_t ratio = ratios[stream->coding];
	return stream->stored > UINT64_MAX / ratio ? UINT64_MAX : stream->stored * ratio;
}

static enum gz_result read_file(struct gz_byte_stream *stream, void *buffer, size_t size,
				size_t *out_got)
{
	size_t got = 0;
	while (got < size) {
		ssize_t n = read(stream->fd, (char *)buffer + got, size - got);
		if (n == 0)
			break;
		if (n < 0 && errno == EINTR)
			continue;
		if (n < 0) {
			gz_err(stream->log, "%s: cannot read the file: %s", stream->path,
			       strerror(errno));
			return GZ_ERR_IO;
		}
		got += (size_t)n;
	}
	*out_got = got;
	return GZ_OK;
}

static enum gz_result refuse_damaged(const struct gz_byte_stream *stream, const char *what)
{
	gz_err(stream->log, "%s: damaged compressed data: %s; fetch the file again", stream->path,
	       what);
	return GZ_ERR_FORMAT;
}

/* Read compressed bytes if none are left, or note the end of the file. */
static enum gz_result fill_input(struct gz_byte_stream *stream)
{
	if (stream->input_at < stream->input_size)
		return GZ_OK;
	stream->input_at = 0;
	enum gz_result result = read_file(stream, stream->input, INPUT_SIZE, &stream->input_size);
	if (result != GZ_OK || stream->input_size > 0)
		return result;
	stream->ended = true;
	return stream->inside ? refuse_damaged(stream, "cut off before its end") : GZ_OK;
}

/* One step of zlib into [*got, size) of the buffer. */
static enum gz_result step_zlib(struct gz_byte_stream *stream, uint8_t *buffer, size_t size,
				size_t *got)
{
	z_stream *z = &stream->zlib;
	size_t room = size - *got;
	if (!stream->inside && stream->began) {
		/* Another gzip member begins with 1f (RFC 1952); anything else is ignored. */
		stream->ended = stream->input[stream->input_at] != 0x1f || inflateReset(z) != Z_OK;
		if (stream->ended)
			return GZ_OK;
	}
	stream->inside = stream->began = true;
	z->next_in = stream->input + stream->input_at;
	z->avail_in = (uInt)(stream->input_size - stream->input_at);
	z->next_out = buffer + *got;
	z->avail_out = (uInt)(room < (1u << 30) ? room : 1u << 30);
	int status = inflate(z, Z_NO_FLUSH);
	*got = (size_t)(z->next_out - buffer);
	stream->input_at = stream->input_size - z->avail_in;
	if (status != Z_OK && status != Z_STREAM_END && status != Z_BUF_ERROR)
		return refuse_damaged(stream, z->msg ? z->msg : "not zlib or gzip data");
	stream->inside = status != Z_STREAM_END;
	return GZ_OK;
}

/* One step of zstd into [*got, size) of the buffer. */
static enum gz_result step_zstd(struct gz_byte_stream *stream, uint8_t *buffer, size_t size,
				size_t *got)
{
	ZSTD_inBuffer in = { stream->input, stream->input_size, stream->input_at };
	ZSTD_outBuffer out = { buffer, size, *got };
	size_t left = ZSTD_decompressStream(stream->zstd, &out, &in);
	if (ZSTD_isError(left))
		return refuse_damaged(stream, ZSTD_getErrorName(left));
	stream->inside = left != 0;
	stream->input_at = in.pos;
	*got = out.pos;
	return GZ_OK;
}

/* Begin the next of several streams. False if what follows is none, or there is no memory. */
static bool restart_bzip2(struct gz_byte_stream *stream)
{
	if (stream->input[stream->input_at] != 'B')
		return false;
	BZ2_bzDecompressEnd(&stream->bzip2);
	stream->bzip2 = (bz_stream) { 0 };
	stream->bzip2_ready = BZ2_bzDecompressInit(&stream->bzip2, 0, 0) == BZ_OK;
	return stream->bzip2_ready;
}

/* One step of bzip2 into [*got, size) of the buffer. */
static enum gz_result step_bzip2(struct gz_byte_stream *stream, uint8_t *buffer, size_t size,
				 size_t *got)
{
	bz_stream *b = &stream->bzip2;
	const size_t room = size - *got;
	if (!stream->inside && stream->began) {
		stream->ended = !restart_bzip2(stream);
		if (stream->ended)
			return GZ_OK;
	}
	stream->inside = stream->began = true;
	b->next_in = (char *)stream->input + stream->input_at;
	b->avail_in = (unsigned)(stream->input_size - stream->input_at);
	b->next_out = (char *)buffer + *got;
	b->avail_out = (unsigned)(room < (1u << 30) ? room : 1u << 30);
	const int status = BZ2_bzDecompress(b);
	*got = (size_t)((uint8_t *)b->next_out - buffer);
	stream->input_at = stream->input_size - b->avail_in;
	if (status != BZ_OK && status != BZ_STREAM_END)
		return refuse_damaged(stream, status == BZ_DATA_ERROR
						      ? "wrong bzip2 data or checksum"
						      : "not bzip2 data");
	stream->inside = status != BZ_STREAM_END;
	return GZ_OK;
}

/* One step of the stream's decoder. */
static enum gz_result step_decoder(struct gz_byte_stream *stream, uint8_t *buffer, size_t size,
				   size_t *got)
{
	if (stream->coding == GZ_CODING_ZLIB)
		return step_zlib(stream, buffer, size, got);
	return stream->coding == GZ_CODING_BZIP2 ? step_bzip2(stream, buffer, size, got)
						 : step_zstd(stream, buffer, size, got);
}

static enum gz_result decode_bytes(void *user, void *buffer, size_t size, size_t *out_got)
{
	struct gz_byte_stream *stream = user;
	size_t got = 0;
	while (got < size) {
		enum gz_result result = stream->hungry ? fill_input(stream) : GZ_OK;
		if (result == GZ_OK && !stream->ended)
			result = step_decoder(stream, buffer, size, &got);
		if (result != GZ_OK)
			return result;
		if (stream->ended)
			break;
		/* A decoder that filled the buffer may hold more bytes and need no input. */
		stream->hungry = got < size || !stream->inside;
	}
	*out_got = got;
	return GZ_OK;
}

void gz_byte_stream_read_ahead(struct gz_byte_stream *stream, uint64_t bytes)
{
	if (stream->coding == GZ_CODING_PLAIN || stream->ahead || bytes < AHEAD_BYTES_LEAST)
		return;
	/* On failure the reader decodes the bytes itself. */
	(void)gz_byte_ahead_start(decode_bytes, stream, bytes, &stream->ahead);
}

/* Read what the thread has decoded; after that the reader uses the decoder itself. */
static enum gz_result read_made(struct gz_byte_stream *stream, uint8_t *buffer, size_t size,
				size_t *out_got)
{
	size_t made = 0, own = 0;
	enum gz_result result = gz_byte_ahead_read(stream->ahead, buffer, size, &made);
	if (result == GZ_OK && made < size) {
		gz_byte_ahead_end(&stream->ahead);
		result = decode_bytes(stream, buffer + made, size - made, &own);
	}
	if (result == GZ_OK)
		*out_got = made + own;
	return result;
}

enum gz_result gz_byte_stream_read(struct gz_byte_stream *stream, void *buffer, size_t size,
				   size_t *out_got)
{
	if (stream->source)
		return stream->source(stream->source_user, buffer, size, out_got);
	if (stream->coding == GZ_CODING_PLAIN)
		return read_file(stream, buffer, size, out_got);
	return stream->ahead ? read_made(stream, buffer, size, out_got)
			     : decode_bytes(stream, buffer, size, out_got);
}

enum gz_result gz_byte_stream_skip(struct gz_byte_stream *stream, uint64_t count)
{
	uint8_t scrap[4096];
	if (stream->skip)
		return stream->skip(stream->source_user, count);
	while (count > 0) {
		size_t wanted = count < sizeof scrap ? (size_t)count : sizeof scrap, got = 0;
		enum gz_result result = gz_byte_stream_read(stream, scrap, wanted, &got);
		if (result != GZ_OK)
			return result;
		if (got == 0) {
			gz_err(stream->log,
			       "%s: truncated: it ends %llu bytes before its data begin; fetch it "
			       "again",
			       stream->path, (unsigned long long)count);
			return GZ_ERR_FORMAT;
		}
		count -= got;
	}
	return GZ_OK;
}

void gz_byte_stream_close(struct gz_byte_stream **stream)
{
	struct gz_byte_stream *s = *stream;
	if (!s)
		return;
	gz_byte_ahead_end(&s->ahead);
	if (s->fd >= 0)
		close(s->fd);
	if (s->zlib_ready)
		inflateEnd(&s->zlib);
	if (s->bzip2_ready)
		BZ2_bzDecompressEnd(&s->bzip2);
	ZSTD_freeDCtx(s->zstd);
	free(s->input);
	free(s);
	*stream = NULL;
}
