/* PNG files by libpng: pictures, and the texts beside them. */
#define GZ_LOG_MODULE "image"
#include "render/picture/image.h"

#include <errno.h>
#include <fcntl.h>
#include <png.h>
#include <setjmp.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

/* Measured on a rendered head of 1024 x 1024 pixels: level 2 takes a quarter of the time of zlib's
 * default of 6 and a quarter more bytes; the filter "up" saves a tenth of them over "sub". */
#define PNG_COMPRESSION_LEVEL 2

static void on_png_error(png_structp png, png_const_charp message)
{
	(void)message; /* errno says more */
	png_longjmp(png, 1);
}

static void ignore_png_warning(png_structp png, png_const_charp message)
{
	(void)png;
	(void)message;
}

/* What is written to a file: an image, or rows that are made. */
struct content {
	const struct gz_image *image;
	const struct gz_image_text *texts;
	size_t text_count;
	const struct gz_image_rows *rows; /* NULL: the image */
	uint8_t *greys;                   /* room for one of them */
	enum gz_result *made;             /* the first failure of them */
};

static void set_texts(png_structp png, png_infop info, const struct content *content)
{
	for (size_t i = 0; i < content->text_count; i++) {
		/* libpng copies both strings and does not write to them. */
		png_text entry = { 0 };
		entry.compression = PNG_ITXT_COMPRESSION_NONE;
		entry.key = (png_charp)(uintptr_t)content->texts[i].keyword;
		entry.text = (png_charp)(uintptr_t)content->texts[i].text;
		png_set_text(png, info, &entry, 1);
	}
}

static void write_header(png_structp png, png_infop info, const struct content *content)
{
	const bool grey = content->rows;
	const int width = grey ? content->rows->width : content->image->width;
	const int height = grey ? content->rows->height : content->image->height;
	png_set_compression_level(png, PNG_COMPRESSION_LEVEL);
	png_set_filter(png, PNG_FILTER_TYPE_BASE, PNG_FILTER_UP);
	png_set_IHDR(png, info, (png_uint_32)width, (png_uint_32)height, 8,
		     grey ? PNG_COLOR_TYPE_GRAY : PNG_COLOR_TYPE_RGB, PNG_INTERLACE_NONE,
		     PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
	set_texts(png, info, content);
	png_write_info(png, info);
}

static bool write_grey_rows(png_structp png, const struct content *content)
{
	for (int y = 0; y < content->rows->height; y++) {
		*content->made = content->rows->make(content->rows->user, y, content->greys);
		if (*content->made != GZ_OK)
			return false;
		png_write_row(png, content->greys);
	}
	return true;
}

/* Changes no local variable after setjmp, so that longjmp leaves none undefined. */
static bool write_rows(png_structp png, png_infop info, FILE *file, const struct content *content)
{
	const struct gz_image *image = content->image;
	if (setjmp(png_jmpbuf(png)))
		return false;
	png_init_io(png, file);
	write_header(png, info, content);
	if (content->rows) {
		if (!write_grey_rows(png, content))
			return false;
	} else {
		png_set_filler(png, 0, PNG_FILLER_AFTER); /* leaves out A of each pixel */
		for (int y = 0; y < image->height; y++)
			png_write_row(png, image->pixels + (size_t)y * (size_t)image->width * 4);
	}
	png_write_end(png, NULL);
	return true;
}

static bool write_stream(FILE *file, const struct content *content)
{
	png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, NULL, on_png_error,
						  ignore_png_warning);
	png_infop info = png ? png_create_info_struct(png) : NULL;
	bool written = info && write_rows(png, info, file, content);
	png_destroy_write_struct(&png, &info);
	return written;
}

