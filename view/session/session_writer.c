#include "view/session/session_writer.h"

#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>
#include <zlib.h>

#include "base/file.h"
#include "protocol/gaze_log.h"
#include "render/scene/scene_files.h"
#include "render/scene/scene_write.h"
#include "view/session/session.h"
#include "view/settings/scene_keys.h"

#define GZ_LOG_MODULE "session"

struct gz_session_writer {
	const struct gz_log *log;
	char path[GZ_PATH_SIZE];
	int frames_fd, gaze_fd;
	struct gz_text lines; /* to be written together */
	uint64_t size;        /* of the complete lines in the file, bytes */
	uint32_t crc;         /* CRC-32 of these lines */
	uint64_t frames;
	bool any; /* a frame has been added */
	bool failed;
	int tables;                        /* spacing tables written so far */
	struct gz_scene_settings settings; /* of the last frame in the file */
	struct gz_transfer transfer;
	double finer;            /* as of the last frame; 0: there was none */
	struct gz_raised raised; /* as of the last frame */
	struct gz_illustration_change change;
	bool gaze_known; /* gaze_ns is valid */
	int64_t gaze_ns;
	uint64_t gaze_samples;
	struct gz_gaze_log_writer gaze;
};

static enum gz_result path_in_session(const struct gz_session_writer *writer, const char *name,
				      char path[GZ_PATH_SIZE])
{
	if (gz_text_print(path, GZ_PATH_SIZE, "%s/%s", writer->path, name) == GZ_OK)
		return GZ_OK;
	gz_err(writer->log, "%s: the path of the session is too long; choose a shorter one",
	       writer->path);
	return GZ_ERR_FULL;
}

/* Log the first error and write nothing more. */
static enum gz_result stop_recording(struct gz_session_writer *writer, const char *what, int error)
{
	if (!writer->failed)
		gz_err(writer->log,
		       "%s: the recording stops: %s: %s; the %llu frames before are complete",
		       writer->path, what, strerror(error), (unsigned long long)writer->frames);
	writer->failed = true;
	return GZ_ERR_IO;
}

/* Write all collected lines, or none of them. */
static enum gz_result flush(struct gz_session_writer *writer)
{
	struct gz_text *lines = &writer->lines;
	if (lines->failed)
		return stop_recording(writer, GZ_SESSION_FRAMES, ENOMEM);
	if (lines->length == 0)
		return GZ_OK;
	const size_t done = gz_write_all(writer->frames_fd, lines->bytes, lines->length);
	if (done < lines->length) {
		const int error = errno;
		/* If that fails as well, readers drop the incomplete line. */
		if (ftruncate(writer->frames_fd, (off_t)writer->size) == 0)
			lseek(writer->frames_fd, (off_t)writer->size, SEEK_SET);
		return stop_recording(writer, GZ_SESSION_FRAMES, error);
	}
	writer->crc =
		(uint32_t)crc32(writer->crc, (const Bytef *)lines->bytes, (uInt)lines->length);
	writer->size += lines->length;
	lines->length = 0;
	return GZ_OK;
}

static int create(const struct gz_session_writer *writer, const char *name)
{
	char path[GZ_PATH_SIZE];
	if (path_in_session(writer, name, path) != GZ_OK)
		return -1;
	const int fd = open(path, O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0600);
	if (fd < 0)
		gz_err(writer->log, "cannot create %s: %s; choose another folder", path,
		       strerror(errno));
	return fd;
}

static void print_table(const struct gz_spacing_table *table, struct gz_text *text)
{
	gz_text_add(text, "# eccentricity_deg spacing step\nunit %s\n",
		    table->in_deg ? "deg" : "px");
	for (int i = 0; i < table->count; i++)
		gz_text_add(text, "%.17g %.17g %.17g\n", table->rows[i].eccentricity_deg,
			    table->rows[i].spacing, table->rows[i].step);
}

/* Copy the spacing table into the folder; @p foveation then names the copy. */
static enum gz_result copy_table(struct gz_session_writer *writer, struct gz_foveation *foveation)
{
	struct gz_text text = { 0 };
	char path[GZ_PATH_SIZE];
	if (foveation->table.count == 0) {
		foveation->table_file[0] = '\0';
		return GZ_OK;
	}
	snprintf(foveation->table_file, sizeof foveation->table_file, "table-%d.txt",
		 ++writer->tables);
	print_table(&foveation->table, &text);
	enum gz_result r = path_in_session(writer, foveation->table_file, path);
	if (r == GZ_OK)
		r = gz_text_write(&text, path, writer->log);
	gz_text_free(&text);
	return r;
}

