#include "render/decode/child/decoder.h"

#include <limits.h>
#include <stdio.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

#include "base/clock.h"
#include "base/file.h"
#include "base/text.h"
#include "render/decode/decode_protocol.h"

/* Least time between two steps, ns. */
#define STEP_NS (50 * GZ_NS_PER_MS)

static void send_message(const struct gz_decode_message *message)
{
	/* If nobody reads any more, the process has been killed. */
	(void)gz_write_all(GZ_DECODE_FD_MESSAGES, message, sizeof *message);
}

static void send_line(void *user, enum gz_log_level level, const char *module, const char *text)
{
	struct gz_decode_message message = { .kind = GZ_DECODE_LINE, .detail = (int32_t)level };
	(void)user;
	(void)module;
	snprintf(message.text, sizeof message.text, "%s", text);
	send_message(&message);
}

static bool send_step(void *user, double share, const char *what)
{
	struct gz_decoder *decoder = user;
	const int64_t now_ns = gz_clock_now_ns();
	(void)what;
	decoder->steps += decoder->steps < INT32_MAX;
	if (now_ns - decoder->sent_ns < STEP_NS)
		return true;
	const struct gz_decode_message message = { .kind = GZ_DECODE_STEP,
						   .detail = decoder->steps,
						   .share = share };
	decoder->sent_ns = now_ns;
	send_message(&message);
	return true;
}

static struct gz_decode_header header_of(const struct gz_volume *volume)
{
	struct gz_decode_header header = { .type = (uint32_t)volume->type,
					   .oriented = volume->oriented,
					   .labels = volume->labels,
					   .spacing_assumed = volume->spacing_assumed,
					   .modality = (uint8_t)volume->modality,
					   .colour = (uint32_t)volume->colour,
					   .time_points = volume->time_points,
					   .slope = volume->slope,
					   .intercept = volume->intercept,
					   .number_range = { volume->number_range[0],
							     volume->number_range[1] } };
	for (int axis = 0; axis < 3; axis++) {
		header.dims[axis] = volume->dims[axis];
		header.spacing[axis] = volume->spacing[axis];
	}
	return header;
}

static void *ask_for_memory(void *user, const struct gz_volume *volume, size_t bytes)
{
	const struct gz_decode_message message = { .kind = GZ_DECODE_HEADER,
						   .header = header_of(volume) };
	char answer = 0;
	(void)user;
	send_message(&message);
	if (read(GZ_DECODE_FD_ANSWERS, &answer, 1) != 1)
		return NULL;
	const int fd =
		answer == GZ_DECODE_INTO_SCRATCH ? GZ_DECODE_FD_SCRATCH : GZ_DECODE_FD_MEMORY;
	void *memory = mmap(NULL, bytes, PROT_READ | PROT_WRITE, MAP_SHARED, fd, 0);
	return memory == MAP_FAILED ? NULL : memory;
}

static enum gz_result send_series(void *user, const struct gz_decode_series *series)
{
	const struct gz_decode_message message = { .kind = GZ_DECODE_SERIES, .series = *series };
	(void)user;
	send_message(&message);
	return GZ_OK;
}

static void send_picture_rows(void *user, uint32_t index, const struct gz_decode_picture *picture)
{
	const struct gz_decode_message message = { .kind = GZ_DECODE_PICTURE,
						   .detail = (int32_t)index,
						   .picture = *picture };
	(void)user;
	send_message(&message);
}

static void send_refusal(void *user, uint32_t index, const char *why)
{
	struct gz_decode_message message = { .kind = GZ_DECODE_REFUSED, .detail = (int32_t)index };
	(void)user;
	snprintf(message.text, sizeof message.text, "%s", why);
	send_message(&message);
}

void gz_decoder_init(struct gz_decoder *decoder)
{
	*decoder = (struct gz_decoder) { 0 };
	gz_log_init(&decoder->log, send_line, NULL, "*:debug");
	decoder->loading.report = send_step;
	decoder->loading.user = decoder;
	decoder->loading.give_memory = ask_for_memory;
	decoder->listener = (struct gz_decode_listener) {
		.series = send_series,
		.picture = send_picture_rows,
		.refused = send_refusal,
	};
}

bool gz_decoder_take_series(struct gz_decoder *decoder, const char *time_point, char *range)
{
	long long point = 0;
	if (!gz_number_parse_whole(time_point, &point) || point < INT_MIN || point > INT_MAX)
		return false;
	decoder->loading.time_point = (int)point;
	if (!range[0])
		return true;
	for (int i = 0; i < 2; i++) {
		const char *word = gz_number_next_word(&range, " ");
		if (!word || !gz_number_parse(word, &decoder->number_range[i]))
			return false;
	}
	decoder->loading.number_range = decoder->number_range;
	return true;
}

_Noreturn void gz_decoder_end(enum gz_result result, const struct gz_volume *volume)
{
	struct gz_decode_message message = { .kind = GZ_DECODE_ENDED, .detail = (int32_t)result };
	if (result == GZ_OK)
		message.header = header_of(volume);
	if (result == GZ_ERR_CHOICE)
		message = (struct gz_decode_message) { .kind = GZ_DECODE_LISTED };
	send_message(&message);
	_exit(0);
}