/* The file under its temporary name, so that the final name never holds half a picture. */
static FILE *open_temporary(const char *name)
{
	int fd = open(name, O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
	if (fd < 0)
		return NULL;
	FILE *file = fdopen(fd, "wb");
	if (!file) {
		close(fd);
		unlink(name);
	}
	return file;
}

/* On failure errno tells why. */
static bool write_and_close(FILE *file, const struct content *content)
{
	errno = 0;
	bool written = write_stream(file, content) && fflush(file) == 0;
	int saved = errno;
	if (fclose(file) != 0 && written) {
		written = false;
		saved = errno;
	}
	errno = saved ? saved : EIO;
	return written;
}

static bool write_regular(const struct content *content, const char *path)
{
	char *name = NULL;
	if (asprintf(&name, "%s.%ld.part", path, (long)getpid()) < 0)
		return false;
	FILE *file = open_temporary(name);
	bool written = false;
	if (file) {
		written = write_and_close(file, content) && rename(name, path) == 0;
		int saved = errno;
		if (!written)
			unlink(name);
		errno = saved;
	}
	free(name);
	return written;
}

/* A device or pipe is written to; it must not be replaced by a file. */
static bool write_special(const struct content *content, const char *path)
{
	FILE *file = fopen(path, "wb");
	return file && write_and_close(file, content);
}

enum gz_result gz_image_write_png(const struct gz_image *image, const char *path,
				  const struct gz_log *log)
{
	return gz_image_write_png_with(image, NULL, 0, path, log);
}

static enum gz_result write_content(const struct content *content, const char *path,
				    const struct gz_log *log)
{
	struct stat status;
	bool special = stat(path, &status) == 0 && !S_ISREG(status.st_mode);
	if (special ? write_special(content, path) : write_regular(content, path))
		return GZ_OK;
	if (content->made && *content->made != GZ_OK)
		return *content->made;
	gz_err(log, "%s: cannot write the picture: %s; name a writable folder with free space",
	       path, strerror(errno));
	return GZ_ERR_IO;
}

enum gz_result gz_image_write_png_with(const struct gz_image *image,
				       const struct gz_image_text *texts, size_t count,
				       const char *path, const struct gz_log *log)
{
	const struct content content = { .image = image, .texts = texts, .text_count = count };
	if (!image->pixels || image->width < 1 || image->height < 1)
		return GZ_ERR_INVAL;
	return write_content(&content, path, log);
}

enum gz_result gz_image_write_grey_png(const struct gz_image_rows *rows, const char *path,
				       const struct gz_log *log)
{
	enum gz_result made = GZ_OK;
	if (rows->width < 1 || rows->height < 1 || rows->width > GZ_IMAGE_ROWS_MAX ||
	    rows->height > GZ_IMAGE_ROWS_MAX)
		return GZ_ERR_INVAL;
	const struct content content = { .rows = rows,
					 .greys = malloc((size_t)rows->width),
					 .made = &made };
	if (!content.greys)
		return GZ_ERR_NO_MEM;
	const enum gz_result result = write_content(&content, path, log);
	free(content.greys);
	return result;
}

/* Most bytes that a byte of deflate unpacks to (RFC 1951: 258 of 2 bits). */
#define UNPACKED_BYTES_MAX 1032

/* Whether a file can hold as many pixels as it claims, of one bit at least, and a byte for the
 * filter of each row: no memory is taken for more. What is no regular file may hold any. */
static bool may_hold_pixels(const png_image *png, FILE *file)
{
	struct stat status;
	const uint64_t least = (uint64_t)png->height * (1 + (png->width + 7) / 8);
	return fstat(fileno(file), &status) != 0 || !S_ISREG(status.st_mode) ||
	       least <= (uint64_t)status.st_size * UNPACKED_BYTES_MAX;
}

static enum gz_result check_png_size(const png_image *png, FILE *file, const char *path,
				     const struct gz_log *log)
{
	if (png->width > GZ_IMAGE_SIDE_MAX || png->height > GZ_IMAGE_SIDE_MAX)
		gz_err(log, "%s: %u x %u pixels; at most %d a side are read", path, png->width,
		       png->height, GZ_IMAGE_SIDE_MAX);
	else if (!may_hold_pixels(png, file))
		gz_err(log, "%s: damaged PNG: the file is too short for %u x %u pixels", path,
		       png->width, png->height);
	else
		return GZ_OK;
	return GZ_ERR_FORMAT;
}

static enum gz_result read_pixels(png_image *png, const char *path, const struct gz_log *log,
				  struct gz_image *out_image)
{
	struct gz_image image = { 0 };
	if (gz_image_resize(&image, (int)png->width, (int)png->height) != GZ_OK) {
		gz_err(log, "%s: no memory for %u x %u pixels", path, png->width, png->height);
		return GZ_ERR_NO_MEM;
	}
	png->format = PNG_FORMAT_RGBA;
	if (!png_image_finish_read(png, NULL, image.pixels, 0, NULL)) {
		gz_err(log, "%s: damaged PNG: %s", path, png->message);
		gz_image_free(&image);
		return GZ_ERR_FORMAT;
	}
	size_t count = (size_t)image.width * (size_t)image.height;
	for (size_t i = 0; i < count; i++)
		image.pixels[4 * i + 3] = 255;
	gz_image_free(out_image);
	*out_image = image;
	return GZ_OK;
}

/* Open a PNG and read its head. On success the caller frees the struct and closes the file. */
static enum gz_result begin_png(const char *path, const struct gz_log *log, png_image *png,
				FILE **out_file)
{
	FILE *file = fopen(path, "rb");
	if (!file) {
		gz_err(log, "%s: cannot open the picture: %s", path, strerror(errno));
		return GZ_ERR_NOT_FOUND;
	}
	*png = (png_image) { .version = PNG_IMAGE_VERSION };
	if (png_image_begin_read_from_stdio(png, file)) {
		*out_file = file;
		return GZ_OK;
	}
	gz_err(log, "%s: not a PNG picture: %s", path, png->message);
	png_image_free(png);
	fclose(file);
	return GZ_ERR_FORMAT;
}

enum gz_result gz_image_read_png(const char *path, const struct gz_log *log,
				 struct gz_image *out_image)
{
	png_image png;
	FILE *file;
	enum gz_result result = begin_png(path, log, &png, &file);
	if (result != GZ_OK)
		return result;
	png.flags |= PNG_IMAGE_FLAG_16BIT_sRGB; /* else libpng takes 16 bits as linear */
	result = check_png_size(&png, file, path, log);
	if (result == GZ_OK)
		result = read_pixels(&png, path, log, out_image);
	png_image_free(&png);
	fclose(file);
	return result;
}

enum gz_result gz_image_measure_png(const char *path, const struct gz_log *log, int out_size[2])
{
	png_image png;
	FILE *file;
	enum gz_result result = begin_png(path, log, &png, &file);
	if (result != GZ_OK)
		return result;
	result = check_png_size(&png, file, path, log);
	if (result == GZ_OK) {
		out_size[0] = (int)png.width;
		out_size[1] = (int)png.height;
	}
	png_image_free(&png);
	fclose(file);
	return result;
}

/* A chunk may be so much longer than its text: keyword, language, translated keyword. */
enum { AROUND_TEXT = 1024 };

/* Chunks that are skipped, so that none takes the memory that it claims. libpng takes each name
 * with its NUL. */
static const png_byte unused_chunks[] = "bKGD\0cHRM\0eXIf\0gAMA\0hIST\0iCCP\0oFFs\0pCAL\0sBIT\0"
					"sCAL\0sPLT\0sTER\0sRGB\0tIME";

/* Texts that are being read. */
struct text_search {
	bool damaged; /* a chunk of text could not be read */
};

/* libpng warns of a damaged chunk that it leaves out, by "tEXt: …". It only warns of a chunk above
 * the limit too, before it allocates the length that the chunk claims: reading ends there. */
static void note_damaged_text(png_structp png, png_const_charp message)
{
	struct text_search *search = png_get_error_ptr(png);
	static const char *const types[] = { "tEXt", "zTXt", "iTXt" };
	bool text = false;
	for (size_t i = 0; i < sizeof types / sizeof types[0]; i++)
		text |= strncmp(message, types[i], strlen(types[i])) == 0;
	search->damaged |= text;
	if (text && strstr(message, "too large"))
		png_longjmp(png, 1);
}

/* Read the chunks before the pixels into @p info. Returns false if the file is no PNG or damaged;
 * texts before the damage are in @p info all the same. */
static bool read_first_chunks(png_structp png, png_infop info, FILE *file)
{
	if (setjmp(png_jmpbuf(png)))
		return false;
	png_init_io(png, file);
	png_set_user_limits(png, GZ_IMAGE_SIDE_MAX, GZ_IMAGE_SIDE_MAX);
	png_set_chunk_malloc_max(png, GZ_IMAGE_TEXT_MAX + AROUND_TEXT);
	png_set_keep_unknown_chunks(png, PNG_HANDLE_CHUNK_NEVER, unused_chunks,
				    sizeof unused_chunks / 5);
	png_read_info(png, info);
	return true;
}

/* Read the chunks behind the pixels. libpng finds them only by decoding all rows. */
static bool read_last_chunks(png_structp png, png_infop info)
{
	if (setjmp(png_jmpbuf(png)))
		return false;
	const int passes = png_set_interlace_handling(png);
	png_read_update_info(png, info);
	for (int pass = 0; pass < passes; pass++)
		for (png_uint_32 y = 0; y < png_get_image_height(png, info); y++)
			png_read_row(png, NULL, NULL);
	png_read_end(png, info);
	return true;
}

static const png_text *find_png_text(png_structp png, png_infop info, const char *keyword)
{
	png_textp texts = NULL;
	const int count = png_get_text(png, info, &texts, NULL);
	for (int i = 0; i < count; i++)
		if (strcmp(texts[i].key, keyword) == 0)
			return &texts[i];
	return NULL;
}

enum gz_result gz_image_find_text(FILE *file, const char *keyword, struct gz_text *out_text)
{
	struct text_search search = { .damaged = false };
	png_structp png = png_create_read_struct(PNG_LIBPNG_VER_STRING, &search, on_png_error,
						 note_damaged_text);
	png_infop info = png ? png_create_info_struct(png) : NULL;
	enum gz_result result = GZ_ERR_NO_MEM;
	if (info) {
		bool whole = read_first_chunks(png, info, file);
		const png_text *found = find_png_text(png, info, keyword);
		if (whole && !found) {
			whole = read_last_chunks(png, info);
			found = find_png_text(png, info, keyword);
		}
		result = whole && !found && !search.damaged ? GZ_ERR_NOT_FOUND : GZ_ERR_FORMAT;
		if (found && strlen(found->text) <= GZ_IMAGE_TEXT_MAX) {
			gz_text_add(out_text, "%s", found->text);
			result = out_text->failed ? GZ_ERR_NO_MEM : GZ_OK;
		}
	}
	png_destroy_read_struct(&png, &info, NULL);
	return result;
}
