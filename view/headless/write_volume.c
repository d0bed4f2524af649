#include "view/headless/write_volume.h"

#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "base/file.h"
#include "render/data/brick_write.h"
#include "render/data/nrrd_write.h"
#include "render/scene/scene_open.h"
#include "view/capture/output.h"
#include "view/headless/loading_bar.h"

#define GZ_LOG_MODULE "gazeview"

typedef enum gz_result write_function(const struct gz_volume *volume, const char *path,
				      const struct gz_loading *loading, const struct gz_log *log);

static write_function *writer_of(const char *path, const struct gz_log *log)
{
	if (gz_path_ends(path, ".gzb"))
		return gz_bricks_write;
	if (gz_path_ends(path, ".nrrd"))
		return gz_nrrd_write;
	gz_err(log, "--write-volume %s: end it in .gzb for bricks or in .nrrd", path);
	return NULL;
}

static size_t quarter_of_memory(void)
{
	const long pages = sysconf(_SC_PHYS_PAGES), page = sysconf(_SC_PAGESIZE);
	return pages > 0 && page > 0 ? (size_t)pages / 4 * (size_t)page : (size_t)1 << 30;
}

static enum gz_result load(const struct gz_view_options *options, const struct gz_loading *where,
			   const struct gz_log *log, struct gz_scene *out_scene)
{
	struct gz_loading_bar bar;
	gz_loading_bar_begin(&bar, log);
	bar.loading.scratch = where->scratch;
	bar.loading.scratch_from = where->scratch_from;
	struct gz_raw_layout raw;
	const struct gz_scene_request request = {
		.path = options->scene,
		.raw = gz_view_options_raw(options, &raw) ? &raw : NULL,
		.loading = &bar.loading,
		.volume_alone = true,
	};
	const enum gz_result r = gz_scene_open(&request, log, out_scene);
	gz_loading_bar_end(&bar);
	return r;
}

static enum gz_result write_to(const struct gz_view_options *options,
			       const struct gz_loading *where, write_function *writer,
			       const struct gz_volume *volume, const struct gz_log *log)
{
	struct gz_loading_bar bar;
	if (volume->bricks) {
		gz_err(log, "--write-volume: the scene's volume is a file of bricks already");
		return GZ_ERR_UNSUPPORTED;
	}
	gz_loading_bar_begin(&bar, log);
	bar.loading.scratch = where->scratch;
	bar.loading.scratch_from = where->scratch_from;
	const enum gz_result r = writer(volume, options->write_volume, &bar.loading, log);
	gz_loading_bar_end(&bar);
	return r;
}

enum gz_result gz_view_write_volume(const struct gz_view_options *options, const struct gz_log *log)
{
	char folder[GZ_PATH_SIZE];
	struct gz_scene scene = { 0 };
	write_function *writer = writer_of(options->write_volume, log);
	if (!writer)
		return GZ_ERR_UNSUPPORTED;
	enum gz_result r = gz_output_check(options, log);
	if (r != GZ_OK)
		return r;
	gz_output_folder(options->write_volume, folder, sizeof folder);
	const struct gz_loading where = { .scratch = folder, .scratch_from = quarter_of_memory() };
	r = load(options, &where, log, &scene);
	if (r != GZ_OK)
		return r;
	r = write_to(options, &where, writer, &scene.volume, log);
	gz_scene_free(&scene);
	return r;
}
