/* gazeview --list-series: the series of a DICOM folder as text. */
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "render/data/series_list.h"
#include "view/headless/headless.h"

#define GZ_LOG_MODULE "gazeview"

static int longer(int width, const char *text)
{
	const int length = (int)strlen(text);
	return length > width ? length : width;
}

/* Text of unknown width comes last. */
static void print_series_row(FILE *out, size_t number, int uid_width,
			     const struct gz_decode_series *series)
{
	const bool named = series->patient[0] && series->description[0];
	fprintf(out, "%3zu  %-*s  %6" PRId32 "  %-8s  %-10s  %s%s%s", number, uid_width,
		series->uid, series->slices, series->modality, series->date, series->patient,
		named ? ", " : "", series->description);
	if (series->reason[0])
		fprintf(out, " -- cannot be shown: %s", series->reason);
	fputc('\n', out);
}

/* GZ_ERR_NO_MEM; logged. */
static enum gz_result print_series(FILE *out, struct gz_series_list *list, const struct gz_log *log)
{
	const size_t count = gz_series_list_count(list);
	int uid_width = 3;
	struct gz_series_row *rows = calloc(count, sizeof *rows);
	if (!rows) {
		gz_err(log, "no memory to list %zu series", count);
		return GZ_ERR_NO_MEM;
	}
	for (size_t i = 0; i < count; i++) {
		(void)gz_series_list_update(list, i, &rows[i]);
		uid_width = longer(uid_width, rows[i].series.uid);
	}
	fprintf(out, "%3s  %-*s  %6s  %-8s  %-10s  %s\n", "#", uid_width, "UID", "slices",
		"modality", "date", "patient, description");
	for (size_t i = 0; i < count; i++)
		print_series_row(out, i + 1, uid_width, &rows[i].series);
	free(rows);
	return GZ_OK;
}

enum gz_result gz_view_list_series(const struct gz_view_options *options, const struct gz_log *log)
{
	struct gz_series_list *list;
	struct gz_loading_bar bar;
	enum gz_result r = gz_series_list_create(NULL, &list);
	if (r != GZ_OK) {
		gz_err(log, "%s: no memory to list its series", options->scene);
		return r;
	}
	gz_loading_bar_begin(&bar, log);
	if (options->volume_resample >= 0)
		bar.loading.resampling = (enum gz_resampling)options->volume_resample;
	r = gz_series_list_read(options->scene, &bar.loading, log, list);
	gz_loading_bar_end(&bar);
	if (r == GZ_OK)
		r = print_series(stdout, list, log);
	gz_series_list_free(&list);
	return r;
}
