/* A decoder that does what its last argument says, mostly wrong: for the tests of who watches it.
 */
#include <math.h>
#include <signal.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

#include "render/decode/decode_protocol.h"

static void say(const struct gz_decode_message *message)
{
	if (write(GZ_DECODE_FD_MESSAGES, message, sizeof *message) != sizeof *message)
		_exit(9);
}

static void say_line(int level, const char *text)
{
	struct gz_decode_message message = { .kind = GZ_DECODE_LINE, .detail = level };
	snprintf(message.text, sizeof message.text, "%s", text);
	say(&message);
}

/* A volume of 3 x 2 x 2 bytes. */
static struct gz_decode_message good_header(void)
{
	return (struct gz_decode_message) {
		.kind = GZ_DECODE_HEADER,
		.header = { .dims = { 3, 2, 2 },
			    .spacing = { 1, 1, 2 },
			    .slope = 2,
			    .intercept = -1 },
	};
}

static void say_end(int result)
{
	struct gz_decode_message message = good_header();
	message.kind = GZ_DECODE_ENDED;
	message.detail = result;
	say(&message);
}

static void *wait_for_memory(size_t bytes)
{
	char answer = 0;
	if (read(GZ_DECODE_FD_ANSWERS, &answer, 1) != 1)
		_exit(8);
	const int fd =
		answer == GZ_DECODE_INTO_SCRATCH ? GZ_DECODE_FD_SCRATCH : GZ_DECODE_FD_MEMORY;
	void *memory = mmap(NULL, bytes, PROT_READ | PROT_WRITE, MAP_SHARED, fd, 0);
	if (memory == MAP_FAILED)
		_exit(7);
	return memory;
}

static uint8_t *make_good(void)
{
	const struct gz_decode_message header = good_header();
	say(&header);
	uint8_t *voxels = wait_for_memory(12);
	for (int i = 0; i < 12; i++)
		voxels[i] = (uint8_t)(10 + i);
	return voxels;
}

static void do_good(void)
{
	make_good();
	say_end(0);
}

static void do_good_but_stay(void)
{
	do_good();
	pause();
}

static void do_leave_writer(void)
{
	make_good();
	if (fork() == 0) {
		close(GZ_DECODE_FD_MESSAGES);
		sleep(3);
		_exit(0);
	}
	say_end(0);
}

static void do_crash(void)
{
	signal(SIGSEGV, SIG_DFL); /* a sanitizer would exit */
	raise(SIGSEGV);
}

static void do_crash_with_voxels(void)
{
	make_good();
	do_crash();
}

static void do_exit(void)
{
	_exit(5);
}

static void do_hang(void)
{
	pause();
}

static void do_repeat_step(void)
{
	for (;;) {
		say(&(struct gz_decode_message) {
			.kind = GZ_DECODE_STEP, .detail = 3, .share = 0.5 });
		usleep(1000);
	}
}

static void do_flood_lines(void)
{
	for (;;)
		say_line(2, "again");
}

static void do_flood_steps(void)
{
	for (int i = 0;; i++)
		say(&(struct gz_decode_message) { .kind = GZ_DECODE_STEP, .detail = i });
}

static void do_many_lines(void)
{
	for (int i = 0; i < 100; i++)
		say_line(1, "one of many");
	do_good();
}

static void do_dirty_line(void)
{
	say_line(3, "bell \a escape \x1b[31m next \n c1 \xc2\x9b half \xe2\x82 good \xc3\xa9");
	say_end(-9);
}

static void do_endless_line(void)
{
	struct gz_decode_message message = { .kind = GZ_DECODE_LINE };
	memset(message.text, 'a', sizeof message.text);
	say(&message);
	pause();
}

static void do_quiet_failure(void)
{
	say_end(-10);
}

static void do_unknown_result(void)
{
	say_end(-14);
}

static void do_end_without_voxels(void)
{
	say_end(0);
	pause();
}

/* A good volume, and at the end a header with one fault. */
static void end_otherwise(int first_dim, double slope)
{
	struct gz_decode_message message = good_header();
	make_good();
	message.kind = GZ_DECODE_ENDED;
	message.header.dims[0] = first_dim;
	message.header.slope = slope;
	say(&message);
	pause();
}

/* A good volume, at the end with what is no series. */
static void end_as_series(int time_points, double least, double greatest)
{
	struct gz_decode_message message = good_header();
	make_good();
	message.kind = GZ_DECODE_ENDED;
	message.header.time_points = time_points;
	message.header.number_range[0] = least;
	message.header.number_range[1] = greatest;
	say(&message);
	pause();
}

static void do_series(void)
{
	end_as_series(3, 5, 200);
}

static void do_series_too_long(void)
{
	end_as_series(1000000, 5, 200);
}

