/**
 * @file
 * Shared by the files that implement experiment.h.
 */
#ifndef GZ_VIEW_EXPERIMENT_EXPERIMENT_INTERNAL_H
#define GZ_VIEW_EXPERIMENT_EXPERIMENT_INTERNAL_H

#include "view/experiment/experiment.h"

/**
 * Build the blocks and conditions from the sections and check values against each other.
 *
 * @retval GZ_ERR_FORMAT  inconsistent; logged
 * @retval GZ_ERR_NO_MEM  out of memory
 */
enum gz_result gz_experiment_resolve(struct gz_experiment *experiment, const struct gz_log *log);

/** Read the text files that the experiment names and add them to its fingerprint. Results as for
 * gz_experiment_parse(). */
enum gz_result gz_experiment_read_texts(struct gz_experiment *experiment, const struct gz_log *log);

/** Find the setting of @p key for @p alternative (0, 1, or -1: both) in a section; NULL: none. */
const struct gz_experiment_setting *gz_experiment_find_setting(
	const struct gz_experiment_section *section, const char *key, int alternative);

/** Add bytes to a hash: 64-bit FNV-1a (Fowler, Noll and Vo; IETF draft-eastlake-fnv). */
uint64_t gz_experiment_hash(uint64_t hash, const void *bytes, size_t size);

/** Start value for gz_experiment_hash(). */
#define GZ_EXPERIMENT_HASH_START UINT64_C(0xcbf29ce484222325)

#endif
