/**
 * @file
 * Syncs a growing file to the disk on a thread of its own: a busy disk takes seconds for that, and
 * the thread that writes the file must not wait.
 */
#ifndef GZ_DAEMON_DISK_SYNC_H
#define GZ_DAEMON_DISK_SYNC_H

#include "base/log.h"
#include "base/result.h"

/** The thread and its one request. One thread at a time calls the functions below. */
struct gz_disk_sync;

/**
 * Create a disk sync and start its thread.
 *
 * @param log  borrowed; may be NULL
 * @param[out] out_sync  owned by the caller: gz_disk_sync_destroy()
 * @retval GZ_ERR_NO_MEM  no memory or no thread; not logged
 */
enum gz_result gz_disk_sync_create(const struct gz_log *log, struct gz_disk_sync **out_sync);

/**
 * Ask the thread to sync the data of a file. Never waits.
 *
 * @param fd         open until gz_disk_sync_wait() has returned
 * @param directory  where the file's name is, to sync that too; NULL: only the file
 * @retval GZ_ERR_BUSY  the thread is still busy with the last request
 * @retval GZ_ERR_IO    the last sync of a file failed; errno says why. Nothing is requested
 */
enum gz_result gz_disk_sync_request(struct gz_disk_sync *sync, int fd, const char *directory);

/** Wait until the thread is idle. A file that cannot be synced, such as a pipe, counts as synced.
 *  @retval GZ_ERR_IO  the last sync failed; errno says why. The failure is forgotten */
enum gz_result gz_disk_sync_wait(struct gz_disk_sync *sync);

/** Wait until the thread is idle, end it, free the disk sync and set *sync to NULL. Accepts a
 * pointer to NULL. */
void gz_disk_sync_destroy(struct gz_disk_sync **sync);

#endif
