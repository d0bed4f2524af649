/**
 * @file
 * The daemon needs no privilege: its devices are its user's by a udev rule. Root's are given up
 * before anything from outside is read.
 */
#ifndef GZ_DAEMON_PRIVILEGES_H
#define GZ_DAEMON_PRIVILEGES_H

#include "base/log.h"
#include "base/result.h"

/**
 * Renounce gaining privileges by running programs and, where root has started the daemon, become
 * @p user with its groups: /run/gazecast is made and handed over, HOME becomes the user's, and what
 * XDG_RUNTIME_DIR and the like said of root is forgotten. Before any thread starts.
 *
 * @param user  empty: stay
 * @retval GZ_ERR_INVAL   there is no such user, or it is another than ours and we are not root;
 *                        logged with the remedy
 * @retval GZ_ERR_ACCESS  the system does not let go of root; logged
 * @retval GZ_ERR_IO      /run/gazecast cannot be made; logged
 */
enum gz_result gz_privileges_drop(const char *user, const struct gz_log *log);

/** Warn where the daemon runs as root; once it runs. */
void gz_privileges_advise(const struct gz_log *log);

#endif
