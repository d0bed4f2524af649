#include "client/gazectl/output.h"

#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <string.h>
#include <unistd.h>

#include "base/text.h"
#include "base/utf8.h"
#include "client/gazectl/convert/text_lines.h"

#define GZ_LOG_MODULE "output"

enum gz_result gz_output_begin(struct gz_output_file *file, const char *path, bool overwrite,
			       enum gz_output_kind kind, const struct gz_log *log)
{
	*file = (struct gz_output_file) { .fd = -1 };
	int length = snprintf(file->path, sizeof file->path, "%s", path);
	if (length < 0 || (size_t)length >= sizeof file->path) {
		gz_err(log, "%s: the name is too long; choose a shorter one", path);
		return GZ_ERR_INVAL;
	}
	if (!overwrite && access(path, F_OK) == 0) {
		gz_err(log, "%s exists; choose another name, or give --force to replace it", path);
		return GZ_ERR_BUSY;
	}
	snprintf(file->partial, sizeof file->partial, "%s.part", path);
	file->fd = open(file->partial, O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
	if (file->fd < 0) {
		gz_err(log, "cannot write %s: %s; choose a folder that you may write to", path,
		       strerror(errno));
		return GZ_ERR_IO;
	}
	file->open = true;
	if (kind == GZ_OUTPUT_TEXT)
		file->text = fdopen(file->fd, "w");
	else if (kind == GZ_OUTPUT_GZIP)
		file->gzip = gzdopen(file->fd, "wb");
	if (kind != GZ_OUTPUT_RAW && !file->text && !file->gzip) {
		gz_output_end(file, false, log);
		return GZ_ERR_NO_MEM;
	}
	return GZ_OK;
}

enum gz_result gz_output_check_svg(const char *path, const struct gz_log *log)
{
	size_t length = strlen(path);
	if (length == 0 || (length > 4 && strcmp(path + length - 4, ".svg") == 0))
		return GZ_OK;
	gz_err(log, "--picture: the picture is SVG, so %s must end in .svg", path);
	return GZ_ERR_INVAL;
}

/* Close the file. @return whether everything has been written to it */
static bool close_output(struct gz_output_file *file)
{
	if (file->text) {
		bool failed = ferror(file->text) != 0;
		return fclose(file->text) == 0 && !failed;
	}
	if (file->gzip)
		return gzclose(file->gzip) == Z_OK;
	return close(file->fd) == 0;
}

enum gz_result gz_output_end(struct gz_output_file *file, bool complete, const struct gz_log *log)
{
	if (!file->open)
		return GZ_OK;
	errno = 0;
	bool written = close_output(file);
	if (written && complete && rename(file->partial, file->path) != 0)
		written = false;
	if (!written)
		gz_err(log, "cannot write %s: %s", file->path,
		       errno ? strerror(errno) : "is the disk full?");
	if (!written || !complete)
		unlink(file->partial);
	*file = (struct gz_output_file) { .fd = -1 };
	return written ? GZ_OK : GZ_ERR_IO;
}

json_t *gz_output_json_text(const char *text)
{
	static const char replacement[] = "\xef\xbf\xbd"; /* U+FFFD */
	json_t *json = json_string(text);
	if (json)
		return json;
	struct gz_text valid = { 0 };
	const char *end = text + strlen(text);
	for (const char *s = text; s < end;) {
		size_t length = gz_utf8_length(s, (size_t)(end - s));
		if (length > 0)
			gz_text_add_bytes(&valid, s, length);
		else
			gz_text_add_bytes(&valid, replacement, sizeof replacement - 1);
		s += length > 0 ? length : 1;
	}
	json = valid.failed ? NULL : json_string(valid.bytes);
	gz_text_free(&valid);
	return json;
}

json_t *gz_output_json_number(double value)
{
	/* Larger numbers have an exponent, as "%.12g" prints them. */
	static const double whole_max = 1e12;
	if (!isfinite(value))
		return json_null();
	if (fabs(value) < whole_max && value == floor(value))
		return json_integer((json_int_t)value);
	return json_real(value);
}

json_t *gz_output_json_count(uint64_t value)
{
	/* jansson's whole numbers have a sign. */
	return value <= INT64_MAX ? json_integer((json_int_t)value) : json_real((double)value);
}

json_t *gz_output_json_numbers(const double *values, size_t count)
{
	json_t *list = json_array();
	for (size_t i = 0; i < count; i++)
		json_array_append_new(list, gz_output_json_number(values[i]));
	return list;
}

json_t *gz_output_json_tracker(const char *name, const char *serial)
{
	return json_pack("{so so}", "name", gz_output_json_text(name), "serial",
			 gz_output_json_text(serial));
}

json_t *gz_output_json_rate(double nominal_hz, double measured_hz)
{
	return json_pack("{so so}", "nominal", gz_output_json_number(nominal_hz), "measured",
			 gz_output_json_number(measured_hz));
}

json_t *gz_output_json_display(const struct gz_display *display)
{
	return json_pack("{s[ii] so so}", "px", display->px[0], display->px[1], "mm",
			 gz_output_json_numbers(display->mm, 2), "distance_mm",
			 gz_output_json_number(display->distance_mm));
}

enum gz_result gz_output_json_print(json_t *json, FILE *out, const struct gz_log *log)
{
	bool printed = json && json_dumpf(json, out, JSON_INDENT(2) | JSON_REAL_PRECISION(12)) == 0;
	json_decref(json);
	if (printed)
		fputc('\n', out);
	if (printed || ferror(out))
		return GZ_OK;
	gz_err(log, "out of memory for JSON");
	return GZ_ERR_NO_MEM;
}
