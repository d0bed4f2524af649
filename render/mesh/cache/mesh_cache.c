#include "render/mesh/cache/mesh_cache.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <math.h>
#include <openssl/evp.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/file.h"
#include "base/sizes.h"
#include "base/text.h"

#define GZ_LOG_MODULE "mesh"

/* The head of a file. */
enum {
	AT_MAGIC = 0,
	AT_VERSION = 8,
	AT_RESERVED = 12,
	AT_FLOATS = 16,
	AT_KEY = 24,
	AT_HASH = AT_KEY + GZ_MESH_KEY_SIZE,
	HEAD_SIZE = AT_HASH + GZ_MESH_KEY_SIZE,
	LAYOUT_VERSION = 1,
};

static const char cache_magic[AT_VERSION] = "GZMESHC";

static uint32_t load_word(const unsigned char *at)
{
	return (uint32_t)at[0] | (uint32_t)at[1] << 8 | (uint32_t)at[2] << 16 |
	       (uint32_t)at[3] << 24;
}

static void store_word(unsigned char *at, uint32_t word)
{
	for (int i = 0; i < 4; i++)
		at[i] = (unsigned char)(word >> (8 * i));
}

static uint64_t load_long(const unsigned char *at)
{
	return load_word(at) | (uint64_t)load_word(at + 4) << 32;
}

static size_t count_floats(const struct gz_mesh_cache_array *arrays, size_t count)
{
	size_t floats = 0;
	for (size_t i = 0; i < count; i++)
		floats += arrays[i].count;
	return floats;
}

static bool hash_bytes(const void *bytes, size_t size, unsigned char out_hash[GZ_MESH_KEY_SIZE])
{
	return EVP_Digest(bytes, size, out_hash, NULL, EVP_sha256(), NULL) == 1;
}

static bool hash_mesh(EVP_MD_CTX *context, const struct gz_mesh *mesh, const char *purpose)
{
	unsigned char counts[16];
	store_word(counts, (uint32_t)mesh->vertex_count);
	store_word(counts + 4, (uint32_t)mesh->triangle_count);
	store_word(counts + 8, (uint32_t)mesh->shared_count);
	store_word(counts + 12, (uint32_t)strlen(purpose));
	return EVP_DigestInit_ex(context, EVP_sha256(), NULL) == 1 &&
	       EVP_DigestUpdate(context, counts, sizeof counts) == 1 &&
	       EVP_DigestUpdate(context, purpose, strlen(purpose)) == 1 &&
	       EVP_DigestUpdate(context, mesh->positions,
				mesh->vertex_count * sizeof *mesh->positions) == 1 &&
	       EVP_DigestUpdate(context, mesh->normals,
				mesh->vertex_count * sizeof *mesh->normals) == 1 &&
	       EVP_DigestUpdate(context, mesh->triangles,
				mesh->triangle_count * sizeof *mesh->triangles) == 1;
}

enum gz_result gz_mesh_key_make(const struct gz_mesh *mesh, const char *purpose,
				struct gz_mesh_key *out_key)
{
	EVP_MD_CTX *context = EVP_MD_CTX_new();
	const bool made = context && hash_mesh(context, mesh, purpose) &&
			  EVP_DigestFinal_ex(context, out_key->bytes, NULL) == 1;
	EVP_MD_CTX_free(context);
	return made ? GZ_OK : GZ_ERR_NO_MEM;
}

/* What is wrong with the head of a file, or NULL. */
static const char *fault_of_head(const unsigned char *head, size_t size, size_t floats,
				 const struct gz_mesh_key *key)
{
	if (size < HEAD_SIZE)
		return "it is cut short";
	if (memcmp(head + AT_MAGIC, cache_magic, sizeof cache_magic) != 0)
		return "it is not such a file";
	if (load_word(head + AT_VERSION) != LAYOUT_VERSION || load_word(head + AT_RESERVED) != 0)
		return "another version of Gazecast made it";
	if (memcmp(head + AT_KEY, key->bytes, GZ_MESH_KEY_SIZE) != 0)
		return "it belongs to another mesh or to other settings";
	if (load_long(head + AT_FLOATS) != floats)
		return "its length is not that of this mesh";
	if (size < HEAD_SIZE + floats * sizeof(float))
		return "it is cut short";
	return size > HEAD_SIZE + floats * sizeof(float) ? "bytes follow its end" : NULL;
}

/* Take the floats of one array. Returns false if one is not finite. */
static bool take_floats(const unsigned char *bytes, const struct gz_mesh_cache_array *array)
{
	bool finite = true;
	for (size_t i = 0; i < array->count; i++) {
		const uint32_t word = load_word(bytes + 4 * i);
		memcpy(&array->values[i], &word, sizeof word);
		finite = finite && isfinite(array->values[i]);
	}
	return finite;
}

