/* Sessions: what is written is read back to the bit, and what nobody can have written is refused
 * with its line. */
#include "suite.h"

#include <fcntl.h>
#include <math.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/captured_log.h"
#include "protocol/gaze_log.h"
#include "render/plan/method.h"
#include "view/session/session.h"
#include "view/session/session_reader.h"
#include "view/session/session_writer.h"

static const char scene_text[] = "[volume]\nprocedural = shells\ndims = 8 8 8\n"
				 "[transfer]\nfile = a.tf\n[camera]\neye = 0.1 -2 0.3\n";

struct fixture {
	struct captured_log log;
	char folder[64];
	char path[96]; /* of the session */
	struct gz_scene_settings settings;
	struct gz_transfer transfer;
	struct gz_volume volume;
	struct gz_display display;
	struct gz_session_state state; /* as it is read */
};

static int set_up(void **state)
{
	static const char tf[] = "0 0 0 0 0\n1 1 1 1 1\n";
	static const double spacing[3] = { 1, 1, 1 };
	static const int dims[3] = { 8, 8, 8 };
	struct fixture *self = calloc(1, sizeof *self);
	bool has_display;
	assert_non_null(self);
	captured_log_init(&self->log, NULL);
	strcpy(self->folder, "/tmp/gazecast-test-session-XXXXXX");
	assert_non_null(mkdtemp(self->folder));
	snprintf(self->path, sizeof self->path, "%s/a.session", self->folder);
	assert_int_equal(gz_scene_parse("a.scene", scene_text, sizeof scene_text - 1, NULL,
					&self->settings, &has_display),
			 GZ_OK);
	assert_int_equal(gz_transfer_parse("a.tf", tf, sizeof tf - 1, NULL, &self->transfer),
			 GZ_OK);
	assert_int_equal(
		gz_volume_generate(&(struct gz_procedural_request) { GZ_PROCEDURAL_SHELLS, dims,
								     spacing, GZ_VOXEL_U8 },
				   NULL, NULL, &self->volume),
		GZ_OK);
	self->display = gz_display_default(64, 48);
	*state = self;
	return 0;
}

static int tear_down(void **state)
{
	static const char *const names[] = { GZ_SESSION_SCENE,  GZ_SESSION_TRANSFER,
					     GZ_SESSION_FRAMES, GZ_SESSION_GAZE,
					     "table-1.txt",     "table-2.txt" };
	struct fixture *self = *state;
	char path[160];
	for (size_t i = 0; i < sizeof names / sizeof names[0]; i++) {
		snprintf(path, sizeof path, "%s/%s", self->path, names[i]);
		unlink(path);
	}
	rmdir(self->path);
	rmdir(self->folder);
	gz_volume_free(&self->volume);
	free(self);
	return 0;
}

static struct gz_session_frame make_frame(const struct fixture *self, int64_t time_ns)
{
	return (struct gz_session_frame) {
		.time_ns = time_ns,
		.width = 64,
		.height = 48,
		.display = self->display,
		.reading = { .known = true, .point = { 0.1F, 1.0F / 3 }, .noise_deg = NAN },
		.focus = { .point = { 0.7F, 0.2F }, .scale = sqrt(2), .widen = 1.0 / 3 },
		.took_ms = 12.5,
	};
}

static struct gz_session_writer *begin(struct fixture *self)
{
	struct gz_session_writer *writer = NULL;
	const struct gz_session_start start = {
		.path = self->path,
		.scene = "a.scene",
		.settings = &self->settings,
		.transfer = &self->transfer,
		.volume = &self->volume,
		.display = &self->display,
		.software = "gazeview test",
		.backend = "cpu",
		.source = "mouse",
		.rate_hz = 60,
		.now_ns = 1000,
	};
	assert_int_equal(gz_session_writer_begin(&start, &self->log.log, &writer), GZ_OK);
	self->state.settings = self->settings;
	self->state.transfer = self->transfer;
	return writer;
}

static void add(struct fixture *self, struct gz_session_writer *writer, int64_t time_ns)
{
	const struct gz_session_frame frame = make_frame(self, time_ns);
	assert_int_equal(gz_session_writer_add(writer, &self->settings, &self->transfer, &frame),
			 GZ_OK);
}

