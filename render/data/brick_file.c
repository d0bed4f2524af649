#include "render/data/brick_file.h"

#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zlib.h>

#define GZ_LOG_MODULE "volume"

static enum gz_result refuse(const struct gz_brick_file *file, const char *what)
{
	gz_err(file->log, "%s: %s", file->path, what);
	return GZ_ERR_FORMAT;
}

/* GZ_ERR_IO where fewer bytes are there; errno is 0 then. */
static enum gz_result read_at(int fd, void *bytes, size_t size, uint64_t offset)
{
	char *to = bytes;
	while (size > 0) {
		errno = 0;
		const ssize_t n = pread(fd, to, size, (off_t)offset);
		if (n < 0 && errno == EINTR)
			continue;
		if (n <= 0)
			return GZ_ERR_IO;
		to += n;
		offset += (uint64_t)n;
		size -= (size_t)n;
	}
	return GZ_OK;
}

static enum gz_result open_regular(struct gz_brick_file *file, uint64_t *out_size)
{
	struct stat status;
	/* O_NONBLOCK: opening a pipe that nobody writes to would wait for ever. */
	file->fd = open(file->path, O_RDONLY | O_CLOEXEC | O_NONBLOCK);
	if (file->fd < 0 || fstat(file->fd, &status) != 0) {
		const int saved = errno;
		gz_err(file->log, "%s: cannot open the file: %s; check its name and permissions",
		       file->path, strerror(saved));
		return saved == ENOENT || saved == ENOTDIR ? GZ_ERR_NOT_FOUND : GZ_ERR_IO;
	}
	if (!S_ISREG(status.st_mode))
		return refuse(file, "not a regular file; name the file that holds the bricks");
	(void)posix_fadvise(file->fd, 0, 0, POSIX_FADV_RANDOM); /* only a hint */
	*out_size = (uint64_t)status.st_size;
	return GZ_OK;
}

static enum gz_result refuse_truncated(const struct gz_brick_file *file, uint64_t size,
				       uint64_t needed)
{
	gz_err(file->log, "%s: truncated: it ends at byte %llu of %llu; write or fetch it again",
	       file->path, (unsigned long long)size, (unsigned long long)needed);
	return GZ_ERR_FORMAT;
}

static enum gz_result read_part(const struct gz_brick_file *file, void *bytes, size_t size,
				uint64_t offset)
{
	const enum gz_result result = read_at(file->fd, bytes, size, offset);
	if (result != GZ_OK)
		gz_err(file->log, "%s: cannot read %zu bytes at byte %llu: %s", file->path, size,
		       (unsigned long long)offset, errno ? strerror(errno) : "the file ends");
	return result;
}

static size_t finest_count(const struct gz_brick_file *file)
{
	return file->layout.level_count > 1 ? file->layout.levels[1].first
					    : file->layout.brick_count;
}

static enum gz_result read_header(struct gz_brick_file *file, uint64_t size)
{
	uint8_t bytes[GZ_BRICK_HEADER_BYTES];
	if (size < sizeof bytes)
		return refuse_truncated(file, size, sizeof bytes);
	const enum gz_result result = read_part(file, bytes, sizeof bytes, 0);
	if (result != GZ_OK)
		return result;
	const char *wrong = gz_brick_header_decode(bytes, &file->header);
	if (wrong)
		return refuse(file, wrong);
	const struct gz_brick_header *header = &file->header;
	gz_brick_layout_make(header->dims, header->spacing, &file->layout);
	if (header->brick_count != file->layout.brick_count)
		return refuse(file, "as many bricks as its dims do not make; write it anew");
	const uint64_t least =
		gz_brick_data_offset(header->brick_count, finest_count(file), header->type);
	if (header->file_size < least)
		return refuse(file, "a size in its header that cannot hold its index");
	/* Before memory is taken for the index. */
	return size < header->file_size ? refuse_truncated(file, size, header->file_size) : GZ_OK;
}

static const char *check_entry(const struct gz_brick_file *file, const struct gz_brick_entry *entry,
			       uint64_t data)
{
	const struct gz_brick_header *header = &file->header;
	const uint64_t bytes = GZ_BRICK_VOXELS * gz_voxel_size(header->type);
	if (!(entry->least <= entry->greatest) ||
	    !((double)entry->least >= header->stored_min - 0.5) ||
	    !((double)entry->greatest <= header->stored_max + 0.5))
		return "a brick with a range of values that is none";
	if (entry->offset == 0)
		return entry->least == entry->greatest ? NULL : "a brick without voxels";
	if (entry->offset < data || entry->offset % GZ_BRICK_ALIGN != 0 ||
	    entry->offset > header->file_size || header->file_size - entry->offset < bytes)
		return "a brick outside of the file";
	return NULL;
}

static enum gz_result read_index(struct gz_brick_file *file)
{
	const size_t count = file->layout.brick_count, size = count * GZ_BRICK_ENTRY_BYTES;
	const uint64_t data = gz_brick_data_offset(count, finest_count(file), file->header.type);
	uint8_t *bytes = malloc(size);
	file->entries = malloc(count * sizeof *file->entries);
	enum gz_result result = bytes && file->entries ? GZ_OK : GZ_ERR_NO_MEM;
	if (result == GZ_OK)
		result = read_part(file, bytes, size, GZ_BRICK_HEADER_BYTES);
	if (result == GZ_OK && (uint32_t)crc32_z(0, bytes, size) != file->header.index_crc)
		result = refuse(file, "damaged index; write or fetch it again");
	for (size_t i = 0; i < count && result == GZ_OK; i++) {
		file->entries[i] = gz_brick_entry_decode(bytes + i * GZ_BRICK_ENTRY_BYTES);
		const char *wrong = check_entry(file, &file->entries[i], data);
		if (wrong)
			result = refuse(file, wrong);
	}
	free(bytes);
	return result;
}

