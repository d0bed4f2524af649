/**
 * @file
 * Storing and removing the correction that gazectl validate has found, so that the daemon follows.
 */
#ifndef GZ_CLIENT_GAZECTL_VALIDATE_CORRECTION_H
#define GZ_CLIENT_GAZECTL_VALIDATE_CORRECTION_H

#include "client/gazectl/gazectl.h"
#include "client/gazectl/validate/validation.h"

/** Whom to tell, and where corrections are. All borrowed. */
struct gazectl_correction {
	struct gz_control *control;
	struct gz_stream *stream; /**< with status messages */
	const struct gz_log *log;
	const char *directory; /**< empty: the user's, gz_correction_directory() */
};

/**
 * Store the correction of a check, on top of the one that was in force meanwhile, and wait until
 * the daemon applies it. One that does not help is not stored; that is told, and is no failure.
 */
enum gazectl_exit gazectl_correction_store(const struct gazectl_correction *correction,
					   const struct gz_validation *validation);

/** Remove the correction that is stored for the tracker and display of @p status, and wait until
 * the daemon has forgotten it. Without one: GAZECTL_FAILED. */
enum gazectl_exit gazectl_correction_forget(const struct gazectl_correction *correction,
					    const struct gz_status *status);

#endif