static void do_series_beside_its_voxels(void)
{
	end_as_series(3, 15, 200);
}

static void do_series_beyond_its_type(void)
{
	end_as_series(3, 5, 300);
}

static void do_series_without_range(void)
{
	end_as_series(3, NAN, 200);
}

static void do_end_larger(void)
{
	end_otherwise(4, 2);
}

static void do_end_flat(void)
{
	end_otherwise(3, 0);
}

static void do_end_rescaled(void)
{
	end_otherwise(3, 8);
}

static void do_unknown_kind(void)
{
	say(&(struct gz_decode_message) { .kind = 77 });
	pause();
}

static void do_step_nan(void)
{
	say(&(struct gz_decode_message) { .kind = GZ_DECODE_STEP, .share = NAN });
	pause();
}

static void do_two_headers(void)
{
	make_good();
	const struct gz_decode_message header = good_header();
	say(&header);
	pause();
}

/* A series of a list. */
static struct gz_decode_message good_series(void)
{
	return (struct gz_decode_message) {
		.kind = GZ_DECODE_SERIES,
		.series = { .slices = 240,
			    .uid = "1.2.3",
			    .date = "2024-03-31",
			    .modality = "CT",
			    .patient = "M\xc3\xbcller",
			    .description = "chest" },
	};
}

static void say_series(void)
{
	const struct gz_decode_message message = good_series();
	say(&message);
}

static void say_picture(int32_t index, uint32_t band)
{
	struct gz_decode_message message = { .kind = GZ_DECODE_PICTURE, .detail = index };
	message.picture.band = band;
	memset(message.picture.pixels, (int)(10 + band), sizeof message.picture.pixels);
	say(&message);
}

static void say_refused(int32_t index, const char *why)
{
	struct gz_decode_message message = { .kind = GZ_DECODE_REFUSED, .detail = index };
	snprintf(message.text, sizeof message.text, "%s", why);
	say(&message);
}

static void end_list(void)
{
	say(&(struct gz_decode_message) { .kind = GZ_DECODE_LISTED });
}

static void do_list(void)
{
	say_series();
	say_series();
	for (uint32_t band = 0; band < GZ_DECODE_PICTURE_BANDS; band++)
		say_picture(0, band);
	say_refused(1, "not \x1b[31m today");
	end_list();
}

static void do_dirty_series(void)
{
	struct gz_decode_message message = good_series();
	snprintf(message.series.patient, sizeof message.series.patient, "a\nb \xc2\x9b half \xe2");
	say(&message);
	end_list();
}

static void do_crash_in_list(void)
{
	say_series();
	say_picture(0, 0);
	do_crash();
}

static void do_stall_in_list(void)
{
	say_series();
	pause();
}

static void do_flood_series(void)
{
	for (;;)
		say_series();
}

static void do_flood_pictures(void)
{
	say_series();
	for (;;)
		say_picture(0, 0);
}

static void do_flood_refusals(void)
{
	say_series();
	for (;;)
		say_refused(0, "again");
}

static void do_empty_list(void)
{
	end_list();
	pause();
}

static void do_endless_series(void)
{
	struct gz_decode_message message = good_series();
	memset(message.series.uid, '1', sizeof message.series.uid);
	say(&message);
	pause();
}

static void do_negative_series(void)
{
	struct gz_decode_message message = good_series();
	message.series.slices = -1;
	say(&message);
	pause();
}

static void do_picture_of_none(void)
{
	say_series();
	say_picture(1, 0);
	pause();
}

static void do_picture_before_all(void)
{
	say_picture(-1, 0);
	pause();
}

static void do_band_of_none(void)
{
	say_series();
	say_picture(0, GZ_DECODE_PICTURE_BANDS);
	pause();
}

static void do_endless_refusal(void)
{
	struct gz_decode_message message = { .kind = GZ_DECODE_REFUSED };
	memset(message.text, 'a', sizeof message.text);
	say_series();
	say(&message);
	pause();
}

static void do_series_with_voxels(void)
{
	make_good();
	say_series();
	pause();
}

static void do_voxels_with_series(void)
{
	const struct gz_decode_message header = good_header();
	say_series();
	say(&header);
	pause();
}

/* A header with one fault. */
static void say_faulty(const char *fault)
{
	struct gz_decode_message message = good_header();
	struct gz_decode_header *header = &message.header;
	if (strcmp(fault, "dims") == 0)
		header->dims[1] = -2;
	else if (strcmp(fault, "type") == 0)
		header->type = 3;
	else if (strcmp(fault, "spacing") == 0)
		header->spacing[2] = NAN;
	else if (strcmp(fault, "slope") == 0)
		header->slope = 0;
	else if (strcmp(fault, "oriented") == 0)
		header->oriented = 2;
	else if (strcmp(fault, "modality") == 0)
		header->modality = 4; /* one more than there are */
	else if (strcmp(fault, "colour") == 0)
		header->colour = 2; /* alpha, which no decoder gives */
	else if (strcmp(fault, "wide colour") == 0)
		header->colour = header->type = 1;
	else if (strcmp(fault, "huge") == 0)
		header->dims[0] = header->dims[1] = header->dims[2] = 16384;
	say(&message);
	pause();
}