static struct gz_session_reader *open_it(struct fixture *self)
{
	struct gz_session_reader *reader = NULL;
	assert_int_equal(gz_session_open(self->path, &self->log.log, &reader), GZ_OK);
	return reader;
}

static void check_same_frame(const struct gz_session_frame *a, const struct gz_session_frame *b)
{
	assert_true(a->time_ns == b->time_ns && a->width == b->width && a->height == b->height);
	assert_memory_equal(&a->display, &b->display, sizeof a->display);
	assert_int_equal(a->reading.known, b->reading.known);
	assert_true(!a->reading.known ||
		    memcmp(&a->reading.point, &b->reading.point, sizeof a->reading.point) == 0);
	assert_int_equal(a->reading.has_age, b->reading.has_age);
	assert_true(!a->reading.has_age || a->reading.age_ns == b->reading.age_ns);
	assert_int_equal(a->reading.has_event, b->reading.has_event);
	assert_true(!a->reading.has_event || a->reading.event == b->reading.event);
	assert_true(isnan(a->reading.noise_deg) ? isnan(b->reading.noise_deg)
						: a->reading.noise_deg == b->reading.noise_deg);
	assert_true(gz_focus_same(&a->focus, &b->focus));
	assert_int_equal(a->kept, b->kept);
	assert_true(fabs(a->took_ms - b->took_ms) < 0.001);
}

static void check_round_trip(const struct gz_session_frame *frame)
{
	struct gz_text text = { 0 };
	struct gz_session_frame back;
	const char *what = "nothing";
	gz_session_print_frame(frame, &text);
	assert_int_equal(text.bytes[text.length - 1], '\n');
	text.bytes[text.length - 1] = '\0';
	if (gz_session_parse_frame(text.bytes, &back, &what) != GZ_OK)
		fail_msg("%s", what);
	check_same_frame(frame, &back);
	gz_text_free(&text);
}

static void what_is_raised_is_read_back_to_the_bit(void **state)
{
	(void)state;
	const struct gz_raised raised[] = { { .id = UINT32_MAX, .share = 1.0 / 3 },
					    { 1, 1, 1.0 / 3, 2.0 / 3 },
					    { 1, 1e-9, -0.1, 1e9 } };
	struct gz_raised back;
	static const char *const wrong[] = { "!raise\t7",
					     "!raise\t7\t1.5",
					     "!raise\t-1\t0",
					     "!raise\t7\t0\t0",
					     "!raise\t7\tnan",
					     "!raise\t7\t1\t1\t1",
					     "!raise\t7\t1\t0\tinf",
					     "!raise\t7\t1\t0\t1\t2" };
	char line[32];
	for (size_t i = 0; i < sizeof raised / sizeof raised[0]; i++) {
		struct gz_text text = { 0 };
		gz_session_print_raised(&raised[i], &text);
		text.bytes[text.length - 1] = '\0';
		assert_int_equal(gz_session_parse_raised(text.bytes, &back), GZ_OK);
		assert_true(gz_raised_same(&raised[i], &back));
		gz_text_free(&text);
	}
	for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++) {
		snprintf(line, sizeof line, "%s", wrong[i]);
		assert_int_equal(gz_session_parse_raised(line, &back), GZ_ERR_FORMAT);
	}
}

static void growth_of_plans_is_read_back_to_the_bit(void **state)
{
	(void)state;
	static const double finer[] = { 1, 1 + 1e-15, 4.0 / 3, GZ_PLAN_FINER_MAX };
	static const char *const wrong[] = { "!finer", "!finer\t0.99", "!finer\t2e6", "!finer\tnan",
					     "!finer\t1\t1" };
	double back;
	char line[32];
	for (size_t i = 0; i < sizeof finer / sizeof finer[0]; i++) {
		struct gz_text text = { 0 };
		gz_session_print_finer(finer[i], &text);
		text.bytes[text.length - 1] = '\0';
		assert_int_equal(gz_session_parse_finer(text.bytes, &back), GZ_OK);
		assert_true(back == finer[i]);
		gz_text_free(&text);
	}
	for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++) {
		snprintf(line, sizeof line, "%s", wrong[i]);
		assert_int_equal(gz_session_parse_finer(line, &back), GZ_ERR_FORMAT);
	}
}

