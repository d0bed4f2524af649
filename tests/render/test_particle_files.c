/* Files of particles: what each format gives, damaged files, and real ones. */
#include "suite.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/captured_log.h"
#include "render/particles/particles.h"
#include "volume_files.h"

enum { COUNT = 3 };

/* What each file of this test holds; exact as float. */
static const float sample_position[COUNT][3] = { { 0.25F, 0.5F, 0.75F },
						 { 0, 1, 0.125F },
						 { 0.375F, 0.0625F, 1 } };
static const float sample_velocity[COUNT][3] = { { 3, 4, 0 }, { 0, 0, -2 }, { 2, 3, 6 } };
static const float sample_density[COUNT] = { 1000, 998.5F, 1024 };
static const float sample_pressure[COUNT] = { -1, 0, 2.5F };

/* Bytes that are being written. */
struct made_file {
	uint8_t bytes[4096];
	size_t size;
};

static void put_bytes(struct made_file *file, const void *bytes, size_t size)
{
	assert_true(file->size + size <= sizeof file->bytes);
	memcpy(file->bytes + file->size, bytes, size);
	file->size += size;
}

static void put_text(struct made_file *file, const char *text)
{
	put_bytes(file, text, strlen(text));
}

static void put_number(struct made_file *file, uint64_t bits, size_t size, bool big)
{
	for (size_t i = 0; i < size; i++) {
		const uint8_t byte = (uint8_t)(bits >> 8 * (big ? size - 1 - i : i));
		put_bytes(file, &byte, 1);
	}
}

static void put_real(struct made_file *file, float value, bool big)
{
	uint32_t bits;
	memcpy(&bits, &value, sizeof bits);
	put_number(file, bits, 4, big);
}

static void put_reals(struct made_file *file, const float *values, int count, bool big)
{
	for (int i = 0; i < count; i++)
		put_real(file, values[i], big);
}

/* Step s has all densities greater by 100 s and x divided by s + 1. */
static void make_liquid(struct made_file *file, unsigned steps)
{
	const float normal[3] = { 9, 9, 9 };
	put_number(file, steps, 4, false);
	put_number(file, COUNT, 4, false);
	for (unsigned step = 0; step < steps; step++)
		for (int i = 0; i < COUNT; i++) {
			put_real(file, sample_position[i][0] / (float)(step + 1), false);
			put_reals(file, &sample_position[i][1], 2, false);
			put_reals(file, normal, 3, false);
			put_reals(file, sample_velocity[i], 3, false);
			put_real(file, sample_density[i] + 100 * (float)step, false);
			put_real(file, sample_pressure[i], false);
		}
}

static void put_attribute(struct made_file *file, const char *name, unsigned size, unsigned type)
{
	put_number(file, strlen(name), 2, true);
	put_text(file, name);
	put_number(file, size, 2, true);
	put_number(file, type, 4, true);
	for (unsigned i = 0; i < size && type != 4; i++)
		put_number(file, 0, 4, true);
}

/* With an index attribute between the others, as Houdini writes groups' names. */
static void make_bgeo(struct made_file *file)
{
	put_text(file, "BgeoV");
	put_number(file, 5, 4, true);
	put_number(file, COUNT, 4, true);
	for (int i = 0; i < 3; i++)
		put_number(file, 0, 4, true);
	put_number(file, 4, 4, true);
	for (int i = 0; i < 3; i++)
		put_number(file, 0, 4, true);
	put_attribute(file, "density", 1, 0);
	put_attribute(file, "kind", 1, 4);
	put_number(file, 2, 4, true);
	for (int i = 0; i < 2; i++) {
		put_number(file, 4, 2, true);
		put_text(file, "kind");
	}
	put_attribute(file, "v", 3, 5);
	put_attribute(file, "pressure", 1, 0);
	for (int i = 0; i < COUNT; i++) {
		put_reals(file, sample_position[i], 3, true);
		put_real(file, 1, true);
		put_real(file, sample_density[i], true);
		put_number(file, 1, 4, true);
		put_reals(file, sample_velocity[i], 3, true);
		put_real(file, sample_pressure[i], true);
	}
	put_text(file, "\xff");
	file->bytes[file->size - 1] = 0;
	put_text(file, "\xff");
}

