#include "render/data/voxel_source.h"

#include <ctype.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/file.h"
#include "render/data/spelled_numbers.h"

#define GZ_LOG_MODULE "volume"

#define BLANKS " \t"

/* Most digits that a pattern asks for. Chosen: more than any number of files has. */
#define DIGITS_MAX 18

/* ---- names of several files ---- */

bool gz_voxel_files_named(const char *value)
{
	return strncmp(value, "LIST", 4) == 0 || strchr(value, '%') != NULL;
}

/* Axes that a file holds, as "2" or "2D"; nothing is 0. */
static bool take_file_axes(char *text, int *out_axes)
{
	long long axes = 0;
	char *word = gz_number_next_word(&text, BLANKS);
	if (word) {
		const size_t length = strlen(word);
		if (length > 1 && toupper((unsigned char)word[length - 1]) == 'D')
			word[length - 1] = '\0';
		if (!gz_number_parse_whole(word, &axes) || axes < 1 || axes > 16 ||
		    gz_number_next_word(&text, BLANKS))
			return false;
	}
	*out_axes = (int)axes;
	return true;
}

static enum gz_result take_name_list(struct gz_voxel_files *files, struct gz_text_head *head,
				     const char *key)
{
	char *line;
	while ((line = gz_text_head_line(head))) {
		const char *name = gz_text_trim(line);
		if (!*name)
			continue;
		gz_text_add_bytes(&files->list, name, strlen(name) + 1);
		files->count++;
	}
	if (files->list.failed) {
		gz_err(head->log, "%s: no memory to read it", head->path);
		return GZ_ERR_NO_MEM;
	}
	if (head->at < head->size)
		return gz_text_head_refuse(head, key, "the list is longer than 256 KiB");
	return files->count ? GZ_OK : gz_text_head_refuse(head, key, "no names follow the LIST");
}

/* "name%03d.raw" in parts. No other conversion is understood, and only one. */
static bool take_name_pattern(struct gz_voxel_files *files, const char *pattern)
{
	const char *start = strchr(pattern, '%');
	if (!start || strlen(pattern) >= sizeof files->pattern)
		return false;
	const char *end = start + 1;
	int digits = 0;
	/* A width with zeros in front, or a precision: both fill up with zeros. */
	const bool filled = *end == '0' || *end == '.';
	end += filled;
	for (; isdigit((unsigned char)*end) && digits <= DIGITS_MAX; end++)
		digits = 10 * digits + (*end - '0');
	if (digits > DIGITS_MAX || (digits > 1 && !filled) || !*end || !strchr("diu", *end) ||
	    strchr(end, '%'))
		return false;
	memcpy(files->pattern, pattern, strlen(pattern) + 1);
	files->number_at = (size_t)(start - pattern);
	files->number_end = (size_t)(end - pattern) + 1;
	files->digits = digits;
	return true;
}

static bool take_number_range(struct gz_voxel_files *files, char **text)
{
	long long number[3];
	for (int i = 0; i < 3; i++) {
		char *word = gz_number_next_word(text, BLANKS);
		if (!word || !gz_number_parse_whole(word, &number[i]) || number[i] < INT32_MIN ||
		    number[i] > INT32_MAX)
			return false;
	}
	const long long step = number[2], way = number[1] - number[0];
	if (step == 0 || way % step != 0 || way / step < 0 || way / step >= GZ_VOLUME_DIM_MAX * 4)
		return false;
	files->first = number[0];
	files->step = step;
	files->count = (int)(way / step) + 1;
	return files->first >= 0 && number[1] >= 0;
}

enum gz_result gz_voxel_files_take(struct gz_voxel_files *files, struct gz_text_head *head,
				   char *value, const char *key, int *out_axes)
{
	char *word = gz_number_next_word(&value, BLANKS);
	if (word && strcmp(word, "LIST") == 0) {
		if (!take_file_axes(value, out_axes))
			return gz_text_head_refuse(head, key,
						   "after LIST: the number of axes of a file");
		return take_name_list(files, head, key);
	}
	if (!word || !take_name_pattern(files, word) || !take_number_range(files, &value) ||
	    !take_file_axes(value, out_axes))
		return gz_text_head_refuse(head, key,
					   "write LIST, or \"name%03d.raw FIRST LAST STEP\"");
	return GZ_OK;
}

