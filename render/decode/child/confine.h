/**
 * @file
 * What a decoder process may do once it is confined: read the files that it was given, compute, and
 * write to the descriptors that it was started with.
 *
 * - Landlock (where the kernel has it): no file but those under the given path can be opened, and
 *   they can only be read; no connection can be made.
 * - seccomp (where the kernel has it): a list of the system calls that a decoder needs. Files are
 *   opened to be read only, threads can be started, but no processes; no sockets, no other program,
 *   no memory that is both written and run. Other calls fail with EPERM.
 * - Always: no new privileges, the end of the parent ends it, no core file, 64 descriptors, an hour
 *   of processor time, and GZ_DECODE_WORK_BYTES of address space, which the parent raises by the
 *   size of the voxels. A sanitizer reserves terabytes of address space, so that one limit is left
 *   out in its builds.
 */
#ifndef GZ_RENDER_DECODE_CONFINE_H
#define GZ_RENDER_DECODE_CONFINE_H

#include <stddef.h>
#include <sys/types.h>

#include "base/result.h"

/** Size of the text that tells what protects, with its NUL, bytes. */
#define GZ_CONFINE_TEXT_SIZE 160

/**
 * Confine this process for good. Call it before other threads are started and before anything of
 * the file is read.
 *
 * @param parent  process id of the parent; if it has ended, the process ends here
 * @param path    the file or folder that may be read. Of a file it is the folder too, because the
 * other files of its series lie there. Symbolic links in that folder are followed: what they
 * point to may be read as well.
 * @param[out] protection  what protects: "Landlock 4, system calls, limits"
 * @retval GZ_ERR_ACCESS  a limit cannot be set; do not read the file then
 */
enum gz_result gz_confine(pid_t parent, const char *path, char protection[GZ_CONFINE_TEXT_SIZE]);

#endif
