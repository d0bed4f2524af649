#include "render/data/volume.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>
#include <zlib.h>

#include "render/data/brick_pool.h"
#include "render/data/scratch.h"

/* Chosen: volumes from HUGE_FROM bytes on use pages of 2 MiB, which avoids most address translation
 * misses while rendering. */
#define HUGE_PAGE   ((size_t)2 << 20)
#define HUGE_FROM   ((size_t)32 << 20)
#define SMALL_ALIGN ((size_t)64)
#define RANGE_LANES 16

const char *const gz_raw_type_names[] = { "uint8", "int8",    "uint16",  "int16", "uint32",
					  "int32", "float32", "float64", NULL };

const char *const gz_resampling_names[] = { "off", "linear", "nearest", NULL };

enum gz_modality gz_modality_of_term(const char *term)
{
	static const struct {
		const char *term;
		enum gz_modality modality;
	} terms[] = {
		{ "CT", GZ_MODALITY_CT },           { "MR", GZ_MODALITY_MR },
		{ "", GZ_MODALITY_UNKNOWN },        { "OT", GZ_MODALITY_UNKNOWN },
		{ "UNKNOWN", GZ_MODALITY_UNKNOWN }, /* InVesalius */
	};
	for (size_t i = 0; i < sizeof terms / sizeof terms[0]; i++)
		if (strcmp(term, terms[i].term) == 0)
			return terms[i].modality;
	return GZ_MODALITY_OTHER;
}

size_t gz_voxel_size(enum gz_voxel_type type)
{
	static const size_t sizes[GZ_VOXEL_TYPE_COUNT] = { 1, 2, 4 };
	return (unsigned)type < GZ_VOXEL_TYPE_COUNT ? sizes[type] : 0;
}

size_t gz_volume_memory_bytes(void)
{
	const long pages = sysconf(_SC_PHYS_PAGES), page = sysconf(_SC_PAGESIZE);
	return pages > 0 && page > 0 ? (size_t)pages / 4 * (size_t)page : (size_t)1 << 30;
}

size_t gz_volume_voxel_count(const struct gz_volume *volume)
{
	return (size_t)volume->dims[0] * (size_t)volume->dims[1] * (size_t)volume->dims[2];
}

double gz_volume_edge_lengths(const int dims[3], const double spacing[3])
{
	const double least = fmin(spacing[0], fmin(spacing[1], spacing[2]));
	return fmax(dims[0] * (spacing[0] / least),
		    fmax(dims[1] * (spacing[1] / least), dims[2] * (spacing[2] / least)));
}

bool gz_volume_layout_valid(const struct gz_volume *volume)
{
	for (int axis = 0; axis < 3; axis++) {
		if (volume->dims[axis] < 1 || volume->dims[axis] > GZ_VOLUME_DIM_MAX)
			return false;
		if (!isfinite(volume->dims[axis] * volume->spacing[axis]) ||
		    volume->spacing[axis] <= 0)
			return false;
	}
	return gz_volume_edge_lengths(volume->dims, volume->spacing) <=
		       GZ_VOLUME_EDGE_LENGTHS_MAX &&
	       gz_voxel_size(volume->type) != 0 &&
	       (volume->colour == GZ_COLOUR_NONE || volume->type == GZ_VOXEL_U8);
}

/* Where colours begin behind the voxels, bytes. */
static size_t colours_offset(const struct gz_volume *volume)
{
	const size_t padded =
		gz_volume_voxel_count(volume) * gz_voxel_size(volume->type) + GZ_VOLUME_PADDING;
	return (padded + SMALL_ALIGN - 1) / SMALL_ALIGN * SMALL_ALIGN;
}

/* At most 2^42 voxels of 5 bytes: no overflow. */
size_t gz_volume_bytes(const struct gz_volume *volume)
{
	const size_t count = gz_volume_voxel_count(volume);
	return volume->colour == GZ_COLOUR_NONE
		       ? count * gz_voxel_size(volume->type)
		       : colours_offset(volume) + count * sizeof *volume->colours;
}

void gz_volume_place_colours(struct gz_volume *volume)
{
	volume->colours = NULL;
	if (volume->colour != GZ_COLOUR_NONE)
		volume->colours = (uint32_t *)((char *)volume->voxels + colours_offset(volume));
}