enum gz_result gz_voxel_source_share(struct gz_voxel_source *source,
				     const struct gz_text_head *head, const int *sizes,
				     int dimension, int file_axes)
{
	const int count = source->files.count;
	uint64_t all = 1, upper = 1;
	if (count == 0)
		return GZ_OK;
	const int axes = file_axes ? file_axes : dimension - 1;
	for (int i = 0; i < dimension; i++) {
		const uint64_t size = sizes[i] > 0 ? (uint64_t)sizes[i] : 0;
		if (__builtin_mul_overflow(all, size, &all) ||
		    (i >= axes && __builtin_mul_overflow(upper, size, &upper)))
			all = 0;
	}
	/* Files that hold all axes share the slowest. */
	const bool fits =
		axes >= dimension ? sizes[dimension - 1] % count == 0 : upper == (uint64_t)count;
	if (all == 0 || axes > dimension || !fits) {
		gz_err(head->log,
		       "%s: %d files of %d axes do not make up the sizes; correct the names or "
		       "sizes",
		       head->path, count, axes);
		return GZ_ERR_FORMAT;
	}
	source->numbers_per_file = all / (uint64_t)count;
	return GZ_OK;
}

void gz_voxel_source_free(struct gz_voxel_source *source)
{
	gz_text_free(&source->files.list);
}

/* ---- one file ---- */

/* A file of voxels that is open. */
struct voxel_file {
	char path[GZ_PATH_SIZE];
	struct gz_byte_stream *bytes; /* decompressed */
	struct gz_spelled_numbers spelled;
	struct gz_byte_stream *numbers; /* what the bytes spell; NULL: they are the numbers */
};

static void close_voxel_file(struct voxel_file *file)
{
	gz_byte_stream_close(&file->numbers);
	gz_byte_stream_close(&file->bytes);
}

/* The stream that gives binary numbers. */
static struct gz_byte_stream *voxel_stream(const struct voxel_file *file)
{
	return file->numbers ? file->numbers : file->bytes;
}

/* The byte after `lines` lines from `offset` on. */
static enum gz_result skip_file_lines(const char *path, const struct gz_voxel_source *source,
				      const struct gz_log *log, uint64_t *offset)
{
	struct gz_text_head data = { 0 };
	if (source->line_skip == 0)
		return GZ_OK;
	enum gz_result result = gz_text_head_open(&data, path, log);
	if (result == GZ_OK) {
		data.at = (size_t)*offset;
		for (int i = 0; i < source->line_skip && result == GZ_OK; i++)
			if (!gz_text_head_line(&data))
				result = gz_text_head_refuse(&data, "line skip",
							     "more lines than the file has");
		*offset = data.at;
	}
	gz_text_head_free(&data);
	return result;
}

/* Bytes to skip in an open file that should give `numbers` numbers. What is missing shows later. */
static uint64_t bytes_to_skip(const struct gz_voxel_source *source, const struct voxel_file *file,
			      uint64_t numbers, enum gz_raw_type type)
{
	if (source->skip != GZ_SKIP_TO_END)
		return (uint64_t)source->skip;
	const uint64_t there = gz_byte_stream_bound(file->bytes);
	const uint64_t needed = numbers * gz_raw_type_size(type);
	return needed < there ? there - needed : 0;
}

static enum gz_result open_spelled(struct voxel_file *file, enum gz_spelling spelling,
				   enum gz_raw_type type, const struct gz_log *log)
{
	const uint64_t characters = gz_byte_stream_bound(file->bytes);
	/* A number is at least a digit and what separates it from the next. */
	const uint64_t bound = spelling == GZ_SPELLING_HEX
				       ? characters / 2
				       : (characters / 2 + 1) * gz_raw_type_size(type);
	file->spelled = (struct gz_spelled_numbers) {
		.bytes = file->bytes,
		.path = file->path,
		.log = log,
		.type = type,
	};
	return gz_byte_stream_from(spelling == GZ_SPELLING_HEX ? gz_spelled_hex_read
							       : gz_spelled_text_read,
				   &file->spelled, bound, file->path, log, &file->numbers);
}

