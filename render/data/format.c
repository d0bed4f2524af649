#include "render/data/format.h"

#include <string.h>

#include "base/file.h"

#define GZ_LOG_MODULE "volume"

const struct gz_volume_format *const gz_volume_formats[] = {
	&gz_format_nifti,   &gz_format_mgh,   &gz_format_nrrd,          &gz_format_metaimage,
	&gz_format_bricks,  &gz_format_dicom, &gz_format_minc,          &gz_format_inv3,
	&gz_format_foreign, &gz_format_raw,   &gz_format_raw_by_layout,
};
const size_t gz_volume_format_count = sizeof gz_volume_formats / sizeof gz_volume_formats[0];

static bool has_ending(const struct gz_volume_format *format, const char *path)
{
	for (size_t i = 0; i < GZ_FORMAT_ENDINGS_MAX && format->endings[i]; i++)
		if (gz_path_ends(path, format->endings[i]))
			return true;
	return false;
}

const struct gz_volume_format *gz_volume_format_by_name(const char *path)
{
	for (size_t i = 0; i < gz_volume_format_count; i++) {
		const struct gz_volume_format *format = gz_volume_formats[i];
		if (has_ending(format, path))
			return format;
	}
	return NULL;
}

static const struct gz_volume_format *format_by_start(const struct gz_file_start *start)
{
	for (size_t i = 0; i < gz_volume_format_count; i++) {
		const struct gz_volume_format *format = gz_volume_formats[i];
		if (format->knows_start && format->knows_start(start))
			return format;
	}
	return NULL;
}

const struct gz_volume_format *gz_volume_format_by_content(const char *path)
{
	struct gz_file_start start;
	const struct gz_volume_format *found =
		gz_file_start_read(path, &start) ? format_by_start(&start) : NULL;
	for (size_t i = 0; i < gz_volume_format_count && !found; i++) {
		const struct gz_volume_format *format = gz_volume_formats[i];
		if (format->recognise && format->recognise(path))
			found = format;
	}
	return found;
}

static void print_format(const struct gz_volume_format *format, FILE *out)
{
	fprintf(out, "%s", format->name);
	for (size_t i = 0; i < GZ_FORMAT_ENDINGS_MAX && format->endings[i]; i++)
		fprintf(out, " %s", format->endings[i]);
	fprintf(out, "\n    %s\n", format->limits);
}

void gz_volume_formats_print(FILE *out)
{
	for (size_t i = 0; i < gz_volume_format_count; i++)
		print_format(gz_volume_formats[i], out);
}

gz_volume_writer *gz_volume_writer_by_name(const char *path)
{
	for (size_t i = 0; i < gz_volume_format_count; i++)
		if (gz_volume_formats[i]->write &&
		    gz_path_ends(path, gz_volume_formats[i]->endings[0]))
			return gz_volume_formats[i]->write;
	return NULL;
}

static enum gz_result refuse_unknown_format(const struct gz_volume_file *file)
{
	gz_err(file->log, "%s: unknown format; gazeview --formats lists what is read", file->path);
	return GZ_ERR_UNSUPPORTED;
}

/* Tell that the content is of another format than the name says; of each the one that it is. */
static void tell_wrong_name(const struct gz_volume_file *file, const struct gz_volume_format *named,
			    const struct gz_volume_format *found)
{
	struct gz_file_start start;
	const bool by_start = found->name_start && gz_file_start_read(file->path, &start) &&
			      found->knows_start(&start);
	/* A name stands for the first format of its row. */
	gz_info(file->log, "%s: its name says %.*s, its content is %s", file->path,
		(int)strcspn(named->name, ","), named->name,
		by_start ? found->name_start(&start) : found->name);
}

/* By the content; only if that tells nothing, by the name. Whoever gives a layout says by that what
 * the content is. */
static const struct gz_volume_format *choose_format(const struct gz_volume_file *file)
{
	const struct gz_volume_format *named = gz_volume_format_by_name(file->path);
	const struct gz_volume_format *found = gz_volume_format_by_content(file->path);
	if (file->raw) {
		if (found && named && named->layout != GZ_LAYOUT_IN_FILE)
			gz_warn(file->log,
				"%s: its content is %s; taken as raw, because a layout is given",
				file->path, found->name);
		return named;
	}
	if (!found)
		return named && named->layout == GZ_LAYOUT_IF_GIVEN ? NULL : named;
	if (named && named != found && named->layout != GZ_LAYOUT_IF_GIVEN)
		tell_wrong_name(file, named, found);
	return found;
}

enum gz_result gz_volume_load(const char *path, const struct gz_raw_layout *raw,
			      const struct gz_loading *loading, const struct gz_log *log,
			      struct gz_volume *out_volume)
{
	const struct gz_volume_file file = { path, raw, loading, log };
	const struct gz_volume_format *format = choose_format(&file);
	if (!format)
		return refuse_unknown_format(&file);
	if (raw && format->layout == GZ_LAYOUT_IN_FILE) {
		gz_err(log, "%s: has a header; leave out dims, type, endian and spacing", path);
		return GZ_ERR_INVAL;
	}
	if (!raw && format->layout == GZ_LAYOUT_GIVEN) {
		gz_err(log, "%s: raw data without a header; give dims, type, endian and spacing",
		       path);
		return GZ_ERR_INVAL;
	}
	return format->load(&file, out_volume);
}
