#include "render/data/volume.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

#include "render/data/brick_pool.h"
#include "render/data/scratch.h"

/* Chosen: from here on, pages of 2 MiB spare the renderer most address translation misses. */
#define HUGE_PAGE   ((size_t)2 << 20)
#define HUGE_FROM   ((size_t)32 << 20)
#define SMALL_ALIGN ((size_t)64)
#define RANGE_LANES 16

const char *const gz_raw_type_names[] = { "uint8", "int8",    "uint16",  "int16", "uint32",
					  "int32", "float32", "float64", NULL };

size_t gz_voxel_size(enum gz_voxel_type type)
{
	static const size_t sizes[GZ_VOXEL_TYPE_COUNT] = { 1, 2, 4 };
	return (unsigned)type < GZ_VOXEL_TYPE_COUNT ? sizes[type] : 0;
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

static bool layout_valid(const struct gz_volume *volume)
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
	       gz_voxel_size(volume->type) != 0;
}

/* Asking for more than the machine has would succeed on a kernel that overcommits, and fail by a
 * signal later. */
static bool fits_machine(size_t bytes)
{
	long pages = sysconf(_SC_PHYS_PAGES), page = sysconf(_SC_PAGESIZE);
	return pages <= 0 || page <= 0 || bytes / (size_t)page < (size_t)pages;
}

static enum gz_result allocate_memory(size_t used, void **out_voxels)
{
	size_t align = used >= HUGE_FROM ? HUGE_PAGE : SMALL_ALIGN;
	size_t bytes = (used + GZ_VOLUME_PADDING + align - 1) / align * align;
	if (!fits_machine(bytes))
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
	if (!layout_valid(volume))
		return GZ_ERR_INVAL;
	/* At most 2^42 voxels of 4 bytes: no overflow. */
	const size_t used = gz_volume_voxel_count(volume) * gz_voxel_size(volume->type);
	const char *scratch = loading && used >= loading->scratch_from ? loading->scratch : NULL;
	const size_t mapped = scratch ? used + GZ_VOLUME_PADDING : 0;
	const enum gz_result result = scratch ? gz_scratch_map(scratch, mapped, &volume->voxels)
					      : allocate_memory(used, &volume->voxels);
	if (result != GZ_OK)
		return result;
	volume->mapped = mapped;
	volume->slope = 1;
	volume->intercept = 0;
	return GZ_OK;
}

enum gz_result gz_volume_allocate(struct gz_volume *volume)
{
	return gz_volume_allocate_in(volume, NULL);
}

/* Least and greatest in RANGE_LANES independent lanes, which is what lets a compiler use SIMD. */
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

static double longest_edge(const struct gz_volume *volume)
{
	double longest = 0;
	for (int axis = 0; axis < 3; axis++)
		longest = fmax(longest, volume->dims[axis] * volume->spacing[axis]);
	return longest;
}

void gz_volume_half_extent(const struct gz_volume *volume, double out_half[3])
{
	double longest = longest_edge(volume);
	for (int axis = 0; axis < 3; axis++)
		out_half[axis] = 0.5 * (volume->dims[axis] * volume->spacing[axis] / longest);
}

double gz_volume_voxel_length(const struct gz_volume *volume)
{
	double least = fmin(volume->spacing[0], fmin(volume->spacing[1], volume->spacing[2]));
	return least / longest_edge(volume);
}