bool gz_memory_fits_machine(size_t bytes)
{
	long pages = sysconf(_SC_PHYS_PAGES), page = sysconf(_SC_PAGESIZE);
	return pages <= 0 || page <= 0 || bytes / (size_t)page < (size_t)pages;
}

/* Map a new nameless file in @p folder, zeroed. GZ_ERR_NOT_FOUND: no such folder. */
static enum gz_result map_scratch(const char *folder, size_t bytes, void **out_memory)
{
	int fd = -1;
	enum gz_result result = gz_scratch_open(folder, &fd);
	if (result != GZ_OK)
		return result;
	result = gz_scratch_reserve(fd, bytes);
	void *memory = result == GZ_OK
			       ? mmap(NULL, bytes, PROT_READ | PROT_WRITE, MAP_SHARED, fd, 0)
			       : MAP_FAILED;
	close(fd);
	if (result == GZ_OK && memory == MAP_FAILED)
		result = GZ_ERR_NO_MEM;
	if (result == GZ_OK)
		*out_memory = memory;
	return result;
}

static enum gz_result allocate_memory(size_t used, void **out_voxels)
{
	size_t align = used >= HUGE_FROM ? HUGE_PAGE : SMALL_ALIGN;
	size_t bytes = (used + GZ_VOLUME_PADDING + align - 1) / align * align;
	if (!gz_memory_fits_machine(bytes))
		return GZ_ERR_NO_MEM;
	void *voxels = aligned_alloc(align, bytes);
	if (!voxels)
		return GZ_ERR_NO_MEM;
	if (align == HUGE_PAGE)
		(void)madvise(voxels, bytes, MADV_HUGEPAGE); /* only a hint */
	memset((char *)voxels + used, 0, GZ_VOLUME_PADDING);
	*out_voxels = voxels;
	return GZ_OK;
}

enum gz_result gz_volume_allocate_in(struct gz_volume *volume, const struct gz_loading *loading)
{
	if (!gz_volume_layout_valid(volume))
		return GZ_ERR_INVAL;
	const size_t used = gz_volume_bytes(volume);
	if (loading && loading->give_memory) {
		volume->voxels =
			loading->give_memory(loading->user, volume, used + GZ_VOLUME_PADDING);
		volume->mapped = volume->voxels ? used + GZ_VOLUME_PADDING : 0;
		if (!volume->voxels)
			return GZ_ERR_NO_MEM;
		gz_volume_place_colours(volume);
		return GZ_OK;
	}
	const char *scratch = loading && used >= loading->scratch_from ? loading->scratch : NULL;
	const size_t mapped = scratch ? used + GZ_VOLUME_PADDING : 0;
	const enum gz_result result = scratch ? map_scratch(scratch, mapped, &volume->voxels)
					      : allocate_memory(used, &volume->voxels);
	if (result != GZ_OK)
		return result;
	volume->mapped = mapped;
	volume->slope = 1;
	volume->intercept = 0;
	gz_volume_place_colours(volume);
	if (volume->colours) {
		const size_t count = gz_volume_voxel_count(volume);
		memset((char *)volume->voxels + count, 0, colours_offset(volume) - count);
	}
	return GZ_OK;
}

enum gz_result gz_volume_allocate(struct gz_volume *volume)
{
	return gz_volume_allocate_in(volume, NULL);
}

/* Least and greatest in RANGE_LANES independent lanes, so that the compiler can use SIMD. */
#define DEFINE_RANGE(name, type)                                                        \
	static void name(const type *v, size_t count, double *out_min, double *out_max) \
	{                                                                               \
		type low[RANGE_LANES], high[RANGE_LANES];                               \
		for (size_t k = 0; k < RANGE_LANES; k++)                                \
			low[k] = high[k] = v[0];                                        \
		size_t i = 0;                                                           \
		for (; i + RANGE_LANES <= count; i += RANGE_LANES) {                    \
			for (size_t k = 0; k < RANGE_LANES; k++) {                      \
				low[k] = v[i + k] < low[k] ? v[i + k] : low[k];         \
				high[k] = v[i + k] > high[k] ? v[i + k] : high[k];      \
			}                                                               \
		}                                                                       \
		for (; i < count; i++) {                                                \
			low[0] = v[i] < low[0] ? v[i] : low[0];                         \
			high[0] = v[i] > high[0] ? v[i] : high[0];                      \
		}                                                                       \
		for (size_t k = 1; k < RANGE_LANES; k++) {                              \
			low[0] = low[k] < low[0] ? low[k] : low[0];                     \
			high[0] = high[k] > high[0] ? high[k] : high[0];                \
		}                                                                       \
		*out_min = (double)low[0];                                              \
		*out_max = (double)high[0];                                             \
	}