static void changes_of_settings_are_read_back_to_the_bit(void **state)
{
	(void)state;
	const struct gz_illustration_change change = { 1.0 / 3, -0.4, 1e-17, 0, 0.4 };
	static const char *const wrong[] = { "!adapt\t0\t0\t0\t0", "!adapt\t0\t0\t0\t0\t0\t0",
					     "!adapt\t0\t0\t0\t0\t0.41",
					     "!adapt\t0\tnan\t0\t0\t0" };
	struct gz_illustration_change back;
	struct gz_text text = { 0 };
	char line[64];
	gz_session_print_change(&change, &text);
	text.bytes[text.length - 1] = '\0';
	assert_int_equal(gz_session_parse_change(text.bytes, &back), GZ_OK);
	assert_true(gz_illustration_change_same(&change, &back));
	gz_text_free(&text);
	for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++) {
		snprintf(line, sizeof line, "%s", wrong[i]);
		assert_int_equal(gz_session_parse_change(line, &back), GZ_ERR_FORMAT);
	}
}

static void frame_is_read_back_to_the_bit(void **state)
{
	struct gz_session_frame frame = make_frame(*state, 123456789012345);
	check_round_trip(&frame);
	frame.reading.has_age = frame.reading.has_event = frame.kept = true;
	frame.reading.age_ns = -5;
	frame.reading.noise_deg = 0.1;
	for (int event = 0; event < GZ_EVENT_COUNT; event++) {
		frame.reading.event = (enum gz_event)event;
		check_round_trip(&frame);
	}
	frame.reading.point = (struct gz_point) { -3.4e38F, 1e-45F };
	frame.focus = (struct gz_focus) { .point = { NAN, NAN }, .scale = 1 };
	check_round_trip(&frame);
	frame.reading.known = false;
	check_round_trip(&frame);
}

static void session_is_read_back_with_its_changes(void **state)
{
	struct fixture *self = *state;
	struct gz_session_frame frame;
	struct gz_session_writer *writer = begin(self);
	add(self, writer, 0);
	self->settings.camera.eye[0] = 1.0 / 3;
	self->settings.foveation.method = GZ_METHOD_DDC;
	self->settings.rays.background[1] = 0.1;
	snprintf(self->settings.regions.items[1].object, GZ_SCENE_SECTION_SIZE, "brain");
	self->settings.regions.items[1].style.transparency = 1.0 / 3;
	add(self, writer, 10);
	self->transfer.points[1].rgb[2] = 0.1;
	self->transfer.interpolation = GZ_TRANSFER_QUADRATIC;
	self->transfer.has_range = true;
	self->transfer.range[1] = 1.0 / 7;
	add(self, writer, 20);
	assert_int_equal(gz_session_writer_frames(writer), 3);
	assert_int_equal(gz_session_writer_end(&writer), GZ_OK);
	assert_null(writer);

	struct gz_session_reader *reader = open_it(self);
	const struct gz_session_header *header = gz_session_header(reader);
	const struct gz_volume_identity identity = gz_volume_identify(&self->volume);
	assert_true(gz_volume_identity_same(&header->volume, &identity));
	assert_true(header->volume.has_crc);
	assert_string_equal(header->software, "gazeview test");
	assert_string_equal(header->backend, "cpu");
	assert_int_equal(header->host_ns, 1000);
	assert_int_equal(gz_session_read(reader, &self->state, &frame), GZ_OK);
	assert_int_equal(frame.time_ns, 0);
	assert_true(self->state.settings.camera.eye[0] == 0.1);
	assert_int_equal(gz_session_read(reader, &self->state, &frame), GZ_OK);
	assert_true(self->state.settings.camera.eye[0] == 1.0 / 3);
	assert_int_equal(self->state.settings.foveation.method, GZ_METHOD_DDC);
	assert_true(self->state.settings.rays.background[1] == 0.1);
	assert_false(self->state.transfer_changed);
	assert_int_equal(gz_session_read(reader, &self->state, &frame), GZ_OK);
	assert_true(self->state.transfer_changed);
	assert_int_equal(self->state.transfer.interpolation, GZ_TRANSFER_QUADRATIC);
	assert_true(self->state.transfer.points[1].rgb[2] == 0.1);
	assert_true(self->state.transfer.range[1] == 1.0 / 7);
	assert_int_equal(gz_session_read(reader, &self->state, &frame), GZ_ERR_END);
	assert_int_equal(gz_session_read(reader, &self->state, &frame), GZ_ERR_END);
	assert_int_equal(gz_session_frames_read(reader), 3);
	assert_int_equal(self->log.messages, 0);
	gz_session_close(&reader);
	assert_null(reader);
}

