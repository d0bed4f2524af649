/**
 * @file
 * Options of gazeview that contradict each other.
 */
#ifndef GZ_VIEW_OPTIONS_OPTIONS_CHECK_H
#define GZ_VIEW_OPTIONS_OPTIONS_CHECK_H

#include "base/log.h"
#include "base/result.h"
#include "view/options/options.h"

/**
 * Check that the options go together: headless output is not asked for in a window, a mouse not
 * without one, and the like.
 *
 * @retval GZ_ERR_INVAL  they do not; logged, one line with the remedy
 */
enum gz_result gz_view_options_check(const struct gz_view_options *options,
				     const struct gz_log *log);

#endif
