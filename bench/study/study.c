#include "bench/study/study.h"

#include <math.h>
#include <sched.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/utsname.h>
#include <unistd.h>

#include "base/clock.h"
#include "base/order.h"
#include "base/portable.h"
#include "bench/study/hash.h"
#include "sim/random.h"

/* Random streams of one seed: camera n uses this plus n; gaze points use 1. */
#define CAMERA_STREAM (UINT64_C(1) << 32)

const char *const gz_study_accuracy_names[] = { "none", "standard", "all", NULL };

void gz_study_free(struct gz_study *study)
{
	for (size_t i = 0; study->camera_paths && i < study->scene_count; i++)
		gz_camera_path_free(&study->camera_paths[i]);
	free(study->camera_paths);
	free(study->scenes);
	free(study->variants);
	free(study->sizes);
	free(study->backends);
	free(study->points);
	free(study->bound_rays);
	free(study->rows);
	*study = (struct gz_study) { 0 };
}

size_t gz_study_unit_count(const struct gz_study *study)
{
	return study->scene_count * study->size_count * study->backend_count * study->point_count;
}

size_t gz_study_shard_unit_count(const struct gz_study *study)
{
	const size_t units = gz_study_unit_count(study);
	const size_t shard = (size_t)study->shard, shards = (size_t)study->shard_count;
	return units > shard ? (units - shard - 1) / shards + 1 : 0;
}

size_t gz_study_unit_rows(const struct gz_study *study)
{
	return study->variant_count * (size_t)study->frames_per_point;
}

struct gz_study_errors gz_study_errors_unmeasured(void)
{
	return (struct gz_study_errors) { NAN, NAN, NAN, NAN, NAN, NAN, NAN, NAN, NAN };
}

struct gz_study_row gz_study_unit_row(const struct gz_study *study, size_t unit, size_t k)
{
	struct gz_study_row row = {
		.variant = (uint16_t)(k / (size_t)study->frames_per_point),
		.frame = (uint32_t)(k % (size_t)study->frames_per_point),
		.gpu_ms = NAN,
		.prepare_ms = NAN,
		.converged = gz_study_errors_unmeasured(),
		.standard = gz_study_errors_unmeasured(),
		.flicker = NAN,
		.turning_error = NAN,
		.camera_path_error = NAN,
		.reference_db = NAN,
	};
	row.point = (uint32_t)(unit % study->point_count);
	row.gaze = study->points[row.point].gaze;
	unit /= study->point_count;
	row.backend = (uint16_t)(unit % study->backend_count);
	unit /= study->backend_count;
	row.size = (uint16_t)(unit % study->size_count);
	row.scene = (uint16_t)(unit / study->size_count);
	return row;
}

struct gz_camera gz_study_camera(const struct gz_study *study, size_t scene, uint32_t camera)
{
	struct gz_camera seen = study->scenes[scene].camera;
	if (camera == 0)
		return seen;
	struct gz_random random = gz_random_seeded(study->seed, CAMERA_STREAM + camera);
	const double z = gz_random_between(&random, -1, 1);
	const double turn = gz_random_between(&random, 0, 2 * M_PI), ring = sqrt(1 - z * z);
	const double direction[3] = { ring * gz_portable_cos(turn), ring * gz_portable_sin(turn),
				      z };
	double square = 0;
	for (int axis = 0; axis < 3; axis++)
		square += (seen.eye[axis] - seen.look_at[axis]) *
			  (seen.eye[axis] - seen.look_at[axis]);
	for (int axis = 0; axis < 3; axis++)
		seen.eye[axis] = seen.look_at[axis] + sqrt(square) * direction[axis];
	return seen;
}

struct gz_display gz_study_display(const struct gz_study *study, size_t scene, size_t size)
{
	const int *px = study->sizes[size];
	if (!study->scenes[scene].display_known)
		return gz_display_default(px[0], px[1]);
	struct gz_display display = study->scenes[scene].display;
	memcpy(display.px, px, sizeof display.px);
	return display;
}

void gz_study_file_name(const char *path, const char *ending, char out_name[GZ_STUDY_TEXT_SIZE])
{
	const char *slash = strrchr(path, '/');
	const char *name = slash ? slash + 1 : path;
	size_t length = strlen(name);
	const size_t cut = strlen(ending);
	if (length > cut && strcmp(name + length - cut, ending) == 0)
		length -= cut;
	snprintf(out_name, GZ_STUDY_TEXT_SIZE, "%.*s", (int)length, name);
}

/* Receives the first difference of two studies. */
struct comparison {
	char *what;
	size_t size;
};