static void scene_file_has_the_settings_of_the_start(void **state)
{
	struct fixture *self = *state;
	char path[160];
	struct gz_scene scene;
	struct gz_session_writer *writer = begin(self);
	assert_int_equal(gz_session_writer_end(&writer), GZ_OK);
	snprintf(path, sizeof path, "%s/%s", self->path, GZ_SESSION_SCENE);
	assert_int_equal(gz_scene_load(path, NULL, &self->log.log, &scene), GZ_OK);
	assert_memory_equal(&scene.settings.camera, &self->settings.camera,
			    sizeof scene.settings.camera);
	const struct gz_volume_identity a = gz_volume_identify(&self->volume);
	const struct gz_volume_identity b = gz_volume_identify(&scene.volume);
	assert_true(gz_volume_identity_same(&a, &b));
	assert_int_equal(scene.transfer.count, 2);
	gz_scene_free(&scene);
}

static void spacing_tables_are_copied(void **state)
{
	struct fixture *self = *state;
	struct gz_session_frame frame;
	struct gz_foveation *foveation = &self->settings.foveation;
	struct gz_session_writer *writer = begin(self);
	foveation->method = GZ_METHOD_TABLE;
	foveation->table.count = 2;
	foveation->table.rows[0] = (struct gz_spacing_row) { 0, 1, 1 };
	foveation->table.rows[1] = (struct gz_spacing_row) { 10.0 / 3, 4, 2 };
	snprintf(foveation->table_file, sizeof foveation->table_file, "/elsewhere/my.txt");
	add(self, writer, 0);
	assert_int_equal(gz_session_writer_end(&writer), GZ_OK);

	struct gz_session_reader *reader = open_it(self);
	assert_int_equal(gz_session_read(reader, &self->state, &frame), GZ_OK);
	assert_true(self->state.table_changed);
	char scene[160];
	snprintf(scene, sizeof scene, "%s/%s", self->path, GZ_SESSION_SCENE);
	struct gz_foveation *back = &self->state.settings.foveation;
	assert_int_equal(gz_scene_load_table(scene, &self->log.log, back), GZ_OK);
	assert_int_equal(back->table.count, 2);
	assert_true(back->table.rows[1].eccentricity_deg == 10.0 / 3);
	gz_session_close(&reader);
}

static void gaze_log_has_each_sample_once(void **state)
{
	struct fixture *self = *state;
	char path[160];
	struct gz_gaze_log_reader *log;
	struct gz_gaze_log_record record;
	struct gz_gaze_reading reading = { .known = true, .point = { 0.25F, 0.5F } };
	struct gz_session_writer *writer = begin(self);
	reading.has_age = true;
	reading.age_ns = 100;
	assert_int_equal(gz_session_writer_gaze(writer, &reading, 1100), GZ_OK);
	reading.age_ns = 200; /* the same sample, seen later */
	assert_int_equal(gz_session_writer_gaze(writer, &reading, 1200), GZ_OK);
	reading.known = false;
	assert_int_equal(gz_session_writer_gaze(writer, &reading, 1300), GZ_OK);
	reading = (struct gz_gaze_reading) { .known = true, .has_event = true };
	reading.event = GZ_EVENT_BLINK;
	assert_int_equal(gz_session_writer_gaze(writer, &reading, 1400), GZ_OK);
	assert_int_equal(gz_session_writer_end(&writer), GZ_OK);
	snprintf(path, sizeof path, "%s/%s", self->path, GZ_SESSION_GAZE);
	assert_int_equal(gz_gaze_log_open(path, &self->log.log, &log), GZ_OK);
	assert_true(gz_gaze_log_header(log)->has_display);
	assert_int_equal(gz_gaze_log_read(log, &record), GZ_OK);
	assert_int_equal(record.sample.host_ns, 1000);
	assert_true(record.sample.valid && record.sample.point.x == 0.25F);
	assert_int_equal(gz_gaze_log_read(log, &record), GZ_OK);
	assert_int_equal(record.sample.host_ns, 1400);
	assert_false(record.sample.valid);
	assert_int_equal(gz_gaze_log_read(log, &record), GZ_ERR_END);
	assert_int_equal(gz_gaze_log_ending(log), GZ_GAZE_LOG_WHOLE);
	gz_gaze_log_close(&log);
}