static void put_words(struct made_file *file, const float *values, int count)
{
	char word[32];
	for (int i = 0; i < count; i++) {
		snprintf(word, sizeof word, "%.9g%s", (double)values[i],
			 i + 1 < count ? " " : "\n");
		put_text(file, word);
	}
}

/* Text, or binary in either byte order; a list and another element stand before the points. */
static void make_ply(struct made_file *file, const char *format)
{
	const bool text = strcmp(format, "ascii") == 0, big = strstr(format, "big") != NULL;
	char line[64];
	put_text(file, "ply\n");
	snprintf(line, sizeof line, "format %s 1.0\n", format);
	put_text(file, line);
	put_text(file, "comment made by a test\nelement camera 1\nproperty list uchar int views\n"
		       "element vertex 3\nproperty float density\nproperty float32 x\n"
		       "property float y\nproperty float z\nproperty list uchar short near\n"
		       "property float vx\nproperty float vy\nproperty float vz\n"
		       "property float pressure\nelement face 1\n"
		       "property list uchar int vertex_indices\nend_header\n");
	if (text) {
		put_text(file, "2 7 8\n");
	} else {
		put_number(file, 2, 1, big);
		put_number(file, 7, 4, big);
		put_number(file, 8, 4, big);
	}
	for (int i = 0; i < COUNT; i++) {
		if (text) {
			put_words(file, &sample_density[i], 1);
			put_words(file, sample_position[i], 3);
			put_text(file, "1 5\n");
			put_words(file, sample_velocity[i], 3);
			put_words(file, &sample_pressure[i], 1);
			continue;
		}
		put_real(file, sample_density[i], big);
		put_reals(file, sample_position[i], 3, big);
		put_number(file, 1, 1, big);
		put_number(file, 5, 2, big);
		put_reals(file, sample_velocity[i], 3, big);
		put_real(file, sample_pressure[i], big);
	}
	put_text(file, text ? "3 0 1 2\n" : "\3");
}

static void put_array(struct made_file *file, bool binary, const float *values, int count)
{
	if (!binary) {
		put_words(file, values, count);
		return;
	}
	put_reals(file, values, count, true);
	put_text(file, "\n");
}

static void put_rows(struct made_file *file, bool binary, const float rows[COUNT][3])
{
	for (int i = 0; i < COUNT; i++) {
		if (binary)
			put_reals(file, rows[i], 3, true);
		else
			put_words(file, rows[i], 3);
	}
	put_text(file, "\n");
}

static void put_cells(struct made_file *file, bool binary, bool offsets)
{
	if (!offsets) {
		put_text(file, "CELLS 3 6\n");
		for (unsigned i = 0; i < COUNT && binary; i++) {
			put_number(file, 1, 4, true);
			put_number(file, i, 4, true);
		}
		put_text(file, binary ? "\n" : "1 0\n1 1\n1 2\n");
		return;
	}
	put_text(file, "CELLS 4 3\nOFFSETS vtktypeint64\n");
	for (unsigned i = 0; i < COUNT + 1 && binary; i++)
		put_number(file, i, 8, true);
	put_text(file, binary ? "\n" : "0 1 2 3\n");
	put_text(file, "CONNECTIVITY vtktypeint64\n");
	for (unsigned i = 0; i < COUNT && binary; i++)
		put_number(file, i, 8, true);
	put_text(file, binary ? "\n" : "0 1 2\n");
}