/* Write the scene, with paths relative to its new place, and the files it needs. */
static enum gz_result write_session_scene(struct gz_session_writer *writer,
					  const struct gz_session_start *start)
{
	char path[GZ_PATH_SIZE], transfer[GZ_PATH_SIZE];
	struct gz_scene_settings *settings = &writer->settings;
	enum gz_result r = path_in_session(writer, GZ_SESSION_SCENE, path);
	if (r == GZ_OK)
		r = path_in_session(writer, GZ_SESSION_TRANSFER, transfer);
	if (r == GZ_OK)
		r = gz_transfer_write(start->transfer, transfer, writer->log);
	settings->foveation.table_file[0] = settings->transfer_also[0] = '\0';
	if (r == GZ_OK)
		r = gz_scene_move_files(settings, start->scene, path, writer->log);
	if (r == GZ_OK)
		r = copy_table(writer, &settings->foveation);
	snprintf(settings->transfer_file, sizeof settings->transfer_file, GZ_SESSION_TRANSFER);
	const struct gz_scene_saved saved = {
		.settings = settings,
		.has_display = start->has_display,
		.path = path,
	};
	return r == GZ_OK ? gz_scene_write(&saved, path, writer->log) : r;
}

static void print_now(char *text, size_t size)
{
	struct tm utc;
	const time_t now = time(NULL);
	gmtime_r(&now, &utc);
	strftime(text, size, "%Y-%m-%dT%H:%M:%SZ", &utc);
}

static enum gz_result begin_frames(struct gz_session_writer *writer,
				   const struct gz_session_start *start)
{
	struct gz_session_header header = {
		.host_ns = start->now_ns,
		.volume = gz_volume_identify(start->volume),
	};
	print_now(header.started, sizeof header.started);
	snprintf(header.software, sizeof header.software, "%s", start->software);
	snprintf(header.backend, sizeof header.backend, "%s", start->backend);
	gz_session_print_header(&header, &writer->lines);
	writer->crc = (uint32_t)crc32(0, NULL, 0);
	writer->frames_fd = create(writer, GZ_SESSION_FRAMES);
	return writer->frames_fd < 0 ? GZ_ERR_IO : flush(writer);
}

static enum gz_result begin_gaze(struct gz_session_writer *writer,
				 const struct gz_session_start *start)
{
	struct gz_gaze_log_header header = {
		.tracker = "gazeview",
		.rate_hz = start->rate_hz,
		.has_display = true,
		.display = *start->display,
	};
	print_now(header.started, sizeof header.started);
	snprintf(header.serial, sizeof header.serial, "%s", start->source);
	snprintf(header.software, sizeof header.software, "%s", start->software);
	writer->gaze_fd = create(writer, GZ_SESSION_GAZE);
	if (writer->gaze_fd < 0)
		return GZ_ERR_IO;
	enum gz_result r = gz_gaze_log_writer_begin(&writer->gaze, writer->gaze_fd, &header);
	if (r == GZ_OK)
		r = gz_gaze_log_writer_flush(&writer->gaze);
	return r == GZ_OK ? r : stop_recording(writer, GZ_SESSION_GAZE, errno);
}

static enum gz_result make_session_folder(const struct gz_session_writer *writer)
{
	if (mkdir(writer->path, 0700) == 0)
		return GZ_OK;
	const int error = errno;
	gz_err(writer->log, "%s: cannot create the session's folder: %s; %s", writer->path,
	       strerror(error),
	       error == EEXIST ? "choose another name" : "choose a folder that you may write to");
	return error == EEXIST ? GZ_ERR_BUSY : GZ_ERR_IO;
}

/* Remove a session whose start failed. Nobody else writes to the folder. */
static void remove_all(const struct gz_session_writer *writer)
{
	static const char *const names[] = {
		GZ_SESSION_SCENE, GZ_SESSION_TRANSFER, GZ_SESSION_FRAMES,
		GZ_SESSION_GAZE,  "table-1.txt",
	};
	char path[GZ_PATH_SIZE];
	for (size_t i = 0; i < sizeof names / sizeof names[0]; i++)
		if (snprintf(path, sizeof path, "%s/%s", writer->path, names[i]) < GZ_PATH_SIZE)
			unlink(path);
	rmdir(writer->path);
}

static void release_session_writer(struct gz_session_writer *writer)
{
	if (writer->frames_fd >= 0)
		close(writer->frames_fd);
	if (writer->gaze_fd >= 0)
		close(writer->gaze_fd);
	gz_text_free(&writer->lines);
	free(writer);
}