static const char *fault_of_floats(const unsigned char *head,
				   const struct gz_mesh_cache_array *arrays, size_t count)
{
	const unsigned char *at = head + HEAD_SIZE;
	unsigned char hash[GZ_MESH_KEY_SIZE];
	const size_t size = count_floats(arrays, count) * sizeof(float);
	if (!hash_bytes(at, size, hash) || memcmp(hash, head + AT_HASH, sizeof hash) != 0)
		return "its content has changed";
	for (size_t i = 0; i < count; at += arrays[i].count * sizeof(float), i++)
		if (!take_floats(at, &arrays[i]))
			return "it has numbers that are not finite";
	return NULL;
}

enum gz_result gz_mesh_cache_parse(const char *name, const void *bytes, size_t size,
				   const struct gz_mesh_key *key,
				   const struct gz_mesh_cache_array *arrays, size_t count,
				   const struct gz_log *log)
{
	const char *fault = fault_of_head(bytes, size, count_floats(arrays, count), key);
	if (!fault)
		fault = fault_of_floats(bytes, arrays, count);
	if (!fault)
		return GZ_OK;
	gz_info(log, "%s: not used, because %s; it is made again", name, fault);
	return GZ_ERR_FORMAT;
}

/* ---- where files are ---- */

static bool path_beside_input(const struct gz_mesh_cache_place *place, char path[GZ_PATH_SIZE])
{
	return place->input &&
	       gz_text_print(path, GZ_PATH_SIZE, "%s.%s", place->input, place->ending) == GZ_OK;
}

static bool user_cache_folder(char path[GZ_PATH_SIZE])
{
	const char *cache = getenv("XDG_CACHE_HOME"), *home = getenv("HOME");
	/* Relative ones are to be ignored, says the specification. */
	if (cache && cache[0] == '/')
		return gz_text_print(path, GZ_PATH_SIZE, "%s/gazecast/meshes", cache) == GZ_OK;
	return home && home[0] == '/' &&
	       gz_text_print(path, GZ_PATH_SIZE, "%s/.cache/gazecast/meshes", home) == GZ_OK;
}

static bool path_in_user_cache(const struct gz_mesh_cache_place *place,
			       const struct gz_mesh_key *key, char path[GZ_PATH_SIZE])
{
	char folder[GZ_PATH_SIZE], hex[2 * GZ_MESH_KEY_SIZE + 1];
	for (int i = 0; i < GZ_MESH_KEY_SIZE; i++)
		(void)gz_text_print(hex + 2 * i, 3, "%02x", key->bytes[i]);
	return user_cache_folder(folder) &&
	       gz_text_print(path, GZ_PATH_SIZE, "%s/%s.%s", folder, hex, place->ending) == GZ_OK;
}

/* Create the folders above a file; where that fails, so will writing the file. */
static void make_cache_folders(const char *file)
{
	char path[GZ_PATH_SIZE];
	if (gz_text_print(path, sizeof path, "%s", file) != GZ_OK)
		return;
	for (char *slash = strchr(path + 1, '/'); slash; slash = strchr(slash + 1, '/')) {
		*slash = '\0';
		(void)mkdir(path, S_IRWXU);
		*slash = '/';
	}
}

/* ---- reading ---- */

static bool read_whole(int fd, unsigned char *bytes, size_t size)
{
	size_t done = 0;
	while (done < size) {
		const ssize_t n = pread(fd, bytes + done, size - done, (off_t)done);
		if (n < 0 && errno == EINTR)
			continue;
		if (n <= 0)
			return false;
		done += (size_t)n;
	}
	return true;
}

/* What is wanted of a file. */
struct cache_wish {
	const struct gz_mesh_key *key;
	const struct gz_mesh_cache_array *arrays; /* filled, unless there is a whole */
	size_t count;
	struct gz_mesh_cache_array *whole; /* made, as long as the file is; NULL: arrays */
	size_t floats_most;                /* of whole */
	const struct gz_log *log;
};

/* How many floats a file of this size is to have. */
static size_t floats_wanted(const struct cache_wish *wish, uint64_t size)
{
	if (!wish->whole)
		return count_floats(wish->arrays, wish->count);
	const uint64_t floats = size > HEAD_SIZE ? (size - HEAD_SIZE) / sizeof(float) : 0;
	return floats < wish->floats_most ? (size_t)floats : wish->floats_most;
}