static bool text_differs(struct comparison *comparison, const char *name, const char *asked,
			 const char *was)
{
	if (strcmp(asked, was) == 0)
		return false;
	snprintf(comparison->what, comparison->size, "%s is %s, and was %s", name, asked, was);
	return true;
}

static bool number_differs(struct comparison *comparison, const char *name, double asked,
			   double was)
{
	if (asked == was)
		return false;
	snprintf(comparison->what, comparison->size, "%s is %.10g, and was %.10g", name, asked,
		 was);
	return true;
}

static bool scene_differs(struct comparison *comparison, const struct gz_study_scene *asked,
			  const struct gz_study_scene *was)
{
	if (text_differs(comparison, "a scene", asked->name, was->name) ||
	    text_differs(comparison, "a transfer function", asked->transfer, was->transfer))
		return true;
	if (strcmp(asked->hash, was->hash) == 0 && gz_camera_same(&asked->camera, &was->camera) &&
	    gz_display_same(&asked->display, &was->display))
		return false;
	snprintf(comparison->what, comparison->size,
		 "%s with %s is not the same scene: its text, its data or its display has changed",
		 asked->name, asked->transfer);
	return true;
}

/* What a message calls a file that may not be there. */
static const char *named(const char *file)
{
	return file[0] ? file : "none";
}

static bool lists_differ(struct comparison *comparison, const struct gz_study *asked,
			 const struct gz_study *was)
{
	for (size_t i = 0; i < asked->scene_count; i++)
		if (scene_differs(comparison, &asked->scenes[i], &was->scenes[i]))
			return true;
	for (size_t i = 0; i < asked->variant_count; i++)
		if (text_differs(comparison, "a method", asked->variants[i].text,
				 was->variants[i].text))
			return true;
	for (size_t i = 0; i < asked->backend_count; i++)
		if (text_differs(comparison, "a backend", asked->backends[i], was->backends[i]))
			return true;
	for (size_t i = 0; i < asked->size_count; i++) {
		const int *size = asked->sizes[i], *old = was->sizes[i];
		if (size[0] == old[0] && size[1] == old[1])
			continue;
		snprintf(comparison->what, comparison->size, "a size is %dx%d, and was %dx%d",
			 size[0], size[1], old[0], old[1]);
		return true;
	}
	return false;
}

bool gz_study_differs(const struct gz_study *study, const struct gz_study *was, char *what,
		      size_t size)
{
	struct comparison comparison = { what, size };
	const struct {
		const char *name;
		double asked, was;
	} numbers[] = {
		{ "the number of scenes and transfer functions", (double)study->scene_count,
		  (double)was->scene_count },
		{ "the number of methods", (double)study->variant_count,
		  (double)was->variant_count },
		{ "the number of sizes", (double)study->size_count, (double)was->size_count },
		{ "the number of backends", (double)study->backend_count,
		  (double)was->backend_count },
		{ "--min-move", study->min_move_px, was->min_move_px },
		{ "--per-cell", study->per_cell, was->per_cell },
		{ "the number of points", (double)study->point_count, (double)was->point_count },
		{ "the number of cameras", study->camera_count, was->camera_count },
		{ "the seed", (double)study->seed, (double)was->seed },
		{ "the number of frames", study->frames_per_point, was->frames_per_point },
		{ "the number of warm-up frames", study->warm_up_frames, was->warm_up_frames },
	};
	const char *accuracy = gz_study_accuracy_names[study->accuracy];
	if (text_differs(&comparison, "the program", study->machine.program,
			 was->machine.program) ||
	    text_differs(&comparison, "the commit", study->machine.commit, was->machine.commit) ||
	    text_differs(&comparison, "the path", study->path, was->path) ||
	    text_differs(&comparison, "--errors", accuracy, gz_study_accuracy_names[was->accuracy]))
		return true;
	for (size_t i = 0; i < sizeof numbers / sizeof numbers[0]; i++)
		if (number_differs(&comparison, numbers[i].name, numbers[i].asked, numbers[i].was))
			return true;
	return text_differs(&comparison, "the path's hash", study->path_hash, was->path_hash) ||
	       text_differs(&comparison, "--camera-path", named(study->camera_path),
			    named(was->camera_path)) ||
	       text_differs(&comparison, "the camera path's hash", study->camera_path_hash,
			    was->camera_path_hash) ||
	       lists_differ(&comparison, study, was);
}

/* ---- the machine ---- */

