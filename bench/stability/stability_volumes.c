/* The volumes that rows bring along: where loaders and kernels have their edge cases. */
#include "bench/stability/stability_bench.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define GZ_LOG_MODULE "stability"

const char *const gz_stability_volume_names[GZ_STABILITY_VOLUME_COUNT] = {
	"slab",    "wires and shell", "ramp",    "1x1x40",     "one voxel",
	"40x40x1", "spacing 1:1:10",  "16 bits", "big-endian", "signed",
};

/* Waves without symmetry, [0, 1], that are 0 in a part of the box. */
static double waves(double u, double v, double w)
{
	const double wave = sin(9 * u + 4 * v * v) * cos(7 * w - 3 * u * v);
	return u + 0.4 * w > 0.6 ? 0.5 + 0.5 * wave : 0;
}

static double ramp(double u, double v, double w)
{
	return (u + 0.5 * v + 0.25 * w) / 1.75;
}

static double constant(double u, double v, double w)
{
	(void)u, (void)v, (void)w;
	return 0.5;
}

/* In a box of 64 voxels: wires along an axis and askew, and a shell a voxel thick. */
static double wires(double u, double v, double w)
{
	const int x = (int)(64 * u), y = (int)(64 * v), z = (int)(64 * w);
	if (x >= 4 && x < 60 && ((y == 20 && z == 32) || (y == 10 + x / 2 && z == 64 - x)))
		return 1;
	const double radius = sqrt((x - 24) * (x - 24) + (y - 44) * (y - 44) + (z - 40) * (z - 40));
	return fabs(radius - 14) < 0.5 ? 1 : 0;
}

/* How a volume is made. */
struct recipe {
	int dims[3];
	double spacing_z;
	enum gz_voxel_type type;
	double (*value)(double u, double v, double w);
};

static const struct recipe recipes[GZ_STABILITY_VOLUME_COUNT] = {
	[GZ_STABILITY_SLAB] = { { 64, 64, 12 }, 1, GZ_VOXEL_U8, constant },
	[GZ_STABILITY_WIRES] = { { 64, 64, 64 }, 1, GZ_VOXEL_U8, wires },
	[GZ_STABILITY_RAMP] = { { 16, 16, 16 }, 1, GZ_VOXEL_F32, ramp },
	[GZ_STABILITY_LINE] = { { 1, 1, 40 }, 1, GZ_VOXEL_U8, waves },
	[GZ_STABILITY_VOXEL] = { { 1, 1, 1 }, 1, GZ_VOXEL_U8, constant },
	[GZ_STABILITY_FLAT] = { { 40, 40, 1 }, 1, GZ_VOXEL_U8, waves },
	[GZ_STABILITY_ANISOTROPIC] = { { 24, 24, 6 }, 10, GZ_VOXEL_U8, waves },
	[GZ_STABILITY_BITS_16] = { { 20, 24, 18 }, 1, GZ_VOXEL_U16, waves },
};

static void put(struct gz_volume *volume, size_t index, double value)
{
	if (volume->type == GZ_VOXEL_U8)
		((uint8_t *)volume->voxels)[index] = (uint8_t)lround(value * 255);
	else if (volume->type == GZ_VOXEL_U16)
		((uint16_t *)volume->voxels)[index] = (uint16_t)lround(value * 60000);
	else
		((float *)volume->voxels)[index] = (float)value;
}

static enum gz_result cook(const struct recipe *recipe, struct gz_volume *out_volume)
{
	struct gz_volume volume = { .spacing = { 1, 1, recipe->spacing_z }, .type = recipe->type };
	memcpy(volume.dims, recipe->dims, sizeof volume.dims);
	const enum gz_result result = gz_volume_allocate(&volume);
	if (result != GZ_OK)
		return result;
	size_t index = 0;
	for (int z = 0; z < volume.dims[2]; z++)
		for (int y = 0; y < volume.dims[1]; y++)
			for (int x = 0; x < volume.dims[0]; x++)
				put(&volume, index++,
				    recipe->value((x + 0.5) / volume.dims[0],
						  (y + 0.5) / volume.dims[1],
						  (z + 0.5) / volume.dims[2]));
	gz_volume_find_range(&volume);
	*out_volume = volume;
	return GZ_OK;
}

/* The loaders turn what no kernel reads; so it has to come from a file. */
enum { FILE_EDGE = 20, FILE_BYTES = FILE_EDGE * FILE_EDGE * FILE_EDGE * 2 };

static void fill_file(bool big_endian, bool has_sign, uint8_t bytes[FILE_BYTES])
{
	for (int i = 0; i < FILE_BYTES / 2; i++) {
		const double u = (i % FILE_EDGE + 0.5) / FILE_EDGE,
			     v = (i / FILE_EDGE % FILE_EDGE + 0.5) / FILE_EDGE,
			     w = (i / (FILE_EDGE * FILE_EDGE) + 0.5) / FILE_EDGE;
		const unsigned bits =
			(unsigned)(lround(waves(u, v, w) * 60000) - (has_sign ? 30000 : 0)) &
			0xFFFF;
		bytes[2 * i + (big_endian ? 1 : 0)] = (uint8_t)(bits & 255);
		bytes[2 * i + (big_endian ? 0 : 1)] = (uint8_t)(bits >> 8);
	}
}

static enum gz_result through_file(bool big_endian, bool has_sign, const struct gz_log *log,
				   struct gz_volume *out_volume)
{
	const struct gz_raw_layout layout = {
		.dims = { FILE_EDGE, FILE_EDGE, FILE_EDGE },
		.type = has_sign ? GZ_RAW_INT16 : GZ_RAW_UINT16,
		.big_endian = big_endian,
		.spacing = { 1, 1, 1 },
	};
	const char *folder = getenv("TMPDIR");
	char path[GZ_STABILITY_TEXT_SIZE];
	uint8_t *bytes = malloc(FILE_BYTES);
	if (!bytes)
		return GZ_ERR_NO_MEM;
	fill_file(big_endian, has_sign, bytes);
	snprintf(path, sizeof path, "%s/stability-XXXXXX.raw", folder ? folder : "/tmp");
	const int file = mkstemps(path, 4);
	const bool written = file >= 0 && write(file, bytes, FILE_BYTES) == FILE_BYTES;
	enum gz_result result = GZ_ERR_IO;
	if (written)
		result = gz_volume_load(path, &layout, NULL, log, out_volume);
	else
		gz_err(log, "%s: cannot be written: %s; TMPDIR names another folder", path,
		       strerror(errno));
	if (file >= 0) {
		close(file);
		unlink(path);
	}
	free(bytes);
	return result;
}

enum gz_result gz_stability_volume_make(enum gz_stability_volume which, const struct gz_log *log,
					struct gz_volume *out_volume)
{
	if (which == GZ_STABILITY_BIG_ENDIAN)
		return through_file(true, false, log, out_volume);
	if (which == GZ_STABILITY_SIGNED)
		return through_file(false, true, log, out_volume);
	return cook(&recipes[which], out_volume);
}