/* Open file->path at its first voxel; `numbers` is how many it should have. */
static enum gz_result open_voxel_file(struct voxel_file *file, const struct gz_voxel_source *source,
				      uint64_t numbers, enum gz_raw_type type,
				      const struct gz_log *log)
{
	uint64_t offset = source->offset;
	enum gz_result result = skip_file_lines(file->path, source, log, &offset);
	if (result == GZ_OK)
		result = gz_byte_stream_open(file->path, source->coding, offset, log, &file->bytes);
	if (result == GZ_OK)
		result = gz_byte_stream_skip(file->bytes,
					     bytes_to_skip(source, file, numbers, type));
	if (result == GZ_OK && source->spelling != GZ_SPELLING_BINARY)
		result = open_spelled(file, source->spelling, type, log);
	if (result != GZ_OK)
		close_voxel_file(file);
	return result;
}

/* ---- several files ---- */

/* The files as one stream. */
struct file_chain {
	const struct gz_voxel_source *source;
	const struct gz_log *log;
	enum gz_raw_type type;
	struct voxel_file file;
	int next;              /* index of the file after the open one */
	const char *next_name; /* of a list */
	uint64_t left;         /* bytes of numbers to read from the open file */
	bool told_more;
};

/* The next file's path, beside the header. */
static enum gz_result next_chain_path(struct file_chain *chain)
{
	const struct gz_voxel_files *files = &chain->source->files;
	char made[GZ_PATH_SIZE];
	const char *name = made;
	enum gz_result result = GZ_OK;
	if (files->list.bytes) {
		name = chain->next_name ? chain->next_name : files->list.bytes;
		chain->next_name = name + strlen(name) + 1;
	} else {
		result = gz_text_print(made, sizeof made, "%.*s%0*lld%s", (int)files->number_at,
				       files->pattern, files->digits,
				       files->first + chain->next * files->step,
				       files->pattern + files->number_end);
	}
	if (result == GZ_OK)
		result = gz_path_beside(chain->source->path, name, chain->file.path,
					sizeof chain->file.path);
	chain->next++;
	if (result != GZ_OK)
		gz_err(chain->log, "%s: the name of a file of voxels is too long",
		       chain->source->path);
	return result;
}

static enum gz_result open_next_file(struct file_chain *chain)
{
	const uint64_t numbers = chain->source->numbers_per_file;
	enum gz_result result = next_chain_path(chain);
	if (result == GZ_OK)
		result = open_voxel_file(&chain->file, chain->source, numbers, chain->type,
					 chain->log);
	chain->left = numbers * gz_raw_type_size(chain->type);
	return result;
}

/* More in a file than its share is a sign that the sizes are wrong. Told once. */
static enum gz_result end_chain_file(struct file_chain *chain)
{
	uint8_t scrap[8];
	size_t got = 0;
	const enum gz_result result =
		gz_byte_stream_read(voxel_stream(&chain->file), scrap, sizeof scrap, &got);
	if (result == GZ_OK && got > 0 && !chain->told_more) {
		chain->told_more = true;
		gz_warn(chain->log,
			"%s: there are more data after its voxels; they are left out; are sizes "
			"and "
			"type right?",
			chain->file.path);
	}
	close_voxel_file(&chain->file);
	return result;
}

static enum gz_result read_chain(void *user, void *buffer, size_t size, size_t *out_got)
{
	struct file_chain *chain = user;
	size_t got = 0;
	enum gz_result result = GZ_OK;
	while (got < size && result == GZ_OK) {
		if (!chain->file.bytes) {
			if (chain->next == chain->source->files.count)
				break;
			result = open_next_file(chain);
			continue;
		}
		const size_t wanted = chain->left < size - got ? (size_t)chain->left : size - got;
		size_t part = 0;
		result = gz_byte_stream_read(voxel_stream(&chain->file), (uint8_t *)buffer + got,
					     wanted, &part);
		got += part;
		chain->left -= part;
		if (result == GZ_OK && part < wanted) {
			gz_err(chain->log, "%s: truncated: %llu bytes of voxels are missing",
			       chain->file.path, (unsigned long long)chain->left);
			result = GZ_ERR_FORMAT;
		} else if (result == GZ_OK && chain->left == 0) {
			result = end_chain_file(chain);
		}
	}
	*out_got = got;
	return result;
}

