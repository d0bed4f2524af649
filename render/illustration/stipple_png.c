#include "render/illustration/stipple_png.h"

#include "render/picture/image.h"

/* A drawing that is being written. */
struct strip_writer {
	const struct gz_stipple_marks *marks;
	const int *size_px;
	int strip_rows;
	struct gz_workers *workers;
	struct gz_stipple_sheet strip;
};

static enum gz_result draw_strip(struct strip_writer *writer, int top)
{
	const struct gz_stipple_marks *marks = writer->marks;
	const int left = writer->size_px[1] - top;
	const int rows = left < writer->strip_rows ? left : writer->strip_rows;
	enum gz_result result =
		gz_stipple_sheet_clear_strip(&writer->strip, writer->size_px[0], top, rows);
	if (result == GZ_OK)
		result = gz_stipple_sheet_add_discs(&writer->strip, marks->discs, marks->disc_count,
						    writer->workers);
	if (result == GZ_OK)
		result = gz_stipple_sheet_add_pieces(&writer->strip, marks->pieces,
						     marks->piece_count, writer->workers);
	return result;
}

/* The grey row of a picture; draws the next strip where it begins. */
static enum gz_result make_strip_row(void *user, int y, uint8_t *out_greys)
{
	struct strip_writer *writer = user;
	const struct gz_stipple_sheet *strip = &writer->strip;
	if (y % writer->strip_rows == 0) {
		const enum gz_result result = draw_strip(writer, y);
		if (result != GZ_OK)
			return result;
	}
	const uint8_t *ink = strip->ink + (size_t)(y - strip->top) * strip->stride;
	for (int x = 0; x < strip->width; x++)
		out_greys[x] = (uint8_t)(255 - ink[x]);
	return GZ_OK;
}

enum gz_result gz_stipple_write_png(const struct gz_stipple_marks *marks, const int size_px[2],
				    int strip_rows, struct gz_workers *workers, const char *path,
				    const struct gz_log *log)
{
	struct strip_writer writer = {
		.marks = marks, .size_px = size_px, .strip_rows = strip_rows, .workers = workers
	};
	const struct gz_image_rows rows = { size_px[0], size_px[1], make_strip_row, &writer };
	if (size_px[0] < 1 || size_px[1] < 1 || size_px[0] > GZ_STIPPLE_SIDE_MAX ||
	    size_px[1] > GZ_STIPPLE_SIDE_MAX || strip_rows < 1)
		return GZ_ERR_INVAL;
	const enum gz_result result = gz_image_write_grey_png(&rows, path, log);
	gz_stipple_sheet_free(&writer.strip);
	return result;
}