DEFINE_RANGE(range_u8, uint8_t)
DEFINE_RANGE(range_u16, uint16_t)
DEFINE_RANGE(range_f32, float)

void gz_volume_find_range(struct gz_volume *volume)
{
	size_t count = gz_volume_voxel_count(volume);
	double *low = &volume->stored_min, *high = &volume->stored_max;
	if (!volume->voxels || count == 0)
		return;
	switch (volume->type) {
	case GZ_VOXEL_U8:
		range_u8(volume->voxels, count, low, high);
		break;
	case GZ_VOXEL_U16:
		range_u16(volume->voxels, count, low, high);
		break;
	case GZ_VOXEL_F32:
		range_f32(volume->voxels, count, low, high);
		break;
	case GZ_VOXEL_TYPE_COUNT:
		break;
	}
}

void gz_volume_free(struct gz_volume *volume)
{
	gz_brick_pool_destroy(&volume->bricks);
	if (volume->mapped)
		(void)munmap(volume->voxels, volume->mapped);
	else
		free(volume->voxels);
	*volume = (struct gz_volume) { 0 };
}

static double longest_box_edge(const struct gz_volume *volume)
{
	double longest = 0;
	for (int axis = 0; axis < 3; axis++)
		longest = fmax(longest, volume->dims[axis] * volume->spacing[axis]);
	return longest;
}

void gz_volume_half_extent(const struct gz_volume *volume, double out_half[3])
{
	double longest = longest_box_edge(volume);
	for (int axis = 0; axis < 3; axis++)
		out_half[axis] = 0.5 * (volume->dims[axis] * volume->spacing[axis] / longest);
}

double gz_volume_voxel_length(const struct gz_volume *volume)
{
	double least = fmin(volume->spacing[0], fmin(volume->spacing[1], volume->spacing[2]));
	return least / longest_box_edge(volume);
}

/* Runs of bytes that the checksum of a volume takes, see gz_volume_identify(). */
enum { RUNS = 4096, RUN_BYTES = 64 };

static uLong sum_runs(uLong crc, const unsigned char *bytes, size_t size)
{
	const size_t stride = size / RUNS > RUN_BYTES ? size / RUNS : RUN_BYTES;
	for (size_t at = 0; at < size; at += stride) {
		const size_t left = size - at;
		crc = crc32(crc, bytes + at, (uInt)(left < RUN_BYTES ? left : RUN_BYTES));
	}
	return crc;
}

static uint32_t sum_samples(const struct gz_volume *volume)
{
	const size_t count = gz_volume_voxel_count(volume);
	uLong crc =
		sum_runs(crc32(0, NULL, 0), volume->voxels, count * gz_voxel_size(volume->type));
	if (volume->colours)
		crc = sum_runs(crc, (const unsigned char *)volume->colours,
			       count * sizeof *volume->colours);
	return (uint32_t)crc;
}

struct gz_volume_identity gz_volume_identify(const struct gz_volume *volume)
{
	const double a = volume->slope * volume->stored_min + volume->intercept;
	const double b = volume->slope * volume->stored_max + volume->intercept;
	struct gz_volume_identity identity = {
		.type = volume->type,
		.least = a < b ? a : b,
		.greatest = a < b ? b : a,
		.has_crc = volume->voxels != NULL,
		.crc = volume->voxels ? sum_samples(volume) : 0,
	};
	memcpy(identity.dims, volume->dims, sizeof identity.dims);
	memcpy(identity.spacing, volume->spacing, sizeof identity.spacing);
	return identity;
}

bool gz_volume_identity_same(const struct gz_volume_identity *a, const struct gz_volume_identity *b)
{
	for (int axis = 0; axis < 3; axis++)
		if (a->dims[axis] != b->dims[axis] || a->spacing[axis] != b->spacing[axis])
			return false;
	return a->type == b->type && a->least == b->least && a->greatest == b->greatest &&
	       (!a->has_crc || !b->has_crc || a->crc == b->crc);
}