/* Take what is wanted from a file's bytes. */
static enum gz_result parse_wish(const struct cache_wish *wish, const char *path,
				 const unsigned char *bytes, size_t size, size_t floats)
{
	if (!wish->whole)
		return gz_mesh_cache_parse(path, bytes, size, wish->key, wish->arrays, wish->count,
					   wish->log);
	const struct gz_mesh_cache_array whole = { malloc((floats + 1) * sizeof(float)), floats };
	if (!whole.values)
		return GZ_ERR_NO_MEM;
	const enum gz_result result =
		gz_mesh_cache_parse(path, bytes, size, wish->key, &whole, 1, wish->log);
	if (result == GZ_OK)
		*wish->whole = whole;
	else
		free(whole.values);
	return result;
}

/* Read an open file of the length that it has to have, or else as much as a head. */
static enum gz_result load_open_file(const char *path, int fd, const struct cache_wish *wish)
{
	struct stat status;
	if (fstat(fd, &status) != 0 || !S_ISREG(status.st_mode)) {
		gz_warn(wish->log, "%s: not used, because it is not a regular file", path);
		return GZ_ERR_IO;
	}
	const size_t floats = floats_wanted(wish, (uint64_t)status.st_size);
	const size_t right_size = HEAD_SIZE + floats * sizeof(float);
	/* One byte more than is right tells a file that is too long. */
	const size_t size =
		(uint64_t)status.st_size > right_size ? right_size + 1 : (size_t)status.st_size;
	unsigned char *bytes = malloc(size + 1);
	enum gz_result result = bytes ? GZ_OK : GZ_ERR_NO_MEM;
	if (bytes && !read_whole(fd, bytes, size)) {
		gz_warn(wish->log, "%s: not used, because it cannot be read", path);
		result = GZ_ERR_IO;
	}
	if (result == GZ_OK)
		result = parse_wish(wish, path, bytes, size, floats);
	free(bytes);
	return result;
}

static enum gz_result load_file(const char *path, const struct cache_wish *wish)
{
	const int fd = open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK);
	if (fd < 0 && (errno == ENOENT || errno == ENOTDIR))
		return GZ_ERR_NOT_FOUND;
	if (fd < 0) {
		gz_warn(wish->log, "%s: not used, because it cannot be read: %s", path,
			strerror(errno));
		return GZ_ERR_IO;
	}
	const enum gz_result result = load_open_file(path, fd, wish);
	(void)close(fd);
	return result;
}

static enum gz_result load_wish(const struct gz_mesh_cache_place *place,
				const struct cache_wish *wish)
{
	char path[GZ_PATH_SIZE];
	enum gz_result kept = GZ_ERR_NOT_FOUND;
	if (path_in_user_cache(place, wish->key, path))
		kept = load_file(path, wish);
	if (kept == GZ_OK)
		(void)utimensat(AT_FDCWD, path, NULL, 0);
	if (kept == GZ_OK || !path_beside_input(place, path))
		return kept;
	const enum gz_result result = load_file(path, wish);
	return result == GZ_ERR_NOT_FOUND ? kept : result;
}

enum gz_result gz_mesh_cache_load(const struct gz_mesh_cache_place *place,
				  const struct gz_mesh_key *key,
				  const struct gz_mesh_cache_array *arrays, size_t count,
				  const struct gz_log *log)
{
	const struct cache_wish wish = { .key = key, .arrays = arrays, .count = count, .log = log };
	return load_wish(place, &wish);
}

enum gz_result gz_mesh_cache_load_whole(const struct gz_mesh_cache_place *place,
					const struct gz_mesh_key *key, size_t floats_most,
					const struct gz_log *log,
					struct gz_mesh_cache_array *out_array)
{
	const struct cache_wish wish = {
		.key = key, .whole = out_array, .floats_most = floats_most, .log = log
	};
	return load_wish(place, &wish);
}

/* ---- trimming ---- */

/* A file of the folder. */
struct kept_file {
	struct timespec used;
	uint64_t bytes;
	char name[NAME_MAX + 1];
};

static int compare_use(const void *a, const void *b)
{
	const struct timespec *first = &((const struct kept_file *)a)->used;
	const struct timespec *second = &((const struct kept_file *)b)->used;
	if (first->tv_sec != second->tv_sec)
		return first->tv_sec < second->tv_sec ? -1 : 1;
	return (first->tv_nsec > second->tv_nsec) - (first->tv_nsec < second->tv_nsec);
}

