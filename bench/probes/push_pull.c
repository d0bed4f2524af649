#include "bench/probes/push_pull.h"

#include <stdlib.h>
#include <string.h>

typedef struct gz_push_pull_level level_t;

struct job {
	level_t *fine, *coarse;
	struct gz_image *image;
};

enum gz_result gz_push_pull_take(struct gz_push_pull *push_pull, const struct gz_plan *plan,
				 const struct gz_image *image)
{
	int width = image->width, height = image->height;
	for (int i = 0; i < GZ_PUSH_PULL_LEVELS; i++) {
		level_t *level = &push_pull->levels[i];
		if (level->width != width || level->height != height) {
			free(level->points);
			*level = (level_t) { width, height, NULL };
			level->points =
				malloc((size_t)width * (size_t)height * sizeof *level->points);
		}
		if (!level->points) {
			level->width = 0;
			return GZ_ERR_NO_MEM;
		}
		width = (width + 1) / 2;
		height = (height + 1) / 2;
	}
	const level_t *picture = &push_pull->levels[0];
	memset(picture->points, 0,
	       (size_t)image->width * (size_t)image->height * sizeof *picture->points);
	for (size_t t = 0; t < plan->tile_count; t++)
		for (int ray = 0; ray < GZ_TILE_EDGE * GZ_TILE_EDGE; ray++) {
			const struct gz_tile *tile = &plan->tiles[t];
			const int spacing = plan->layers[tile->layer].spacing;
			const int x = tile->x + gz_tile_columns[tile->pattern][ray] * spacing;
			const int y = tile->y + gz_tile_rows[ray] * spacing;
			if (x >= image->width || y >= image->height)
				continue;
			const size_t index = (size_t)y * (size_t)image->width + (size_t)x;
			for (int c = 0; c < 3; c++)
				picture->points[index][c] = image->pixels[4 * index + (size_t)c];
			picture->points[index][3] = 1;
		}
	return GZ_OK;
}

static float *point(const level_t *level, int x, int y)
{
	return level->points[(size_t)y * (size_t)level->width + (size_t)x];
}

static int within(int i, int count)
{
	return i < 0 ? 0 : i < count ? i : count - 1;
}

/* A coarse row: means of two by two points, weighted by how sure they are. */
static void pull_row(void *user, size_t row, int worker)
{
	(void)worker;
	const struct job *job = user;
	const int y = (int)row;
	for (int x = 0; x < job->coarse->width; x++) {
		float sum[4] = { 0 };
		for (int k = 0; k < 4; k++) {
			const int from_x = 2 * x + (k & 1), from_y = 2 * y + (k >> 1);
			if (from_x >= job->fine->width || from_y >= job->fine->height)
				continue;
			const float *from = point(job->fine, from_x, from_y);
			for (int c = 0; c < 3; c++)
				sum[c] += from[3] * from[c];
			sum[3] += from[3];
		}
		float *to = point(job->coarse, x, y);
		for (int c = 0; c < 3; c++)
			to[c] = sum[3] > 0 ? sum[c] / sum[3] : 0;
		to[3] = sum[3] < 1 ? sum[3] : 1;
	}
}

/* A fine row: what is not known comes from the coarse level, bilinearly. */
static void push_row(void *user, size_t row, int worker)
{
	(void)worker;
	const struct job *job = user;
	const level_t *coarse = job->coarse;
	const int y = (int)row, near_y = y / 2;
	const int far_y = within(near_y + (y & 1 ? 1 : -1), coarse->height);
	for (int x = 0; x < job->fine->width; x++) {
		float *to = point(job->fine, x, y);
		if (to[3] >= 1)
			continue;
		const int near_x = x / 2, far_x = within(near_x + (x & 1 ? 1 : -1), coarse->width);
		const float *from[4] = { point(coarse, near_x, near_y),
					 point(coarse, far_x, near_y), point(coarse, near_x, far_y),
					 point(coarse, far_x, far_y) };
		for (int c = 0; c < 3; c++) {
			const float filled =
				(9 * from[0][c] + 3 * from[1][c] + 3 * from[2][c] + from[3][c]) /
				16;
			to[c] = to[3] * to[c] + (1 - to[3]) * filled;
		}
		to[3] = 1;
	}
}

static void store_row(void *user, size_t row, int worker)
{
	(void)worker;
	const struct job *job = user;
	uint8_t *pixel = job->image->pixels + row * (size_t)job->image->width * 4;
	for (int x = 0; x < job->image->width; x++, pixel += 4)
		for (int c = 0; c < 3; c++)
			pixel[c] = (uint8_t)(point(job->fine, x, (int)row)[c] + 0.5F);
}

void gz_push_pull_fill(struct gz_push_pull *push_pull, struct gz_workers *workers,
		       struct gz_image *image)
{
	struct job job = { .image = image };
	for (int i = 0; i + 1 < GZ_PUSH_PULL_LEVELS; i++) {
		job.fine = &push_pull->levels[i];
		job.coarse = job.fine + 1;
		gz_workers_run(workers, pull_row, &job, (size_t)job.coarse->height);
	}
	for (int i = GZ_PUSH_PULL_LEVELS - 2; i >= 0; i--) {
		job.fine = &push_pull->levels[i];
		job.coarse = job.fine + 1;
		gz_workers_run(workers, push_row, &job, (size_t)job.fine->height);
	}
	gz_workers_run(workers, store_row, &job, (size_t)image->height);
}

void gz_push_pull_free(struct gz_push_pull *push_pull)
{
	for (int i = 0; i < GZ_PUSH_PULL_LEVELS; i++)
		free(push_pull->levels[i].points);
	*push_pull = (struct gz_push_pull) { 0 };
}
