#include "bench/report/report.h"

#include <stdio.h>

#include "bench/report/charts.h"
#include "bench/report/page.h"
#include "bench/report/study_charts.h"
#include "bench/report/summary_json.h"
#include "bench/report/text.h"

#define GZ_LOG_MODULE "report"

static enum gz_result write_summary(const struct gz_summary *summary, const char *folder,
				    const struct gz_log *log)
{
	char path[GZ_PATH_SIZE + 32];
	json_t *json = gz_summary_to_json(summary);
	if (!json) {
		gz_err(log, "%s: no summary: %s", folder, gz_result_text(GZ_ERR_NO_MEM));
		return GZ_ERR_NO_MEM;
	}
	snprintf(path, sizeof path, "%s/summary.json", folder);
	const enum gz_result result = gz_json_write(json, path, log);
	json_decref(json);
	return result;
}

static enum gz_result write_page(const struct gz_summary *summary, const struct gz_charts *charts,
				 const char *folder, const struct gz_log *log)
{
	char path[GZ_PATH_SIZE + 32];
	struct gz_text page = { 0 };
	gz_page_write(summary, charts, &page);
	snprintf(path, sizeof path, "%s/report.html", folder);
	const enum gz_result result = gz_text_write(&page, path, log);
	gz_text_free(&page);
	return result;
}

enum gz_result gz_report_write(const struct gz_summary *summary, const char *folder,
			       const struct gz_log *log)
{
	struct gz_charts charts = { 0 };
	enum gz_result result = write_summary(summary, folder, log);
	if (result == GZ_OK)
		result = gz_charts_open(folder, log, &charts);
	if (result == GZ_OK)
		result = gz_study_charts_draw(summary, &charts);
	if (result == GZ_OK)
		result = write_page(summary, &charts, folder, log);
	gz_charts_close(&charts);
	return result;
}