static void make_vtk(struct made_file *file, bool binary, bool offsets)
{
	put_text(file, offsets ? "# vtk DataFile Version 5.1\n" : "# vtk DataFile Version 4.1\n");
	put_text(file, "points of a test\n");
	put_text(file, binary ? "BINARY\n" : "ASCII\n");
	put_text(file, "DATASET UNSTRUCTURED_GRID\nFIELD FieldData 1\nTIME 1 1 float\n");
	put_array(file, binary, sample_density, 1);
	put_text(file, "POINTS 3 float\n");
	put_rows(file, binary, sample_position);
	put_text(file, "METADATA\nINFORMATION 0\n\n");
	put_cells(file, binary, offsets);
	put_text(file, "CELL_TYPES 3\n");
	for (int i = 0; i < COUNT && binary; i++)
		put_number(file, 1, 4, true);
	put_text(file, binary ? "\n" : "1 1 1\n");
	put_text(file, "CELL_DATA 3\nSCALARS density float\nLOOKUP_TABLE default\n");
	put_array(file, binary, sample_pressure, COUNT);
	put_text(file, "POINT_DATA 3\nSCALARS pressure float 1\nLOOKUP_TABLE default\n");
	put_array(file, binary, sample_pressure, COUNT);
	put_text(file, "FIELD FieldData 2\ndensity 1 3 float\n");
	put_array(file, binary, sample_density, COUNT);
	put_text(file, "velocity 3 3 float\n");
	put_rows(file, binary, sample_velocity);
}

static void make_xyz(struct made_file *file)
{
	put_text(file, "# x y z and more\r\n");
	for (int i = 0; i < COUNT; i++) {
		char line[96];
		snprintf(line, sizeof line, i == 1 ? "%.9g,%.9g;%.9g red\r\n" : "%.9g %.9g\t%.9g\n",
			 (double)sample_position[i][0], (double)sample_position[i][1],
			 (double)sample_position[i][2]);
		put_text(file, line);
	}
}

static enum gz_result load_file(const char *path, enum gz_particle_value value, int time_point,
				struct captured_log *log, struct gz_particles *out)
{
	const struct gz_particle_request request = {
		.path = path, .value = value, .time_point = time_point, .log = &log->log
	};
	captured_log_init(log, "*:warn");
	return gz_particles_load(&request, out);
}

static double sample_value(int i, enum gz_particle_value value)
{
	static const double speeds[COUNT] = { 5, 2, 7 };
	return value == GZ_PARTICLE_DENSITY    ? (double)sample_density[i]
	       : value == GZ_PARTICLE_PRESSURE ? (double)sample_pressure[i]
					       : speeds[i];
}

/* The file holds the sample, and its value if it has values. */
static void check_sample(const char *path, enum gz_particle_value value)
{
	struct captured_log log;
	struct gz_particles particles;
	if (load_file(path, value, 0, &log, &particles) != GZ_OK || log.messages != 0)
		fail_msg("%s: %s", path, log.last);
	assert_int_equal(particles.count, COUNT);
	assert_int_equal(particles.left_out, 0);
	for (int i = 0; i < COUNT; i++) {
		for (int axis = 0; axis < 3; axis++)
			if (particles.positions[i][axis] != (double)sample_position[i][axis])
				fail_msg("%s: particle %d, axis %d: %.9g", path, i, axis,
					 particles.positions[i][axis]);
		if (value != GZ_PARTICLE_FILL &&
		    (double)particles.values[i] != sample_value(i, value))
			fail_msg("%s: particle %d: value %.9g", path, i,
				 (double)particles.values[i]);
	}
	assert_true((particles.values == NULL) == (value == GZ_PARTICLE_FILL));
	gz_particles_free(&particles);
}

static void check_all_values(const char *path)
{
	for (int value = 0; value < GZ_PARTICLE_VALUE_COUNT; value++)
		check_sample(path, (enum gz_particle_value)value);
}

static const char *write_made(const char *name, const struct made_file *file)
{
	return files_write(name, file->bytes, file->size);
}

static const char *write_line(const char *name, const char *text)
{
	return files_write(name, text, strlen(text));
}

/* Plain, by its name and without one; compressed. */
static void check_format(const char *ending, const struct made_file *file)
{
	uint8_t packed[8192];
	char name[32];
	snprintf(name, sizeof name, "a%s", ending);
	check_all_values(write_made(name, file));
	check_all_values(write_made("unnamed", file));
	snprintf(name, sizeof name, "a%s.gz", ending);
	const size_t size = files_deflate(file->bytes, file->size, 31, packed, sizeof packed);
	check_all_values(files_write(name, packed, size));
}