void gz_brick_file_cell(const struct gz_brick_file *file, size_t brick, int cell, float *out_least,
			float *out_greatest)
{
	const size_t at = (brick * GZ_BRICK_CELLS + (size_t)cell) * 2;
	for (size_t i = 0; i < 2; i++) {
		float *out = i == 0 ? out_least : out_greatest;
		if (file->header.type == GZ_VOXEL_U8)
			*out = (float)((const uint8_t *)file->cells)[at + i];
		else if (file->header.type == GZ_VOXEL_U16)
			*out = (float)((const uint16_t *)file->cells)[at + i];
		else
			*out = ((const float *)file->cells)[at + i];
	}
}

static enum gz_result check_cells(const struct gz_brick_file *file)
{
	for (size_t i = 0; i < finest_count(file) * GZ_BRICK_CELLS; i++) {
		float least, greatest;
		gz_brick_file_cell(file, i / GZ_BRICK_CELLS, (int)(i % GZ_BRICK_CELLS), &least,
				   &greatest);
		if (!(least <= greatest) || !isfinite(least) || !isfinite(greatest))
			return refuse(file, "a cell with a range of values that is none");
	}
	return GZ_OK;
}

static enum gz_result read_cells(struct gz_brick_file *file)
{
	const enum gz_voxel_type type = file->header.type;
	const size_t values = finest_count(file) * GZ_BRICK_CELLS * 2;
	const size_t size = values * gz_voxel_size(type);
	file->cells = malloc(size);
	if (!file->cells)
		return GZ_ERR_NO_MEM;
	const enum gz_result result =
		read_part(file, file->cells, size, gz_brick_cells_offset(file->layout.brick_count));
	if (result != GZ_OK)
		return result;
	if ((uint32_t)crc32_z(0, file->cells, size) != file->header.cells_crc)
		return refuse(file, "damaged ranges of cells; write or fetch it again");
	gz_brick_host_order(type, values, file->cells);
	return check_cells(file);
}

enum gz_result gz_brick_file_open(const char *path, const struct gz_log *log,
				  struct gz_brick_file **out_file)
{
	struct gz_brick_file *file = calloc(1, sizeof *file);
	if (!file)
		return GZ_ERR_NO_MEM;
	file->log = log;
	file->fd = -1;
	const int length = snprintf(file->path, sizeof file->path, "%s", path);
	uint64_t size = 0;
	enum gz_result result = GZ_OK;
	if (length < 0 || (size_t)length >= sizeof file->path)
		result = refuse(file, "the path is too long; move it");
	if (result == GZ_OK)
		result = open_regular(file, &size);
	if (result == GZ_OK)
		result = read_header(file, size);
	if (result == GZ_OK)
		result = read_index(file);
	if (result == GZ_OK)
		result = read_cells(file);
	if (result == GZ_ERR_NO_MEM)
		gz_err(log, "%s: no memory for the index of %zu bricks", path,
		       file->layout.brick_count);
	if (result != GZ_OK) {
		gz_brick_file_close(&file);
		return result;
	}
	*out_file = file;
	return GZ_OK;
}

static void fill(const struct gz_brick_file *file, float value, void *out_voxels)
{
	if (file->header.type == GZ_VOXEL_U8)
		memset(out_voxels, (int)value, GZ_BRICK_VOXELS);
	else if (file->header.type == GZ_VOXEL_U16)
		for (size_t i = 0; i < GZ_BRICK_VOXELS; i++)
			((uint16_t *)out_voxels)[i] = (uint16_t)value;
	else
		for (size_t i = 0; i < GZ_BRICK_VOXELS; i++)
			((float *)out_voxels)[i] = value;
}

/* Kernels rely on what volume.h promises of floats. */
static bool all_finite(const float *voxels)
{
	bool finite = true;
	for (size_t i = 0; i < GZ_BRICK_VOXELS; i++)
		finite &= isfinite(voxels[i]) != 0;
	return finite;
}

enum gz_result gz_brick_file_read(const struct gz_brick_file *file, size_t brick, void *out_voxels)
{
	const struct gz_brick_entry *entry = &file->entries[brick];
	const enum gz_voxel_type type = file->header.type;
	const size_t bytes = GZ_BRICK_VOXELS * gz_voxel_size(type);
	if (entry->offset == 0) {
		fill(file, entry->least, out_voxels);
		return GZ_OK;
	}
	const enum gz_result result = read_at(file->fd, out_voxels, bytes, entry->offset);
	if (result != GZ_OK)
		return result;
	if ((uint32_t)crc32_z(0, out_voxels, bytes) != entry->crc)
		return GZ_ERR_FORMAT;
	gz_brick_host_order(type, GZ_BRICK_VOXELS, out_voxels);
	return type != GZ_VOXEL_F32 || all_finite(out_voxels) ? GZ_OK : GZ_ERR_FORMAT;
}

void gz_brick_file_complain(const struct gz_brick_file *file, size_t brick, enum gz_result why)
{
	gz_err(file->log,
	       "%s: %s at byte %llu; a coarser level is shown there; write or fetch it again",
	       file->path, why == GZ_ERR_FORMAT ? "damaged brick" : "cannot read the brick",
	       (unsigned long long)file->entries[brick].offset);
}

void gz_brick_file_close(struct gz_brick_file **file_pointer)
{
	struct gz_brick_file *file = *file_pointer;
	if (!file)
		return;
	if (file->fd >= 0)
		close(file->fd);
	free(file->entries);
	free(file->cells);
	free(file);
	*file_pointer = NULL;
}