enum gz_result gz_session_writer_begin(const struct gz_session_start *start,
				       const struct gz_log *log,
				       struct gz_session_writer **out_writer)
{
	struct gz_session_writer *writer = calloc(1, sizeof *writer);
	if (!writer)
		return GZ_ERR_NO_MEM;
	writer->log = log;
	writer->frames_fd = writer->gaze_fd = -1;
	snprintf(writer->path, sizeof writer->path, "%s", start->path);
	memcpy(&writer->settings, start->settings, sizeof writer->settings);
	writer->transfer = *start->transfer;
	enum gz_result r = make_session_folder(writer);
	if (r != GZ_OK) {
		release_session_writer(writer);
		return r;
	}
	r = write_session_scene(writer, start);
	if (r == GZ_OK)
		r = begin_frames(writer, start);
	if (r == GZ_OK)
		r = begin_gaze(writer, start);
	if (r != GZ_OK) {
		remove_all(writer);
		release_session_writer(writer);
		return r;
	}
	*out_writer = writer;
	return GZ_OK;
}

/* Append a line if a setting differs from the one in the file. */
static void print_change(const struct gz_option *option, const void *before, const void *now,
			 struct gz_text *lines)
{
	char old[GZ_PATH_SIZE], new[GZ_PATH_SIZE];
	if (gz_option_same(option, before, now) ||
	    gz_option_format(option, before, old, sizeof old) != GZ_OK ||
	    gz_option_format(option, now, new, sizeof new) != GZ_OK || strcmp(old, new) == 0)
		return;
	/* A scene file cannot hold a line break. */
	if (strpbrk(new, "\r\n"))
		return;
	gz_text_add(lines, GZ_SESSION_SET_WORD "\t%s\t%s\n", option->key, new);
}

/* Keep the names that are right in the session's folder. */
static void keep_names(const struct gz_scene_settings *from, struct gz_scene_settings *to)
{
	memcpy(to->volume_file, from->volume_file, sizeof to->volume_file);
	memcpy(to->transfer_file, from->transfer_file, sizeof to->transfer_file);
	memcpy(to->transfer_also, from->transfer_also, sizeof to->transfer_also);
	memcpy(to->foveation.table_file, from->foveation.table_file,
	       sizeof to->foveation.table_file);
	memcpy(to->rays.environment.cube, from->rays.environment.cube,
	       sizeof to->rays.environment.cube);
}

/* Append lines for what changed; the writer's settings become the new ones. */
static enum gz_result print_changes(struct gz_session_writer *writer,
				    const struct gz_scene_settings *settings)
{
	struct gz_view_live_tables old, new;
	struct gz_scene_settings now;
	struct gz_scene_settings *before = &writer->settings;
	memcpy(&now, settings, sizeof now);
	keep_names(before, &now);
	if (gz_scene_settings_same(&now, before))
		return GZ_OK;
	if (!gz_spacing_table_same(&now.foveation.table, &before->foveation.table)) {
		const enum gz_result r = copy_table(writer, &now.foveation);
		if (r != GZ_OK)
			return r;
	}
	gz_view_pick_live_tables(before, &old);
	gz_view_pick_live_tables(&now, &new);
	for (size_t i = 0; i < old.count; i++)
		for (size_t k = 0; k < old.bindings[i].count; k++)
			print_change(&old.bindings[i].options[k], old.bindings[i].target,
				     new.bindings[i].target, &writer->lines);
	memcpy(before, &now, sizeof now);
	return GZ_OK;
}

/* The lines of a .tf file, separated by tabs. */
static void print_transfer(const struct gz_transfer *transfer, struct gz_text *lines)
{
	struct gz_text text = { 0 };
	gz_transfer_print(transfer, &text);
	while (text.length > 0 && text.bytes[text.length - 1] == '\n')
		text.length--;
	for (size_t i = 0; i < text.length; i++)
		if (text.bytes[i] == '\n')
			text.bytes[i] = '\t';
	gz_text_add(lines, GZ_SESSION_TRANSFER_WORD "\t");
	gz_text_add_bytes(lines, text.bytes, text.length);
	gz_text_add(lines, "\n");
	lines->failed = lines->failed || text.failed;
	gz_text_free(&text);
}

enum gz_result gz_session_writer_add(struct gz_session_writer *writer,
				     const struct gz_scene_settings *settings,
				     const struct gz_transfer *transfer,
				     const struct gz_session_frame *frame)
{
	if (writer->failed)
		return GZ_ERR_IO;
	const enum gz_result r = print_changes(writer, settings);
	if (r != GZ_OK)
		return stop_recording(writer, "the spacing table", errno);
	if (!gz_transfer_same(&writer->transfer, transfer)) {
		print_transfer(transfer, &writer->lines);
		writer->transfer = *transfer;
	}
	const double finer = fmax(frame->focus.finer, 1);
	if (finer != fmax(writer->finer, 1))
		gz_session_print_finer(finer, &writer->lines);
	writer->finer = finer;
	if (!gz_raised_same(&writer->raised, &frame->raised))
		gz_session_print_raised(&frame->raised, &writer->lines);
	writer->raised = frame->raised;
	if (!gz_illustration_change_same(&writer->change, &frame->change))
		gz_session_print_change(&frame->change, &writer->lines);
	writer->change = frame->change;
	gz_session_print_frame(frame, &writer->lines);
	const enum gz_result flushed = flush(writer);
	writer->frames += flushed == GZ_OK;
	return flushed;
}