static void every_format_gives_its_numbers(void **state)
{
	static const char *const codings[] = { "ascii", "binary_little_endian",
					       "binary_big_endian" };
	struct made_file file = { .size = 0 };
	(void)state;
	make_liquid(&file, 1);
	check_format(".particles", &file);
	file.size = 0;
	make_bgeo(&file);
	check_format(".bgeo", &file);
	for (int i = 0; i < 3; i++) {
		file.size = 0;
		make_ply(&file, codings[i]);
		check_format(".ply", &file);
	}
	for (int i = 0; i < 4; i++) {
		file.size = 0;
		make_vtk(&file, (i & 1) != 0, (i & 2) != 0);
		check_format(".vtk", &file);
	}
	file.size = 0;
	make_xyz(&file);
	check_sample(write_made("a.xyz", &file), GZ_PARTICLE_FILL);
	check_sample(write_made("unnamed", &file), GZ_PARTICLE_FILL);
}

static void time_steps_are_read_one_by_one(void **state)
{
	struct made_file file = { .size = 0 };
	struct captured_log log;
	struct gz_particles particles;
	(void)state;
	make_liquid(&file, 3);
	const char *path = write_made("a.particles", &file);
	for (int step = 0; step < 3; step++) {
		assert_int_equal(load_file(path, GZ_PARTICLE_DENSITY, step, &log, &particles),
				 GZ_OK);
		assert_int_equal(particles.time_points, 3);
		assert_int_equal(particles.time_point, step);
		assert_true(particles.positions[0][0] ==
			    (double)(sample_position[0][0] / (float)(step + 1)));
		assert_true(particles.values[1] == sample_density[1] + 100 * (float)step);
		assert_true(particles.value_range[0] == 998.5 && particles.value_range[1] == 1224);
		assert_true(particles.has_box && particles.box_least[2] == 0 &&
			    particles.box_greatest[2] == 1);
		gz_particles_free(&particles);
	}
	assert_int_equal(load_file(path, GZ_PARTICLE_FILL, 3, &log, &particles), GZ_ERR_INVAL);
	assert_non_null(strstr(log.last, "has no time point 4; it has 3"));
	/* Half of the last step is missing. */
	path = files_write("cut.particles", file.bytes, file.size - 50);
	assert_int_equal(load_file(path, GZ_PARTICLE_FILL, 1, &log, &particles), GZ_OK);
	assert_int_equal(particles.time_points, 2);
	assert_non_null(strstr(log.last, "of 3 time steps only the first 2"));
	gz_particles_free(&particles);
}

/* One line that says what is wrong. */
static void check_refused(const char *path, enum gz_result expected, const char *words)
{
	struct captured_log log;
	struct gz_particles particles;
	const enum gz_result result = load_file(path, GZ_PARTICLE_FILL, 0, &log, &particles);
	if (result != expected || log.messages != 1 || !strstr(log.last, words))
		fail_msg("%s: result %d, %d messages: %s", path, (int)result, log.messages,
			 log.last);
}

static void counts_that_lie_are_refused(void **state)
{
	struct made_file file = { .size = 0 };
	char text[256];
	(void)state;
	make_liquid(&file, 1);
	memset(file.bytes + 4, 0xff, 4);
	check_refused(write_made("a.particles", &file), GZ_ERR_FORMAT,
		      "announces 4294967295 particles, but has bytes for at most 3");
	file.size = 0;
	make_bgeo(&file);
	memset(file.bytes + 9, 0x7f, 4);
	check_refused(write_made("a.bgeo", &file), GZ_ERR_FORMAT, "announces 2139062143 points");
	memset(file.bytes + 9, 0, 4);
	check_refused(write_made("a.bgeo", &file), GZ_ERR_FORMAT, "has no particles");
	check_refused(write_line("a.ply",
				 "ply\nformat binary_little_endian 1.0\nelement vertex "
				 "9000000000\nproperty float x\nproperty float y\nproperty float "
				 "z\nend_header\n"),
		      GZ_ERR_FORMAT, "announces 9000000000 vertices");
	snprintf(text, sizeof text, "%s",
		 "# vtk DataFile Version 3.0\nt\nBINARY\nDATASET POLYDATA\nPOINTS 2000000000 "
		 "double\n");
	check_refused(write_line("a.vtk", text), GZ_ERR_FORMAT, "announces 2000000000 points");
	check_refused(write_line("a.xyz", "5\na comment\n1 2 3\n"), GZ_ERR_FORMAT,
		      "announces 5 points");
	check_refused(write_line("a.xyz", "2\na\n1 2 3 4\n"), GZ_ERR_FORMAT,
		      "announces 2 points, but has");
}