static void killed_recording_is_read_to_its_last_complete_line(void **state)
{
	struct fixture *self = *state;
	char path[160];
	struct gz_session_frame frame;
	struct gz_session_writer *writer = begin(self);
	add(self, writer, 0);
	add(self, writer, 5);
	snprintf(path, sizeof path, "%s/%s", self->path, GZ_SESSION_FRAMES);
	const int fd = open(path, O_WRONLY | O_APPEND);
	assert_int_equal(write(fd, "10\t64\t48", 8), 8);
	close(fd);
	struct gz_session_reader *reader = open_it(self);
	assert_int_equal(gz_session_read(reader, &self->state, &frame), GZ_OK);
	assert_int_equal(gz_session_read(reader, &self->state, &frame), GZ_OK);
	assert_int_equal(self->log.messages, 0);
	assert_int_equal(gz_session_read(reader, &self->state, &frame), GZ_ERR_END);
	assert_int_equal(self->log.level, GZ_LOG_WARN);
	assert_non_null(strstr(self->log.last, "2 frames are complete"));
	gz_session_close(&reader);
	gz_session_writer_end(&writer);
}

static void full_disk_ends_the_recording_with_complete_lines(void **state)
{
	struct fixture *self = *state;
	struct rlimit before, small = { .rlim_cur = 2000 };
	struct gz_session_frame frame = make_frame(self, 0);
	struct gz_session_writer *writer = begin(self);
	assert_int_equal(getrlimit(RLIMIT_FSIZE, &before), 0);
	small.rlim_max = before.rlim_max;
	signal(SIGXFSZ, SIG_IGN);
	assert_int_equal(setrlimit(RLIMIT_FSIZE, &small), 0);
	enum gz_result r = GZ_OK;
	for (int i = 0; i < 100 && r == GZ_OK; i++) {
		frame.time_ns = i;
		r = gz_session_writer_add(writer, &self->settings, &self->transfer, &frame);
	}
	const enum gz_result again =
		gz_session_writer_add(writer, &self->settings, &self->transfer, &frame);
	const int messages = self->log.messages;
	const uint64_t frames = gz_session_writer_frames(writer);
	const enum gz_result ended = gz_session_writer_end(&writer);
	setrlimit(RLIMIT_FSIZE, &before);
	assert_int_equal(r, GZ_ERR_IO);
	assert_int_equal(again, GZ_ERR_IO);
	assert_int_equal(ended, GZ_ERR_IO);
	assert_int_equal(messages, 1);
	assert_int_equal(self->log.messages, 1);
	assert_non_null(strstr(self->log.last, "the recording stops"));
	assert_true(frames > 2 && frames < 100);

	struct gz_session_reader *reader = open_it(self);
	for (uint64_t i = 0; i < frames; i++)
		assert_int_equal(gz_session_read(reader, &self->state, &frame), GZ_OK);
	assert_int_equal(gz_session_read(reader, &self->state, &frame), GZ_ERR_END);
	gz_session_close(&reader);
}

static void existing_session_is_not_overwritten(void **state)
{
	struct fixture *self = *state;
	struct gz_session_writer *writer = begin(self), *other = NULL;
	const struct gz_session_start start = { .path = self->path,
						.scene = "a.scene",
						.settings = &self->settings,
						.transfer = &self->transfer,
						.volume = &self->volume,
						.display = &self->display,
						.software = "",
						.backend = "",
						.source = "" };
	assert_int_equal(gz_session_writer_begin(&start, &self->log.log, &other), GZ_ERR_BUSY);
	assert_null(other);
	assert_non_null(strstr(self->log.last, "choose another name"));
	gz_session_writer_end(&writer);
	struct gz_session_reader *reader = open_it(self);
	gz_session_close(&reader);
}