/* The value of the first line "name<blanks>between<blanks>value" of a file, without quotes. */
static void find_value(const char *path, const char *name, char between,
		       char out_value[GZ_STUDY_TEXT_SIZE])
{
	FILE *file = fopen(path, "re");
	char line[1024];
	snprintf(out_value, GZ_STUDY_TEXT_SIZE, "unknown");
	while (file && fgets(line, sizeof line, file)) {
		char *value = strchr(line, between);
		if (strncmp(line, name, strlen(name)) != 0 || !value)
			continue;
		value += 1 + strspn(value + 1, " \t\"");
		value[strcspn(value, "\"\n")] = '\0';
		snprintf(out_value, GZ_STUDY_TEXT_SIZE, "%.200s", value);
		break;
	}
	if (file)
		fclose(file);
}

void gz_study_machine_describe(struct gz_study_machine *out_machine)
{
	char text[GZ_STUDY_TEXT_SIZE];
	cpu_set_t processors;
	const int count = sched_getaffinity(0, sizeof processors, &processors) == 0
				  ? CPU_COUNT(&processors)
				  : 0;
	find_value("/proc/cpuinfo", "model name", ':', text);
	snprintf(out_machine->host_cpu, GZ_STUDY_TEXT_SIZE, "%.200s, %d processors", text, count);
	const double bytes = (double)sysconf(_SC_PHYS_PAGES) * (double)sysconf(_SC_PAGE_SIZE);
	snprintf(out_machine->memory, GZ_STUDY_TEXT_SIZE, "%.1f GiB", bytes / (1 << 30));
	struct utsname kernel;
	find_value("/etc/os-release", "PRETTY_NAME", '=', text);
	if (uname(&kernel) == 0)
		snprintf(out_machine->system, GZ_STUDY_TEXT_SIZE, "%.40s %.80s, %.100s",
			 kernel.sysname, kernel.release, text);
	else
		snprintf(out_machine->system, GZ_STUDY_TEXT_SIZE, "%.200s", text);
	snprintf(out_machine->compiler, GZ_STUDY_TEXT_SIZE, "%s%.150s, %s",
#ifdef __clang__
		 "",
#else
		 "gcc ",
#endif
		 __VERSION__, GZ_BUILD_TYPE);
}

double gz_study_copy_ms(int width, int height)
{
	enum { COPIES = 9 }; /* chosen: a median that one interruption does not move */
	struct gz_image from = { 0 }, to = { 0 };
	double ms[COPIES];
	bool made = gz_image_resize(&from, width, height) == GZ_OK &&
		    gz_image_resize(&to, width, height) == GZ_OK;
	const size_t bytes = (size_t)width * (size_t)height * 4;
	for (int i = 0; i < COPIES && made; i++) {
		const int64_t begin_ns = gz_clock_now_ns();
		memcpy(to.pixels, from.pixels, bytes);
		ms[i] = (double)(gz_clock_now_ns() - begin_ns) / GZ_NS_PER_MS;
		from.pixels[i] = to.pixels[bytes - 1 - (size_t)i]; /* no copy is left out */
	}
	gz_image_free(&from);
	gz_image_free(&to);
	if (!made)
		return NAN;
	qsort(ms, COPIES, sizeof ms[0], gz_compare_doubles);
	return ms[COPIES / 2];
}

/* SHA-256 of a file; false where it cannot be read. */
static bool hash_file(const char *path, char out_hex[GZ_STUDY_HASH_SIZE])
{
	FILE *file = fopen(path, "re");
	struct gz_hash *hash = NULL;
	unsigned char bytes[16384];
	size_t size;
	if (!file)
		return false;
	if (gz_hash_begin(&hash) != GZ_OK) {
		fclose(file);
		return false;
	}
	while ((size = fread(bytes, 1, sizeof bytes, file)) > 0)
		gz_hash_add(hash, bytes, size);
	const bool whole = !ferror(file);
	fclose(file);
	return gz_hash_end(&hash, out_hex) == GZ_OK && whole;
}

void gz_study_identify(const char *commit, const char *file, char out_text[GZ_STUDY_TEXT_SIZE])
{
	static const char dirty[] = "-dirty";
	const size_t length = strlen(commit), end = sizeof dirty - 1;
	char hex[GZ_STUDY_HASH_SIZE];
	const bool says_all = strcmp(commit, "unknown") != 0 &&
			      (length < end || strcmp(commit + length - end, dirty) != 0);
	if (!says_all && hash_file(file, hex))
		snprintf(out_text, GZ_STUDY_TEXT_SIZE, "%.200s-%.12s", commit, hex);
	else
		snprintf(out_text, GZ_STUDY_TEXT_SIZE, "%.200s", commit);
}