static void damaged_files_are_refused(void **state)
{
	struct made_file file = { .size = 0 };
	(void)state;
	check_refused(write_line("a.xyz", "1 2 3\n4 five 6\n"), GZ_ERR_FORMAT,
		      "line 2 is not a point");
	check_refused(write_line("a.xyz", ""), GZ_ERR_FORMAT, "has no particles");
	check_refused(write_line("a.ply", "ply\nformat ascii 1.0\nelement face 0\nend_header\n"),
		      GZ_ERR_FORMAT, "without the element vertex");
	check_refused(write_line("a.ply",
				 "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\n"
				 "end_header\n1\n"),
		      GZ_ERR_FORMAT, "no x, y and z");
	check_refused(write_line("a.bgeo", "\177NSJb...................................."),
		      GZ_ERR_UNSUPPORTED, "Houdini 12");
	make_vtk(&file, true, false);
	file.bytes[60] = '9'; /* a byte of DATASET */
	check_refused(files_write("a.vtk", file.bytes, 80), GZ_ERR_UNSUPPORTED,
		      "unknown kind of particles");
	check_refused(files_path("none.ply"), GZ_ERR_NOT_FOUND, "none.ply");
}

/* Cut anywhere, or with any byte changed, a file is read or refused, and never with a crash. */
static void cut_and_changed_files_end(void **state)
{
	struct made_file file;
	struct gz_particles particles;
	(void)state;
	for (int which = 0; which < 4; which++) {
		file.size = 0;
		if (which == 0)
			make_liquid(&file, 2);
		else if (which == 1)
			make_bgeo(&file);
		else if (which == 2)
			make_ply(&file, "binary_big_endian");
		else
			make_vtk(&file, true, true);
		static const char *const names[] = { "a.particles", "a.bgeo", "a.ply", "a.vtk" };
		for (size_t i = 0; i < 2 * file.size; i += 3) {
			struct made_file changed = file;
			if (i < file.size)
				changed.size = i;
			else
				changed.bytes[i - file.size] ^= 0x55;
			const struct gz_particle_request request = {
				.path = write_made(names[which], &changed),
				.value = GZ_PARTICLE_DENSITY,
			};
			if (gz_particles_load(&request, &particles) == GZ_OK) {
				assert_true(particles.count > 0);
				gz_particles_free(&particles);
			}
		}
	}
}

static void particles_without_numbers_are_counted(void **state)
{
	struct made_file file = { .size = 0 };
	struct captured_log log;
	struct gz_particles particles;
	(void)state;
	const char *path = write_line("a.xyz", "nan 1 2\n1 2 3\n1 -inf 0\n1 1e400 1\n4 5 6\n");
	assert_int_equal(load_file(path, GZ_PARTICLE_FILL, 0, &log, &particles), GZ_OK);
	assert_int_equal(particles.count, 2);
	assert_int_equal(particles.left_out, 3);
	assert_int_equal(log.messages, 1);
	assert_non_null(strstr(log.last, "3 of 5 particles are left out"));
	gz_particles_free(&particles);
	check_refused(write_line("a.xyz", "nan 1 2\nnan 2 3\n"), GZ_ERR_FORMAT,
		      "none of its 2 particles");
	/* A density that is not a number counts only if densities are asked for. */
	make_liquid(&file, 1);
	memset(file.bytes + 8 + 36, 0xff, 4);
	path = write_made("a.particles", &file);
	assert_int_equal(load_file(path, GZ_PARTICLE_FILL, 0, &log, &particles), GZ_OK);
	assert_int_equal(particles.count, 3);
	gz_particles_free(&particles);
	assert_int_equal(load_file(path, GZ_PARTICLE_DENSITY, 0, &log, &particles), GZ_OK);
	assert_int_equal(particles.count, 2);
	assert_non_null(strstr(log.last, "1 of 3 particles are left out"));
	assert_true(particles.value_range[0] == 998.5);
	gz_particles_free(&particles);
	/* Sums of so large values would not be finite. */
	file.size = 0;
	make_liquid(&file, 1);
	memcpy(file.bytes + 8 + 36, &(float) { 3e38F }, 4);
	path = write_made("a.particles", &file);
	assert_int_equal(load_file(path, GZ_PARTICLE_DENSITY, 0, &log, &particles), GZ_OK);
	assert_int_equal(particles.left_out, 1);
	gz_particles_free(&particles);
}