static void session_in_missing_folder_is_refused(void **state)
{
	struct fixture *self = *state;
	struct gz_session_writer *writer = NULL;
	const struct gz_session_start start = { .path = "/nowhere/at/all.session",
						.settings = &self->settings,
						.transfer = &self->transfer };
	assert_int_equal(gz_session_writer_begin(&start, &self->log.log, &writer), GZ_ERR_IO);
	assert_int_equal(self->log.messages, 1);
	assert_null(writer);
}

static void different_volumes_differ_in_identity(void **state)
{
	struct fixture *self = *state;
	const struct gz_volume_identity a = gz_volume_identify(&self->volume);
	((unsigned char *)self->volume.voxels)[100] ^= 1;
	struct gz_volume_identity b = gz_volume_identify(&self->volume);
	assert_false(gz_volume_identity_same(&a, &b));
	b.has_crc = false; /* of bricks */
	assert_true(gz_volume_identity_same(&a, &b));
	b.dims[2]++;
	assert_false(gz_volume_identity_same(&a, &b));
}

#define HEAD                                                                 \
	GZ_SESSION_FIRST_LINE "\n#volume_dims 8\t8\t8\n#volume_type uint8\n" \
			      "#volume_spacing 1\t1\t1\n#volume_range 0\t1\n"
#define FRAME "0\t64\t48\t64\t48\t564\t423\t600\t0.5\t0.5\t\t\t\t0.5\t0.5\t1\t0\t0\t1.000\n"

static void malformed_lines_are_refused_with_their_number(void **state)
{
	static const struct {
		const char *text, *line, *what;
	} cases[] = {
		{ "", ":0", "nothing was recorded" },
		{ "#gazecast-session 2\n", ":1", "not a session" },
		{ "time_ns\twidth\n", ":1", "not a session" },
		{ GZ_SESSION_FIRST_LINE "\n#volume_dims 8\t8\n", ":2", "#volume_dims" },
		{ GZ_SESSION_FIRST_LINE "\n#volume_dims 8\t8\t99999\n", ":2", "#volume_dims" },
		{ GZ_SESSION_FIRST_LINE "\n#volume_crc 12345\n", ":2", "#volume_crc" },
		{ GZ_SESSION_FIRST_LINE "\n" FRAME, ":2", "#volume_dims or" },
		{ HEAD "0\t64\n", ":6", "the number of fields" },
		{ HEAD FRAME "\n", ":7", "the number of fields" },
		{ HEAD "-1" FRAME, ":6", "time_ns" },
		{ HEAD "0\t0\t48\t64\t48\t564\t423\t600\t\t\t\t\t\t\t\t1\t0\t0\t1\n", ":6",
		  "width_px" },
		{ HEAD "0\t64\t99999\t64\t48\t564\t423\t600\t\t\t\t\t\t\t\t1\t0\t0\t1\n", ":6",
		  "height_px" },
		{ HEAD "0\t64\t48\t64\t48\t0\t423\t600\t\t\t\t\t\t\t\t1\t0\t0\t1\n", ":6",
		  "distance_mm" },
		{ HEAD "0\t64\t48\t64\t48\t5\t4\t6\t0.5\t\t\t\t\t\t\t1\t0\t0\t1\n", ":6",
		  "gaze_y" },
		{ HEAD "0\t64\t48\t64\t48\t5\t4\t6\tinf\t0\t\t\t\t\t\t1\t0\t0\t1\n", ":6",
		  "gaze_x" },
		{ HEAD "0\t64\t48\t64\t48\t5\t4\t6\t\t\t\tnap\t\t\t\t1\t0\t0\t1\n", ":6",
		  "gaze_event" },
		{ HEAD "0\t64\t48\t64\t48\t5\t4\t6\t\t\t\t\t\t\t\t0.5\t0\t0\t1\n", ":6", "scale" },
		{ HEAD "0\t64\t48\t64\t48\t5\t4\t6\t\t\t\t\t\t\t\t1\t2\t0\t1\n", ":6", "widen" },
		{ HEAD "0\t64\t48\t64\t48\t5\t4\t6\t\t\t\t\t\t\t\t1\t0\t2\t1\n", ":6", "kept" },
		{ HEAD "5" FRAME FRAME, ":7", "earlier than that of the previous" },
		{ HEAD "!set\tcamera.eye\n", ":6", "without a value" },
		{ HEAD "!set\tcamera.nose\t1\n", ":6", "unknown setting" },
		{ HEAD "!set\tvolume.file\tx\n", ":6", "unknown setting" },
		{ HEAD "!set\tcamera.eye\t1 2\n", ":6", "3 numbers expected" },
		{ HEAD "!set\tfoveation.table\t/etc/passwd\n", ":6", "not a file in" },
		{ HEAD "!transfer\t0 0 0 0 2\n", ":6", "out of range" },
		{ HEAD "!mark\t1\n", ":6", "the number of fields" },
		{ HEAD FRAME "#end 1\n", ":7", "invalid last line" },
	};
	struct fixture *self = *state;
	for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
		struct gz_session_reader *reader = NULL;
		struct gz_session_frame frame;
		captured_log_init(&self->log, NULL);
		enum gz_result r = gz_session_open_memory("t", cases[i].text, strlen(cases[i].text),
							  &self->log.log, &reader);
		while (r == GZ_OK)
			r = gz_session_read(reader, &self->state, &frame);
		if (r != GZ_ERR_FORMAT || !strstr(self->log.last, cases[i].line) ||
		    !strstr(self->log.last, cases[i].what))
			fail_msg("%s: %s: not %s %s but: %s", cases[i].text, gz_result_text(r),
				 cases[i].line, cases[i].what, self->log.last);
		gz_session_close(&reader);
	}
}

