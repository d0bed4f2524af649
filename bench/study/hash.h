/**
 * @file
 * SHA-256 of scenes, data and settings, to recognise equal ones.
 */
#ifndef GZ_BENCH_STUDY_HASH_H
#define GZ_BENCH_STUDY_HASH_H

#include <stddef.h>

#include "base/option.h"
#include "base/result.h"
#include "bench/study/study.h"
#include "render/raycast/shared/ray_params.h"

struct gz_hash;

/** Begin. The caller's: gz_hash_end() frees it. GZ_ERR_NO_MEM. */
enum gz_result gz_hash_begin(struct gz_hash **out_hash);

/** Go on with @p size bytes. */
void gz_hash_add(struct gz_hash *hash, const void *bytes, size_t size);

/** Go on with a text and its NUL, so that texts in a row do not run into each other. */
void gz_hash_add_text(struct gz_hash *hash, const char *text);

/** Go on with a number, the same on every machine: its 8 bytes as IEEE 754, the lowest first. */
void gz_hash_add_number(struct gz_hash *hash, double number);

/** Go on with every option's key and its value in @p target, as text. */
void gz_hash_add_options(struct gz_hash *hash, const struct gz_option *options, size_t count,
			 const void *target);

/** Go on with all options of how rays are integrated: light, clip box and surface included. */
void gz_hash_add_rays(struct gz_hash *hash, const struct gz_ray_params *rays);

/**
 * End, free and set to NULL. Accepts a pointer to NULL, and then writes nothing.
 *
 * @param[out] out_hex  64 hexadecimal digits; may be NULL
 * @retval GZ_ERR_NO_MEM  the library failed on the way
 */
enum gz_result gz_hash_end(struct gz_hash **hash, char out_hex[GZ_STUDY_HASH_SIZE]);

#endif
