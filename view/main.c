/* gazeview: shows a volume, sharp where someone looks. */
#include <stdio.h>
#include <stdlib.h>

#include "base/log.h"
#include "render/data/format.h"
#include "render/particles/particles.h"
#include "view/experiment/sitting.h"
#include "view/headless/headless.h"
#include "view/options/options.h"
#include "view/panels/notices.h"
#include "view/session/replay.h"
#include "view/target/target_window.h"
#include "view/window/window.h"

/* Exit status of a shell for a process ended by a signal, less its number. */
enum { EXIT_SIGNAL = 128 };

/* Check everything the experiment names, and list its trials. */
static enum gz_result list_trials(const struct gz_view_options *options, const struct gz_log *log)
{
	struct gz_sitting *sitting;
	const enum gz_result r = gz_sitting_open(&options->sitting, NULL, log, &sitting);
	if (r != GZ_OK)
		return r;
	gz_sitting_print(sitting, stdout);
	gz_sitting_close(&sitting);
	return GZ_OK;
}

static int run_mode(struct gz_view_options *options, const struct gz_log *log,
		    struct gz_notices *notices)
{
	int signal_number = 0;
	if (options->target.targets[0])
		return gz_view_targets(options, log) == GZ_OK ? EXIT_SUCCESS : EXIT_FAILURE;
	if (options->sitting.file[0] && options->headless)
		return list_trials(options, log) == GZ_OK ? EXIT_SUCCESS : EXIT_FAILURE;
	if (options->list_objects)
		return gz_view_list_objects(options, log) == GZ_OK ? EXIT_SUCCESS : EXIT_FAILURE;
	if (options->list_series)
		return gz_view_list_series(options, log) == GZ_OK ? EXIT_SUCCESS : EXIT_FAILURE;
	if (options->write_volume[0])
		return gz_view_write_volume(options, log) == GZ_OK ? EXIT_SUCCESS : EXIT_FAILURE;
	if (options->write_mesh[0])
		return gz_view_write_mesh(options, log) == GZ_OK ? EXIT_SUCCESS : EXIT_FAILURE;
	if (options->replay[0] && gz_replay_adopt(options, log) != GZ_OK)
		return EXIT_FAILURE;
	enum gz_result r = options->headless ? gz_view_headless(options, log, &signal_number)
					     : gz_view_window(options, log, notices);
	if (signal_number && (r == GZ_OK || r == GZ_ERR_CANCELLED))
		return EXIT_SIGNAL + signal_number;
	return r == GZ_OK ? EXIT_SUCCESS : EXIT_FAILURE;
}

static void print_formats(void)
{
	gz_volume_formats_print(stdout);
	gz_particle_formats_print(stdout);
}

static int show(int argc, char **argv, struct gz_view_options *options, struct gz_notices *notices)
{
	struct gz_log log;
	gz_log_init(&log, gz_notices_sink, notices, NULL);
	if (gz_view_options_read(argc, argv, &log, options) != GZ_OK)
		return EXIT_FAILURE;
	if (options->help)
		gz_view_options_print_help(stdout);
	else if (options->version)
		puts("gazeview " GAZECAST_VERSION);
	else if (options->formats)
		print_formats();
	else
		return run_mode(options, &log, notices);
	return EXIT_SUCCESS;
}

int main(int argc, char **argv)
{
	struct gz_view_options *options = calloc(1, sizeof *options);
	struct gz_notices *notices = malloc(sizeof *notices);
	int status = EXIT_FAILURE;
	if (options && notices) {
		gz_notices_init(notices);
		status = show(argc, argv, options, notices);
		gz_notices_free(notices);
	}
	free(notices);
	free(options);
	return status;
}
