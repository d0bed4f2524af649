/**
 * @file
 * What the files that implement experiment.h share; nobody else includes it.
 */
#ifndef GZ_VIEW_EXPERIMENT_EXPERIMENT_INTERNAL_H
#define GZ_VIEW_EXPERIMENT_EXPERIMENT_INTERNAL_H

#include "view/experiment/experiment.h"

/** Make conditions of the sections that were read, and check what each value by itself could not
 *  say. @retval GZ_ERR_FORMAT, GZ_ERR_NO_MEM  logged but for the last */
enum gz_result gz_experiment_resolve(struct gz_experiment *experiment, const struct gz_log *log);

/** Read the texts that the experiment names, and take them into its fingerprint. */
enum gz_result gz_experiment_read_texts(struct gz_experiment *experiment, const struct gz_log *log);

/** The setting of @p key in @p section, by the alternative that it is for; NULL if there is none.
 */
const struct gz_experiment_setting *gz_experiment_find_setting(
	const struct gz_experiment_section *section, const char *key, int alternative);

/** Take bytes into a fingerprint: FNV-1a of 64 bits (Fowler, Noll and Vo; IETF
 *  draft-eastlake-fnv). */
uint64_t gz_experiment_hash(uint64_t hash, const void *bytes, size_t size);

/** Where gz_experiment_hash() begins. */
#define GZ_EXPERIMENT_HASH_START UINT64_C(0xcbf29ce484222325)

#endif
