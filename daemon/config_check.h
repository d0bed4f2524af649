/**
 * @file
 * What of the daemon's settings cannot be together, though each by itself was fine. Used by
 * config.c alone.
 */
#ifndef GZ_DAEMON_CONFIG_CHECK_H
#define GZ_DAEMON_CONFIG_CHECK_H

#include <stdbool.h>

#include "base/log.h"
#include "base/result.h"
#include "daemon/config.h"

/** Whether the command line gave @p key, one of the daemon's own. */
bool gz_config_given(const struct gz_config *config, const char *key);

/**
 * Check all settings, and make those that follow from others.
 *
 * @retval GZ_ERR_INVAL  refused; logged with the file and line that gave it, or the option, and the
 *                       remedy
 */
enum gz_result gz_config_check(struct gz_config *config, const struct gz_log *log);

/**
 * Check what only a command line can get wrong: settings of another driver than the chosen one. (A
 * file may hold those of all drivers.)
 *
 * @retval GZ_ERR_INVAL  refused; logged
 */
enum gz_result gz_config_check_arguments(const struct gz_config *config, int argc,
					 char *const *argv, const struct gz_log *log);

#endif
