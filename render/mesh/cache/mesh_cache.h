/**
 * @file
 * Files that keep what was computed of a mesh, so that the next start need not compute it again.
 *
 * A file is in the user's cache folder or, where that cannot be written, beside the input
 * ("liver.ply.shape"). Folders of data stay as they are that way, also those of packages when root
 * opens them. The folder keeps at most GZ_MESH_CACHE_BYTES: the files that were used least lately
 * go. A file belongs to a key, the hash of the mesh and of what was computed, so a changed input
 * never meets an old file. It holds, little-endian:
 *
 *     8 bytes   "GZMESHC" and a NUL
 *     u32       version of this layout: 1
 *     u32       0
 *     u64       how many floats follow the head
 *     32 bytes  the key
 *     32 bytes  SHA-256 of the floats
 *     floats    all arrays, one after the other
 *
 * A file that is anything else is refused with one line in the log, and the caller computes again.
 */
#ifndef GZ_RENDER_MESH_CACHE_MESH_CACHE_H
#define GZ_RENDER_MESH_CACHE_MESH_CACHE_H

#include <stddef.h>
#include <stdint.h>

#include "base/log.h"
#include "base/result.h"
#include "render/mesh/mesh.h"

/** Bytes of a SHA-256. */
#define GZ_MESH_KEY_SIZE 32

/** Most bytes of the user's cache folder. Chosen: some twenty meshes of a million triangles. */
#define GZ_MESH_CACHE_BYTES ((uint64_t)2 << 30)

/** What a file belongs to. */
struct gz_mesh_key {
	unsigned char bytes[GZ_MESH_KEY_SIZE];
};

/** Where the file is. */
struct gz_mesh_cache_place {
	const char *input;  /**< the file that the mesh stems from; NULL: none, and the file is in
				 the user's cache folder or nowhere */
	const char *ending; /**< of the name, without a dot: "shape". Meshes of one input have
				 endings of their own: "12.shape" */
};

/** One array of a file. */
struct gz_mesh_cache_array {
	float *values; /**< owned by the caller; when storing, only read */
	size_t count;
};

/**
 * Make the key of a mesh and of what is computed of it.
 *
 * @param purpose  names the computation, its version and its settings: "shape 1, 6 levels"
 * @retval GZ_ERR_NO_MEM  out of memory
 */
enum gz_result gz_mesh_key_make(const struct gz_mesh *mesh, const char *purpose,
				struct gz_mesh_key *out_key);

/**
 * Read the arrays from the content of a file.
 *
 * @param name    the file's name in messages
 * @param bytes   @p size bytes, from anywhere
 * @param arrays  how many floats are expected; nothing is allocated by what the bytes claim
 * @retval GZ_OK          the arrays are filled with finite numbers
 * @retval GZ_ERR_FORMAT  another version, another key, a wrong length, a wrong hash, or a number
 *                        that is not finite; logged. The arrays' content is undefined
 * @retval GZ_ERR_NO_MEM  out of memory
 */
enum gz_result gz_mesh_cache_parse(const char *name, const void *bytes, size_t size,
				   const struct gz_mesh_key *key,
				   const struct gz_mesh_cache_array *arrays, size_t count,
				   const struct gz_log *log);

/**
 * Read the arrays from the file in the user's cache folder or beside the input. It counts as used.
 *
 * @retval GZ_OK             the arrays are filled
 * @retval GZ_ERR_NOT_FOUND  there is no such file; not logged
 * @retval GZ_ERR_IO         a file cannot be read; logged
 * @return otherwise as gz_mesh_cache_parse()
 */
enum gz_result gz_mesh_cache_load(const struct gz_mesh_cache_place *place,
				  const struct gz_mesh_key *key,
				  const struct gz_mesh_cache_array *arrays, size_t count,
				  const struct gz_log *log);

/**
 * gz_mesh_cache_load() of one array whose length only the file knows. It is checked alike, and what
 * is allocated is at most as long as the file is.
 *
 * @param floats_most  a longer file is refused
 * @param[out] out_array  written on GZ_OK; the caller frees its values
 */
enum gz_result gz_mesh_cache_load_whole(const struct gz_mesh_cache_place *place,
					const struct gz_mesh_key *key, size_t floats_most,
					const struct gz_log *log,
					struct gz_mesh_cache_array *out_array);

/**
 * Write the arrays to a file in the user's cache folder: gazecast/meshes below $XDG_CACHE_HOME or
 * ~/.cache (XDG Base Directory Specification). If that cannot be written, beside the input. The
 * file takes its name when it is complete.
 *
 * @retval GZ_ERR_IO    neither can be written; logged
 * @retval GZ_ERR_FULL  no space is left; logged
 * @retval GZ_ERR_NO_MEM  out of memory
 */
enum gz_result gz_mesh_cache_store(const struct gz_mesh_cache_place *place,
				   const struct gz_mesh_key *key,
				   const struct gz_mesh_cache_array *arrays, size_t count,
				   const struct gz_log *log);

/**
 * Remove files of a folder, those first that were used least lately, until the rest have at most
 * @p bytes_most bytes. Called by gz_mesh_cache_store(); several programs may do so at a time.
 */
void gz_mesh_cache_trim(const char *folder, uint64_t bytes_most);

#endif