static void particles_outside_their_box_are_counted(void **state)
{
	struct made_file file = { .size = 0 };
	struct captured_log log;
	struct gz_particles particles;
	const float outside = 1.5F;
	(void)state;
	make_liquid(&file, 1);
	memcpy(file.bytes + 8, &outside, 4);
	assert_int_equal(
		load_file(write_made("a.particles", &file), GZ_PARTICLE_FILL, 0, &log, &particles),
		GZ_OK);
	assert_int_equal(particles.count, 2);
	assert_int_equal(particles.left_out, 1);
	assert_non_null(strstr(log.last, "1 particles are left out: they lie outside 0 to 1"));
	gz_particles_free(&particles);
}

static void a_value_that_is_missing_is_named(void **state)
{
	struct captured_log log;
	struct gz_particles particles;
	(void)state;
	const char *path =
		write_line("a.ply", "ply\nformat ascii 1.0\nelement vertex 1\nproperty float "
				    "x\nproperty float y\nproperty float z\nproperty float "
				    "density\nend_header\n1 2 3 4\n");
	assert_int_equal(load_file(path, GZ_PARTICLE_SPEED, 0, &log, &particles),
			 GZ_ERR_UNSUPPORTED);
	assert_non_null(strstr(log.last, "no speed; particles.value may be: fill, density"));
	path = write_line("a.xyz", "1 2 3\n");
	assert_int_equal(load_file(path, GZ_PARTICLE_DENSITY, 0, &log, &particles),
			 GZ_ERR_UNSUPPORTED);
	assert_int_equal(load_file(path, GZ_PARTICLE_FILL, 1, &log, &particles), GZ_ERR_INVAL);
}

static bool stop_at_once(void *user, double share, const char *what)
{
	(void)what;
	*(double *)user = share;
	return false;
}

static void loading_can_be_stopped(void **state)
{
	enum { MANY = 100000 };
	double share = -1;
	const struct gz_loading loading = { .report = stop_at_once, .user = &share };
	struct gz_particles particles;
	(void)state;
	char *text = malloc((size_t)MANY * 6 + 1);
	assert_non_null(text);
	for (size_t i = 0; i < MANY; i++)
		memcpy(text + 6 * i, "1 2 3\n", 6);
	const struct gz_particle_request request = {
		.path = files_write("a.xyz", text, (size_t)MANY * 6), .loading = &loading
	};
	free(text);
	assert_int_equal(gz_particles_load(&request, &particles), GZ_ERR_CANCELLED);
	assert_true(share > 0.5 && share < 1);
}

/* Computed from the files by Python's struct, without this code. */
struct real_file {
	const char *name;
	size_t count;
	double sum[3], least[3], greatest[3];
	enum gz_particle_value value;
	double value_sum;
};

