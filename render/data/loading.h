/**
 * @file
 * How a volume is loaded or made: who is told how far it is, who may stop it, and where its voxels
 * are kept.
 */
#ifndef GZ_RENDER_DATA_LOADING_H
#define GZ_RENDER_DATA_LOADING_H

#include <stdbool.h>
#include <stddef.h>

/** What a loader is told beside the file. Zero-initialised is silent, in memory and goes on to the
 *  end; NULL stands for that everywhere. */
struct gz_loading {
	/**
	 * Told how far the loading is: often, at the beginning and at the end, on the thread that
	 * loads. May be NULL.
	 *
	 * @param user   as below
	 * @param share  done, 0 to 1
	 * @param what   is loaded: a path, or the name of a formula; valid during the call
	 * @return false to stop: the loader frees what it has and returns GZ_ERR_CANCELLED
	 */
	bool (*report)(void *user, double share, const char *what);
	void *user;
	/** Folder for a nameless file that the voxels are kept in, so that a volume may be larger
	 *  than the memory; its blocks are freed with the volume. NULL: in memory. Borrowed. */
	const char *scratch;
	size_t scratch_from; /**< bytes: smaller volumes stay in memory all the same */
	/** Bytes of memory for the bricks of a file of bricks; 0: a quarter of the machine's. */
	size_t brick_bytes;
};

/** Report a share of the work; false where the loader is to stop. */
static inline bool gz_loading_goes_on(const struct gz_loading *loading, double share,
				      const char *what)
{
	return !loading || !loading->report || loading->report(loading->user, share, what);
}

#endif
