#include "render/reconstruct/cpu/reconstruct.h"

struct job {
	const struct gz_plan *plan;
	const struct gz_lattices *lattices;
	uint32_t *pixels;
	const struct gz_row_filters *filters;
	int square_columns;
};

enum {
	ROWS_A_PART = 16,
	/* Pictures of more bytes go past the caches. Chosen: beyond a processor's own cache; up to
	 * the size of a shared one it is measured to be faster too, with a copy of the picture
	 * behind it (docs/results.md). */
	STREAM_BYTES = 4 << 20,
};

bool gz_reconstruct_streams(const struct gz_plan *plan)
{
	return (size_t)plan->width * (size_t)plan->height * 4 > STREAM_BYTES;
}

static void fill_square(void *user, size_t part, int worker)
{
	(void)worker;
	const struct job *job = user;
	gz_reconstruct_square(job->plan, job->lattices, job->filters,
			      (int)part % job->square_columns, (int)part / job->square_columns);
	job->filters->settle();
}

static void reconstruct_pyramid(struct job *job, struct gz_workers *workers)
{
	int rows;
	gz_reconstruct_squares(job->plan, &job->square_columns, &rows);
	gz_workers_run(workers, fill_square, job, (size_t)job->square_columns * (size_t)rows);
}

static void fill_rows(void *user, size_t part, int worker)
{
	(void)worker;
	const struct job *job = user;
	const int from = (int)part * ROWS_A_PART;
	for (int y = from; y < from + ROWS_A_PART && y < job->plan->height; y++)
		gz_reconstruct_row(job->plan, job->lattices, job->filters, job->pixels, y);
	job->filters->settle();
}

void gz_reconstruct(const struct gz_plan *plan, const struct gz_lattices *lattices,
		    const struct gz_row_filters *filters, struct gz_workers *workers,
		    uint32_t *picture)
{
	struct job job = {
		.plan = plan,
		.lattices = lattices,
		.filters = filters,
		.pixels = picture,
	};
	switch (plan->reconstruction) {
	case GZ_RECONSTRUCT_DIRECT:
		return;
	case GZ_RECONSTRUCT_PYRAMID:
		reconstruct_pyramid(&job, workers);
		return;
	case GZ_RECONSTRUCT_REGIONS:
		gz_workers_run(workers, fill_rows, &job,
			       ((size_t)plan->height + ROWS_A_PART - 1) / ROWS_A_PART);
		return;
	}
}