/* The most bytes of numbers that the files can give, up to the first that is too short. Opens the
 * files that `needed` bytes take. */
static enum gz_result bound_chain(const struct file_chain *model, uint64_t needed,
				  uint64_t *out_bound)
{
	struct file_chain chain = *model;
	enum gz_result result = GZ_OK;
	uint64_t bound = 0;
	while (result == GZ_OK && bound < needed && chain.next < chain.source->files.count) {
		result = open_next_file(&chain);
		if (result != GZ_OK)
			break;
		const uint64_t there = gz_byte_stream_bound(voxel_stream(&chain.file));
		bound += there < chain.left ? there : chain.left;
		close_voxel_file(&chain.file);
		if (there < chain.left)
			break;
	}
	*out_bound = bound;
	return result;
}

/* ---- import ---- */

/* Of so many time points. */
static uint64_t layout_numbers(const struct gz_import_layout *layout, int points)
{
	uint64_t numbers = points > 1 && points <= GZ_TIME_POINTS_MAX ? (uint64_t)points : 1;
	numbers *= layout->channels > 1 ? (uint64_t)layout->channels : 1;
	for (int axis = 0; axis < 3; axis++) {
		const int dim = layout->dims[axis];
		/* What is out of range is refused by gz_volume_import(). */
		numbers *= dim > 0 && dim <= GZ_VOLUME_DIM_MAX ? (uint64_t)dim : 0;
	}
	return numbers;
}

static enum gz_result import_chain(const struct gz_voxel_source *source,
				   const struct gz_import_layout *layout,
				   const struct gz_volume_file *file, struct gz_volume *out_volume)
{
	struct file_chain *chain = calloc(1, sizeof *chain);
	struct gz_byte_stream *stream = NULL;
	uint64_t bound = 0;
	if (!chain) {
		gz_err(file->log, "%s: no memory to read it", source->path);
		return GZ_ERR_NO_MEM;
	}
	*chain = (struct file_chain) { .source = source, .log = file->log, .type = layout->type };
	/* Without the files of later time points, those before them can be shown. */
	const uint64_t needed =
		layout_numbers(layout, file->loading ? file->loading->time_point + 1 : 1);
	enum gz_result result = bound_chain(chain, needed * gz_raw_type_size(layout->type), &bound);
	if (result == GZ_OK)
		result = gz_byte_stream_from(read_chain, chain, bound, source->path, file->log,
					     &stream);
	if (result == GZ_OK)
		result = gz_volume_import(stream, layout, file, out_volume);
	gz_byte_stream_close(&stream);
	close_voxel_file(&chain->file);
	free(chain);
	return result;
}

static enum gz_result import_single(const struct gz_voxel_source *source,
				    const struct gz_import_layout *layout,
				    const struct gz_volume_file *file, struct gz_volume *out_volume)
{
	struct voxel_file *single = calloc(1, sizeof *single);
	if (!single) {
		gz_err(file->log, "%s: no memory to read it", source->path);
		return GZ_ERR_NO_MEM;
	}
	memcpy(single->path, source->path, sizeof single->path);
	enum gz_result result =
		open_voxel_file(single, source, layout_numbers(layout, layout->time_points),
				layout->type, file->log);
	if (result == GZ_OK)
		result = gz_volume_import(voxel_stream(single), layout, file, out_volume);
	close_voxel_file(single);
	free(single);
	return result;
}

enum gz_result gz_voxel_source_import(const struct gz_voxel_source *source,
				      const struct gz_import_layout *layout,
				      const struct gz_volume_file *file,
				      struct gz_volume *out_volume)
{
	struct gz_volume_file data = *file;
	struct gz_import_layout numbers = *layout;
	data.path = source->path;
	if (source->skip == GZ_SKIP_TO_END &&
	    (source->coding != GZ_CODING_PLAIN || source->spelling != GZ_SPELLING_BINARY)) {
		gz_err(data.log,
		       "%s: compressed data and text cannot be found from the end; give what to "
		       "skip",
		       source->path);
		return GZ_ERR_FORMAT;
	}
	if (source->spelling == GZ_SPELLING_TEXT)
		numbers.big_endian = gz_host_big_endian();
	return source->files.count > 0 ? import_chain(source, &numbers, &data, out_volume)
				       : import_single(source, &numbers, &data, out_volume);
}
