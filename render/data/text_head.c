#include "render/data/text_head.h"

#include <limits.h>
#include <stdlib.h>
#include <string.h>

#include "base/text.h"
#include "render/data/byte_stream.h"

#define GZ_LOG_MODULE "volume"

#define BLANKS " \t\r\v\f"

enum gz_result gz_text_head_open(struct gz_text_head *head, const char *path,
				 const struct gz_log *log)
{
	struct gz_byte_stream *stream = NULL;
	*head = (struct gz_text_head) { .path = path, .log = log };
	head->bytes = malloc(GZ_TEXT_HEAD_MAX + 1);
	if (!head->bytes) {
		gz_err(log, "%s: no memory to read it", path);
		return GZ_ERR_NO_MEM;
	}
	enum gz_result result = gz_byte_stream_open(path, GZ_CODING_PLAIN, 0, log, &stream);
	if (result == GZ_OK)
		result = gz_byte_stream_read(stream, head->bytes, GZ_TEXT_HEAD_MAX, &head->size);
	gz_byte_stream_close(&stream);
	return result;
}

char *gz_text_head_line(struct gz_text_head *head)
{
	if (head->at >= head->size)
		return NULL;
	char *line = head->bytes + head->at;
	char *end = memchr(line, '\n', head->size - head->at);
	if (!end && head->size == GZ_TEXT_HEAD_MAX)
		return NULL;
	if (!end)
		end = head->bytes + head->size;
	head->at = (size_t)(end - head->bytes) + 1;
	if (head->at > head->size)
		head->at = head->size;
	head->line++;
	*end = '\0';
	if (end > line && end[-1] == '\r')
		end[-1] = '\0';
	return line;
}

enum gz_result gz_text_head_refuse(const struct gz_text_head *head, const char *key,
				   const char *what)
{
	gz_err(head->log, "%s:%d: %.40s: %s", head->path, head->line, key, what);
	return GZ_ERR_FORMAT;
}

char *gz_text_trim(char *text)
{
	text += strspn(text, BLANKS);
	size_t length = strlen(text);
	while (length > 0 && strchr(BLANKS, text[length - 1]))
		length--;
	text[length] = '\0';
	return text;
}

bool gz_text_numbers(char *text, double *out_numbers, int count)
{
	for (int i = 0; i < count; i++) {
		char *word = gz_number_next_word(&text, BLANKS);
		if (!word || !gz_number_parse(word, &out_numbers[i]))
			return false;
	}
	return !gz_number_next_word(&text, BLANKS);
}

bool gz_text_wholes(char *text, int *out_numbers, int count)
{
	for (int i = 0; i < count; i++) {
		long long number;
		char *word = gz_number_next_word(&text, BLANKS);
		if (!word || !gz_number_parse_whole(word, &number) || number < INT_MIN ||
		    number > INT_MAX)
			return false;
		out_numbers[i] = (int)number;
	}
	return !gz_number_next_word(&text, BLANKS);
}

void gz_text_head_free(struct gz_text_head *head)
{
	free(head->bytes);
	*head = (struct gz_text_head) { 0 };
}