static const struct real_file real_files[] = {
	{ .name = "bunny_frame_14_7705_particles.vtk",
	  .count = 7706,
	  .sum = { 1203.1431390200305, 10506.900533020496, -1183.077046958555 },
	  .least = { -0.60871422290802, 0.6701403260231018, -0.9785038828849792 },
	  .greatest = { 0.7241355180740356, 2.031560182571411, 0.679611325263977 },
	  .value = GZ_PARTICLE_SPEED,
	  .value_sum = 18265.18446909959 },
	{ .name = "dam_break_frame_23_24389_particles.bgeo",
	  .count = 24389,
	  .sum = { -625.4535776037956, 9383.949473507702, -0.007250354725329089 },
	  .least = { -1.5132832527160645, 0.031408946961164474, -0.764461874961853 },
	  .greatest = { 1.5161356925964355, 3.965916395187378, 0.7656753659248352 } },
	{ .name = "dam_break_frame_9_6859_particles.bgeo",
	  .count = 6859,
	  .sum = { -9602.484628915787, 1793.4332971461127, -0.04677293076747446 },
	  .least = { -1.9516323804855347, 0.03568214178085327, -0.7104318737983704 },
	  .greatest = { -0.3876219689846039, 0.6816501021385193, 0.7108961343765259 },
	  .value = GZ_PARTICLE_DENSITY,
	  .value_sum = 5937215.097564697 },
	{ .name = "double_dam_break_frame_26_4732_particles.vtk",
	  .count = 4732,
	  .sum = { -0.12150707351975143, 170.65269374502532, 1.7941075030830689 },
	  .least = { -1.5152689218521118, -0.015251494012773037, -1.5150896310806274 },
	  .greatest = { 1.5152132511138916, 1.0168471336364746, 1.515228271484375 },
	  .value = GZ_PARTICLE_SPEED,
	  .value_sum = 6739.160622944556 },
	{ .name = "sailors_knot_19539_particles.vtk",
	  .count = 19539,
	  .sum = { 2.13637765747535, 1191.198792682153, -516.3611483155546 },
	  .least = { -1.0081467628479004, -0.9321570992469788, -0.683194100856781 },
	  .greatest = { 1.0113160610198975, 1.0539525747299194, 0.6255173087120056 } },
};

static void check_real_file(const struct real_file *file, const struct gz_particles *particles)
{
	double value_sum = 0;
	assert_int_equal(particles->count, file->count);
	for (int axis = 0; axis < 3; axis++) {
		double sum = 0, least = INFINITY, greatest = -INFINITY;
		for (size_t i = 0; i < particles->count; i++) {
			sum += particles->positions[i][axis];
			least = fmin(least, particles->positions[i][axis]);
			greatest = fmax(greatest, particles->positions[i][axis]);
		}
		if (fabs(sum - file->sum[axis]) > 1e-9 * file->count ||
		    least != file->least[axis] || greatest != file->greatest[axis])
			fail_msg("%s: axis %d: sum %.12g, %.17g to %.17g", file->name, axis, sum,
				 least, greatest);
	}
	for (size_t i = 0; i < particles->count && particles->values; i++)
		value_sum += (double)particles->values[i];
	if (fabs(value_sum - file->value_sum) > 1e-7 * file->value_sum)
		fail_msg("%s: values %.12g", file->name, value_sum);
}

static void real_files_have_their_numbers(void **state)
{
	const char *data = getenv("GAZECAST_DATA");
	(void)state;
	for (size_t i = 0; data && i < sizeof real_files / sizeof real_files[0]; i++) {
		struct captured_log log;
		struct gz_particles particles;
		char path[2048];
		snprintf(path, sizeof path, "%s/particles/%s", data, real_files[i].name);
		if (access(path, F_OK) != 0) {
			print_message("not there: %s\n", path);
			continue;
		}
		if (load_file(path, real_files[i].value, 0, &log, &particles) != GZ_OK ||
		    log.messages != 0)
			fail_msg("%s", log.last);
		check_real_file(&real_files[i], &particles);
		gz_particles_free(&particles);
	}
}

TEST_SUITE(particle_files)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(every_format_gives_its_numbers),
		cmocka_unit_test(time_steps_are_read_one_by_one),
		cmocka_unit_test(counts_that_lie_are_refused),
		cmocka_unit_test(damaged_files_are_refused),
		cmocka_unit_test(cut_and_changed_files_end),
		cmocka_unit_test(particles_without_numbers_are_counted),
		cmocka_unit_test(particles_outside_their_box_are_counted),
		cmocka_unit_test(a_value_that_is_missing_is_named),
		cmocka_unit_test(loading_can_be_stopped),
		cmocka_unit_test(real_files_have_their_numbers),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