/* Append a file to the list, if it is one. @return false: no memory */
static bool list_file(int folder, const char *name, struct kept_file **files, size_t *count)
{
	struct stat status;
	if (fstatat(folder, name, &status, AT_SYMLINK_NOFOLLOW) != 0 || !S_ISREG(status.st_mode))
		return true;
	struct kept_file *grown = realloc(*files, (*count + 1) * sizeof *grown);
	if (!grown)
		return false;
	struct kept_file *file = &grown[(*count)++];
	*files = grown;
	file->used = status.st_mtim;
	file->bytes = (uint64_t)status.st_size;
	(void)gz_text_print(file->name, sizeof file->name, "%s", name);
	return true;
}

void gz_mesh_cache_trim(const char *folder, uint64_t bytes_most)
{
	DIR *directory = opendir(folder);
	struct kept_file *files = NULL;
	size_t count = 0;
	uint64_t bytes = 0;
	if (!directory)
		return;
	const struct dirent *entry = readdir(directory);
	while (entry && list_file(dirfd(directory), entry->d_name, &files, &count))
		entry = readdir(directory);
	for (size_t i = 0; i < count; i++)
		bytes += files[i].bytes;
	if (bytes > bytes_most)
		qsort(files, count, sizeof *files, compare_use);
	for (size_t i = 0; i < count && bytes > bytes_most; i++) {
		(void)unlinkat(dirfd(directory), files[i].name, 0);
		bytes -= files[i].bytes;
	}
	free(files);
	(void)closedir(directory);
}

/* ---- writing ---- */

static unsigned char *make_content(const struct gz_mesh_key *key,
				   const struct gz_mesh_cache_array *arrays, size_t count)
{
	const size_t floats = count_floats(arrays, count);
	unsigned char *bytes = calloc(1, HEAD_SIZE + floats * sizeof(float));
	if (!bytes)
		return NULL;
	memcpy(bytes + AT_MAGIC, cache_magic, sizeof cache_magic);
	store_word(bytes + AT_VERSION, LAYOUT_VERSION);
	store_word(bytes + AT_FLOATS, (uint32_t)floats);
	store_word(bytes + AT_FLOATS + 4, (uint32_t)((uint64_t)floats >> 32));
	memcpy(bytes + AT_KEY, key->bytes, GZ_MESH_KEY_SIZE);
	unsigned char *at = bytes + HEAD_SIZE;
	for (size_t k = 0; k < count; k++)
		for (size_t i = 0; i < arrays[k].count; i++, at += sizeof(float)) {
			uint32_t word;
			memcpy(&word, &arrays[k].values[i], sizeof word);
			store_word(at, word);
		}
	if (hash_bytes(bytes + HEAD_SIZE, floats * sizeof(float), bytes + AT_HASH))
		return bytes;
	free(bytes);
	return NULL;
}

static enum gz_result store_file(const char *path, const unsigned char *bytes, size_t size,
				 const struct gz_log *log)
{
	struct gz_part_file file;
	enum gz_result result = gz_part_file_open(&file, path, log);
	if (result == GZ_OK)
		result = gz_part_file_write(&file, bytes, size, 0);
	return gz_part_file_close(&file, result);
}

static enum gz_result store_in_user_cache(const char *path, const unsigned char *bytes, size_t size)
{
	char folder[GZ_PATH_SIZE];
	make_cache_folders(path);
	const enum gz_result result = store_file(path, bytes, size, NULL); /* the input's may do */
	if (result == GZ_OK && user_cache_folder(folder))
		gz_mesh_cache_trim(folder, GZ_MESH_CACHE_BYTES);
	return result;
}

static enum gz_result store_bytes(const struct gz_mesh_cache_place *place,
				  const struct gz_mesh_key *key, const unsigned char *bytes,
				  size_t size, const struct gz_log *log)
{
	char path[GZ_PATH_SIZE];
	if (path_in_user_cache(place, key, path) && store_in_user_cache(path, bytes, size) == GZ_OK)
		return GZ_OK;
	if (path_beside_input(place, path))
		return store_file(path, bytes, size, log);
	gz_warn(log, "what was computed of a mesh cannot be kept: neither XDG_CACHE_HOME nor HOME "
		     "names a folder that can be written");
	return GZ_ERR_IO;
}

enum gz_result gz_mesh_cache_store(const struct gz_mesh_cache_place *place,
				   const struct gz_mesh_key *key,
				   const struct gz_mesh_cache_array *arrays, size_t count,
				   const struct gz_log *log)
{
	const size_t size = HEAD_SIZE + count_floats(arrays, count) * sizeof(float);
	unsigned char *bytes = make_content(key, arrays, count);
	if (!bytes)
		return GZ_ERR_NO_MEM;
	const enum gz_result result = store_bytes(place, key, bytes, size, log);
	free(bytes);
	return result;
}
