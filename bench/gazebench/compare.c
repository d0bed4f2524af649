/* gazebench compare: how far two pictures are apart, as "name value" lines. */
#include "bench/gazebench/gazebench.h"

#include <stdio.h>

#include "bench/metrics/metrics.h"

#define GZ_LOG_MODULE "gazebench"

struct settings {
	struct gz_command_common common;
	double px_per_deg;
};

static const struct gz_option options[] = {
	GZ_COMMAND_HELP_OPTION,
	{ .key = "ppd",
	  .type = GZ_OPTION_DOUBLE,
	  .offset = offsetof(struct settings, px_per_deg),
	  .min = 1,
	  .max = 1000,
	  /* As FLIP's authors: a 0.7 m wide display of 3840 px seen from 0.7 m. */
	  .preset = "67.0206",
	  .help = "pixels a degree of visual angle, for FLIP; run takes the display's" },
};

static enum gz_result print_metrics(const struct gz_image *reference, const struct gz_image *test,
				    double px_per_deg, struct gz_workers *workers)
{
	struct gz_map map = { 0 };
	enum gz_result result = gz_squared_error(reference, test, &map);
	if (result == GZ_OK) {
		printf("psnr_db %.6g\n", gz_psnr_db(gz_map_mean(&map)));
		/* Pictures smaller than the window have no SSIM. */
		result = gz_ssim(reference, test, GZ_SSIM_GAUSSIAN, workers, &map);
		if (result == GZ_OK)
			printf("ssim %.6f\n", gz_map_mean(&map));
		else if (result == GZ_ERR_INVAL)
			printf("ssim nan\n");
	}
	if (result == GZ_OK || result == GZ_ERR_INVAL)
		result = gz_flip(reference, test, px_per_deg, workers, &map);
	if (result == GZ_OK)
		printf("flip %.6f\n", gz_map_mean(&map));
	gz_map_free(&map);
	return result;
}

static enum gz_result compare_pictures(const char *const files[2], double px_per_deg,
				       const struct gz_log *log)
{
	struct gz_image pictures[2] = { 0 };
	struct gz_workers *workers = NULL;
	enum gz_result result = GZ_OK;
	for (int i = 0; i < 2 && result == GZ_OK; i++)
		result = gz_image_read_png(files[i], log, &pictures[i]);
	if (result == GZ_OK &&
	    (pictures[0].width != pictures[1].width || pictures[0].height != pictures[1].height)) {
		gz_err(log, "%s is %dx%d and %s is %dx%d: the sizes must be equal", files[0],
		       pictures[0].width, pictures[0].height, files[1], pictures[1].width,
		       pictures[1].height);
		result = GZ_ERR_INVAL;
	} else if (result == GZ_OK) {
		result = gz_workers_create(0, &workers);
		if (result == GZ_OK)
			result = print_metrics(&pictures[0], &pictures[1], px_per_deg, workers);
		if (result != GZ_OK)
			gz_err(log, "cannot compare: %s", gz_result_text(result));
	}
	gz_workers_destroy(&workers);
	gz_image_free(&pictures[0]);
	gz_image_free(&pictures[1]);
	return result;
}

static int run_compare(int argc, char *const *argv, const struct gz_log *log)
{
	struct settings settings;
	struct gz_operands operands;
	int status = gz_command_read_arguments(&gazebench_compare, argc, argv, log, &settings,
					       &operands);
	if (status != GZ_COMMAND_GO_ON)
		return status;
	if (operands.count != 2) {
		gz_err(log, "give two pictures: gazebench compare REFERENCE.png TEST.png");
		return GAZEBENCH_USAGE;
	}
	return compare_pictures(operands.items, settings.px_per_deg, log) == GZ_OK
		       ? GAZEBENCH_DONE
		       : GAZEBENCH_FAILED;
}

const struct gz_command gazebench_compare = {
	.program = "gazebench",
	.name = "compare",
	.operands = "REFERENCE.png TEST.png",
	.operands_max = 2,
	.summary = "print how far two pictures are apart",
	.details =
		"Prints lines \"name value\": psnr_db, ssim, flip (0 = identical, 1 = maximally "
		"different).\n"
		"ssim is nan if a picture is smaller than its window of 11 pixels.\n"
		"flip depends on how large a pixel appears. The default --ppd is that of FLIP's "
		"authors: a\n"
		"display of 3840 px and 0.7 m across, seen from 0.7 m. gazebench run uses the "
		"pixels per\n"
		"degree of the scene's display; compare with that --ppd gives the same numbers.\n",
	.options = options,
	.option_count = sizeof options / sizeof options[0],
	.run = run_compare,
};