enum gz_result gz_session_writer_gaze(struct gz_session_writer *writer,
				      const struct gz_gaze_reading *reading, int64_t now_ns)
{
	const int64_t host_ns = reading->has_age ? now_ns - reading->age_ns : now_ns;
	if (writer->failed)
		return GZ_ERR_IO;
	if (!reading->known || (writer->gaze_known && host_ns <= writer->gaze_ns))
		return GZ_OK;
	struct gz_gaze_log_record record = {
		.kind = GZ_GAZE_LOG_SAMPLE,
		.sample = gz_sample_unmeasured(),
	};
	record.sample.seq = writer->gaze_samples++;
	record.sample.host_ns = host_ns;
	record.sample.point = reading->point;
	record.sample.valid = !reading->has_event ||
			      (reading->event != GZ_EVENT_BLINK && reading->event != GZ_EVENT_LOST);
	writer->gaze_known = true;
	writer->gaze_ns = host_ns;
	enum gz_result r = gz_gaze_log_writer_add(&writer->gaze, &record);
	if (r == GZ_OK)
		r = gz_gaze_log_writer_flush(&writer->gaze);
	return r == GZ_OK ? r : stop_recording(writer, GZ_SESSION_GAZE, errno);
}

uint64_t gz_session_writer_frames(const struct gz_session_writer *writer)
{
	return writer->frames;
}

const char *gz_session_writer_path(const struct gz_session_writer *writer)
{
	return writer->path;
}

enum gz_result gz_session_writer_end(struct gz_session_writer **writer)
{
	struct gz_session_writer *self = *writer;
	*writer = NULL;
	if (!self)
		return GZ_OK;
	enum gz_result r = GZ_ERR_IO;
	if (!self->failed) {
		gz_session_print_end(self->frames, self->crc, &self->lines);
		r = flush(self);
		if (r == GZ_OK && gz_gaze_log_writer_end(&self->gaze) != GZ_OK)
			r = stop_recording(self, GZ_SESSION_GAZE, errno);
	}
	release_session_writer(self);
	return r;
}

enum gz_result gz_recording_check(const char *path, const struct gz_log *log)
{
	if (access(path, F_OK) != 0)
		return GZ_OK;
	gz_err(log, "--record %s: already exists; choose another name", path);
	return GZ_ERR_BUSY;
}

enum gz_result gz_recording_begin(const struct gz_recording_start *start, const struct gz_log *log,
				  struct gz_session_writer **out_writer)
{
	const struct gz_scene *scene = gz_frame_maker_scene(start->maker);
	const struct gz_session_start session = {
		.path = start->path,
		.scene = start->scene,
		.settings = start->settings,
		.has_display = scene->has_display,
		.transfer = &scene->transfer,
		.volume = &scene->volume,
		.display = start->display,
		.software = "gazeview " GAZECAST_VERSION,
		.backend = gz_frame_backend(start->maker),
		.source = start->source,
		.rate_hz = start->rate_hz,
		.now_ns = start->now_ns,
	};
	const enum gz_result r = gz_session_writer_begin(&session, log, out_writer);
	if (r != GZ_OK)
		return r;
	gz_frame_forget(start->maker);
	if (scene->volume.bricks)
		gz_warn(log,
			"%s: a replay shows all bricks of the volume, not only those loaded at the "
			"time",
			start->path);
	return GZ_OK;
}

enum gz_result gz_recording_add(struct gz_session_writer *writer,
				const struct gz_frame_maker *maker,
				const struct gz_frame_request *request,
				const struct gz_frame_record *record, int64_t time_ns)
{
	const struct gz_session_frame frame = {
		.time_ns = time_ns > 0 ? time_ns : 0,
		.width = request->width,
		.height = request->height,
		.display = *request->display,
		.reading = *gz_frame_reading(maker),
		.focus = record->focus,
		.raised = gz_frame_raised(maker),
		.change = gz_frame_change(maker),
		.kept = record->kept,
		.took_ms = record->total_ms,
	};
	return gz_session_writer_add(writer, request->settings,
				     &gz_frame_maker_scene(maker)->transfer, &frame);
}
