/* Transfer functions to text: docs/scenes.md has the grammar. */
#include "base/text.h"
#include "render/transfer/transfer.h"

#define GZ_LOG_MODULE "transfer"

static void print_numbers(const double *numbers, int count, const char *before,
			  struct gz_text *text)
{
	for (int i = 0; i < count; i++) {
		char number[GZ_NUMBER_SIZE];
		gz_number_print(numbers[i], number);
		gz_text_add(text, "%s%s", i == 0 ? before : " ", number);
	}
}

void gz_transfer_print(const struct gz_transfer *transfer, struct gz_text *text)
{
	gz_text_add(text, "# value r g b a\n");
	if (transfer->has_range) {
		print_numbers(transfer->range, 2, "range ", text);
		gz_text_add(text, "\n");
	}
	if (transfer->interpolation == GZ_TRANSFER_QUADRATIC)
		gz_text_add(text, "interpolation quadratic\n");
	for (size_t i = 0; i < transfer->count; i++) {
		const struct gz_transfer_point *point = &transfer->points[i];
		print_numbers(&point->value, 1, "", text);
		print_numbers(point->rgb, 3, "  ", text);
		print_numbers(&point->opacity, 1, "  ", text);
		gz_text_add(text, "\n");
	}
}

enum gz_result gz_transfer_write(const struct gz_transfer *transfer, const char *path,
				 const struct gz_log *log)
{
	struct gz_text text = { 0 };
	struct gz_transfer read;
	enum gz_result result = GZ_ERR_INVAL;
	if (transfer->count <= GZ_TRANSFER_POINTS_MAX)
		gz_transfer_print(transfer, &text);
	if (text.failed || gz_transfer_parse(path, text.bytes, text.length, log, &read) == GZ_OK)
		result = gz_text_write(&text, path, log);
	gz_text_free(&text);
	return result;
}