static void do_not_finite(void)
{
	struct gz_decode_message message = good_header();
	message.header.type = 2;
	say(&message);
	float *voxels = wait_for_memory(48);
	voxels[5] = INFINITY;
	message.kind = GZ_DECODE_ENDED;
	say(&message);
}

/* Twelve colours behind the voxels and their padding, of which the last has this weight. */
static void say_colours(uint32_t last_weight)
{
	struct gz_decode_message message = good_header();
	message.header.colour = 1;
	message.header.slope = 1;
	message.header.intercept = 0;
	say(&message);
	uint32_t *colours = (uint32_t *)(void *)((char *)wait_for_memory(128 + 48) + 128);
	for (uint32_t i = 0; i < 12; i++)
		colours[i] = i | (i < 11 ? 255 : last_weight) << 24;
	message.kind = GZ_DECODE_ENDED;
	say(&message);
}

static void do_good_colours(void)
{
	say_colours(255);
}

static void do_light_colours(void)
{
	say_colours(254);
}

static void do_half_message(void)
{
	uint8_t half[100] = { GZ_DECODE_LINE };
	if (write(GZ_DECODE_FD_MESSAGES, half, sizeof half) < 0)
		_exit(9);
}

static const struct {
	const char *name;
	void (*act)(void);
} deeds[] = {
	{ "good", do_good },
	{ "good but stay", do_good_but_stay },
	{ "leave writer", do_leave_writer },
	{ "crash", do_crash },
	{ "crash with voxels", do_crash_with_voxels },
	{ "exit", do_exit },
	{ "hang", do_hang },
	{ "repeat step", do_repeat_step },
	{ "flood lines", do_flood_lines },
	{ "flood steps", do_flood_steps },
	{ "many lines", do_many_lines },
	{ "dirty line", do_dirty_line },
	{ "endless line", do_endless_line },
	{ "quiet failure", do_quiet_failure },
	{ "unknown result", do_unknown_result },
	{ "end without voxels", do_end_without_voxels },
	{ "series", do_series },
	{ "series too long", do_series_too_long },
	{ "series beside its voxels", do_series_beside_its_voxels },
	{ "series beyond its type", do_series_beyond_its_type },
	{ "series without range", do_series_without_range },
	{ "end larger", do_end_larger },
	{ "end flat", do_end_flat },
	{ "end rescaled", do_end_rescaled },
	{ "unknown kind", do_unknown_kind },
	{ "step nan", do_step_nan },
	{ "two headers", do_two_headers },
	{ "not finite", do_not_finite },
	{ "half a message", do_half_message },
	{ "good colours", do_good_colours },
	{ "light colours", do_light_colours },
	{ "list", do_list },
	{ "dirty series", do_dirty_series },
	{ "crash in list", do_crash_in_list },
	{ "stall in list", do_stall_in_list },
	{ "flood series", do_flood_series },
	{ "flood pictures", do_flood_pictures },
	{ "flood refusals", do_flood_refusals },
	{ "empty list", do_empty_list },
	{ "endless series", do_endless_series },
	{ "negative series", do_negative_series },
	{ "picture of none", do_picture_of_none },
	{ "picture before all", do_picture_before_all },
	{ "band of none", do_band_of_none },
	{ "endless refusal", do_endless_refusal },
	{ "series with voxels", do_series_with_voxels },
	{ "voxels with series", do_voxels_with_series },
};

int main(int argc, char **argv)
{
	const char *deed = argc > 4 && argv[4][0] ? argv[4] : NULL;
	/* Through gz_volume_load() there is no choice: the name of the file says what to do. */
	const char *name = argc > 3 ? strrchr(argv[3], '/') : NULL;
	char from_name[64];
	if (!deed && name) {
		snprintf(from_name, sizeof from_name, "%s", name + 1);
		from_name[strcspn(from_name, ".")] = 0;
		for (char *c = from_name; *c; c++)
			*c = *c == '_' ? ' ' : *c;
		deed = from_name;
	}
	for (size_t i = 0; deed && i < sizeof deeds / sizeof deeds[0]; i++)
		if (strcmp(deed, deeds[i].name) == 0) {
			deeds[i].act();
			return 0;
		}
	if (deed)
		say_faulty(deed);
	return 4;
}