static void line_without_end_is_refused(void **state)
{
	struct fixture *self = *state;
	struct gz_session_reader *reader = NULL;
	const size_t size = 3 * GZ_SESSION_LINE_SIZE;
	char *text = malloc(size);
	assert_non_null(text);
	memset(text, 'x', size);
	memcpy(text, HEAD, sizeof HEAD - 1);
	assert_int_equal(gz_session_open_memory("t", text, size, &self->log.log, &reader),
			 GZ_ERR_FORMAT);
	text[sizeof HEAD] = '\0';
	text[sizeof HEAD + 1] = '\n';
	assert_int_equal(
		gz_session_open_memory("t", text, sizeof HEAD + 2, &self->log.log, &reader),
		GZ_ERR_FORMAT);
	free(text);
}

static void changed_file_is_warned_of_at_the_end(void **state)
{
	static const char text[] = HEAD FRAME "#end 1\t00000000\n";
	struct fixture *self = *state;
	struct gz_session_reader *reader = NULL;
	struct gz_session_frame frame;
	assert_int_equal(
		gz_session_open_memory("t", text, sizeof text - 1, &self->log.log, &reader), GZ_OK);
	assert_int_equal(gz_session_read(reader, &self->state, &frame), GZ_OK);
	assert_int_equal(gz_session_read(reader, &self->state, &frame), GZ_ERR_END);
	assert_int_equal(self->log.level, GZ_LOG_WARN);
	assert_non_null(strstr(self->log.last, "the file was changed"));
	gz_session_close(&reader);
}

#define TEST(name) cmocka_unit_test_setup_teardown(name, set_up, tear_down)

TEST_SUITE(session)
{
	const struct CMUnitTest tests[] = {
		TEST(frame_is_read_back_to_the_bit),
		TEST(what_is_raised_is_read_back_to_the_bit),
		TEST(growth_of_plans_is_read_back_to_the_bit),
		TEST(changes_of_settings_are_read_back_to_the_bit),
		TEST(session_is_read_back_with_its_changes),
		TEST(scene_file_has_the_settings_of_the_start),
		TEST(spacing_tables_are_copied),
		TEST(gaze_log_has_each_sample_once),
		TEST(killed_recording_is_read_to_its_last_complete_line),
		TEST(full_disk_ends_the_recording_with_complete_lines),
		TEST(existing_session_is_not_overwritten),
		TEST(session_in_missing_folder_is_refused),
		TEST(different_volumes_differ_in_identity),
		TEST(malformed_lines_are_refused_with_their_number),
		TEST(line_without_end_is_refused),
		TEST(changed_file_is_warned_of_at_the_end),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
