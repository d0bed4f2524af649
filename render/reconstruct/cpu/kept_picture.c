#include "render/reconstruct/cpu/kept_picture.h"

#include <string.h>

/* Rows that a thread copies at a time. Chosen: some 100 kB, which no thread waits for long. */
enum { PART_ROWS = 16 };

struct copy {
	const struct gz_image *from, *to;
};

static void copy_part(void *user, size_t part, int worker)
{
	const struct copy *copy = user;
	const size_t row_bytes = (size_t)copy->from->width * sizeof(uint32_t);
	const size_t first = part * PART_ROWS, rows = (size_t)copy->from->height;
	const size_t last = first + PART_ROWS < rows ? first + PART_ROWS : rows;
	(void)worker;
	memcpy(copy->to->pixels + first * row_bytes, copy->from->pixels + first * row_bytes,
	       (last - first) * row_bytes);
}

static void copy_pixels(const struct gz_image *from, const struct gz_image *to,
			struct gz_workers *workers)
{
	struct copy copy = { from, to };
	gz_workers_run(workers, copy_part, &copy,
		       ((size_t)from->height + PART_ROWS - 1) / PART_ROWS);
}

bool gz_kept_picture_take(const struct gz_kept_picture *kept, const struct gz_plan *plan,
			  uint64_t content, struct gz_workers *workers, struct gz_image *image)
{
	if (kept->content == 0 || kept->content != content || kept->image.width != plan->width ||
	    kept->image.height != plan->height || !gz_plan_is_exact(plan))
		return false;
	copy_pixels(&kept->image, image, workers);
	return true;
}

void gz_kept_picture_store(struct gz_kept_picture *kept, const struct gz_plan *plan,
			   uint64_t content, struct gz_workers *workers,
			   const struct gz_image *image)
{
	if (!gz_plan_is_exact(plan))
		return;
	kept->content = 0;
	if (gz_image_resize(&kept->image, image->width, image->height) != GZ_OK)
		return;
	copy_pixels(image, &kept->image, workers);
	kept->content = content;
}

void gz_kept_picture_free(struct gz_kept_picture *kept)
{
	gz_image_free(&kept->image);
	kept->content = 0;
}
