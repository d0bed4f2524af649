/* Volumes made by a formula. Only + - * / and sqrt are used, which IEEE 754 rounds in one way, and
 * nothing is fused (cmake/GzTargets.cmake): the voxels are the same bits on every machine. Shapes
 * and numbers are chosen by eye. */
#include <math.h>
#include <stdatomic.h>
#include <stdint.h>

#include "base/workers.h"
#include "render/data/procedural.h"
#include "render/data/volume.h"

#define GZ_LOG_MODULE "volume"

/* One of 12 directions at a lattice point, by an integer hash, times the offset from it: Perlin,
 * "Improving noise", SIGGRAPH 2002; the hash is the finaliser of MurmurHash3. */
static double gradient(int32_t x, int32_t y, int32_t z, const double d[3])
{
	uint32_t h =
		(uint32_t)x * 0x9e3779b1u ^ (uint32_t)y * 0x85ebca77u ^ (uint32_t)z * 0xc2b2ae3du;
	h ^= h >> 16;
	h *= 0x85ebca6bu;
	h ^= h >> 13;
	h *= 0xc2b2ae35u;
	h ^= h >> 16;
	uint32_t edge = h % 12;
	double a = d[edge >> 2], b = d[((edge >> 2) + 1) % 3];
	return ((edge & 1) ? -a : a) + ((edge & 2) ? -b : b);
}

static double fade(double t)
{
	return t * t * t * (t * (t * 6 - 15) + 10);
}

static double mix(double a, double b, double t)
{
	return a + t * (b - a);
}

double gz_noise(const double p[3])
{
	int32_t cell[3];
	double d[3], w[3], corner[8];
	for (int i = 0; i < 3; i++) {
		double whole = floor(p[i]);
		cell[i] = (int32_t)whole;
		d[i] = p[i] - whole;
		w[i] = fade(d[i]);
	}
	for (int c = 0; c < 8; c++) {
		int dx = c & 1, dy = c >> 1 & 1, dz = c >> 2;
		double offset[3] = { d[0] - dx, d[1] - dy, d[2] - dz };
		corner[c] = gradient(cell[0] + dx, cell[1] + dy, cell[2] + dz, offset);
	}
	double low = mix(mix(corner[0], corner[1], w[0]), mix(corner[2], corner[3], w[0]), w[1]);
	double high = mix(mix(corner[4], corner[5], w[0]), mix(corner[6], corner[7], w[0]), w[1]);
	return mix(low, high, w[2]);
}

const char *const gz_procedural_names[] = { "shells", "supernova", "chameleon", "splash", NULL };

/* 1 at t = 0, falling smoothly to 0 at |t| = 1 and beyond. */
static double bump(double t)
{
	double u = 1 - t * t;
	return u > 0 ? u * u : 0;
}

static double clamp01(double x)
{
	return x < 0 ? 0 : x > 1 ? 1 : x;
}

static double smoothstep(double t)
{
	return t * t * (3 - 2 * t);
}

/* Real spherical harmonics without their constants, of a unit vector: degree 2 and 4 (tesseral and
 * cubic) and 6 (tesseral). */
static double harmonic_2(double z)
{
	return (3 * z * z - 1) / 2;
}

static double harmonic_4(double x, double y)
{
	double x2 = x * x, y2 = y * y;
	return x2 * x2 - 6 * x2 * y2 + y2 * y2;
}

static double harmonic_cubic(double x, double y, double z)
{
	double x2 = x * x, y2 = y * y, z2 = z * z;
	return x2 * x2 + y2 * y2 + z2 * z2 - 0.6;
}

static double harmonic_6(double x, double y)
{
	double x2 = x * x, y2 = y * y;
	return (x2 - y2) * (x2 * x2 - 14 * x2 * y2 + y2 * y2);
}

/* Nested shells round a core, each denser than the one outside it and bent by one harmonic; the two
 * outer ones open between their lobes, so that the inner ones show. */
static double shells_at(const double p[3])
{
	double r = sqrt(p[0] * p[0] + p[1] * p[1] + p[2] * p[2]);
	double s = r > 1e-9 ? 1 / r : 0;
	double x = p[0] * s, y = p[1] * s, z = p[2] * s;
	double six = harmonic_6(x, y), four = harmonic_4(x, y), cubic = harmonic_cubic(x, y, z);
	double petals = smoothstep(clamp01(0.45 + 1.1 * six + 0.5 * z * z));
	double bands = smoothstep(clamp01(0.55 + 2.2 * cubic));
	double layers[5] = {
		0.30 * petals * bump((r - 0.78 - 0.16 * six) / 0.07),
		0.48 * bands * bump((r - 0.58 - 0.12 * four * (1 + z)) / 0.06),
		0.66 * bump((r - 0.38 - 0.14 * cubic) / 0.055),
		0.83 * bump((r - 0.21 - 0.05 * harmonic_2(z)) / 0.05),
		bump(r / 0.13),
	};
	double densest = 0;
	for (int i = 0; i < 5; i++)
		densest = layers[i] > densest ? layers[i] : densest;
	return densest;
}

/* Sum of octaves of ridges: sharp where the noise crosses zero. About 0 to 1. */
static double ridges(const double p[3], int octaves)
{
	double sum = 0, weight = 0.5, carry = 1, q[3] = { p[0], p[1], p[2] };
	for (int k = 0; k < octaves; k++) {
		double ridge = 1 - fabs(gz_noise(q));
		ridge = ridge * ridge * carry;
		sum += weight * ridge;
		carry = clamp01(2 * ridge); /* fine ridges only on coarse ones */
		weight *= 0.5;
		for (int i = 0; i < 3; i++)
			q[i] = 2.03 * q[i] + 17.7;
	}
	return clamp01(sum);
}

/* Filaments in a thick shell whose radius billows, and a small bright remnant. */
static double supernova_at(const double p[3])
{
	double r = sqrt(p[0] * p[0] + p[1] * p[1] + p[2] * p[2]);
	if (r >= 1)
		return 0;
	double remnant = bump(r / 0.10);
	if (r < 0.12)
		return 0.9 * remnant;
	double coarse[3] = { 1.7 * p[0] + 5.2, 1.7 * p[1] + 1.3, 1.7 * p[2] + 9.1 };
	double billow = gz_noise(coarse);
	double shell = bump((r - 0.62 - 0.16 * billow) / 0.30);
	if (shell <= 0)
		return 0;
	double fine[3] = { 3.1 * p[0] + 0.8 * billow, 3.1 * p[1] - 0.6 * billow, 3.1 * p[2] };
	double filament = ridges(fine, 4);
	return shell * smoothstep(clamp01((filament - 0.35) / 0.6));
}

/* What the formulas give, 0 to 1, times this is the data value. */
static double value_scale(enum gz_procedural which)
{
	return which == GZ_PROCEDURAL_SHELLS ? 255 : 1;
}

/* What all threads that make one volume share. */
struct making {
	enum gz_procedural which;
	struct gz_volume *volume;
	struct gz_chameleon *chameleon; /* of that one alone */
	struct gz_splash splash;
	const struct gz_loading *loading;
	atomic_int slices_done;
	atomic_bool stopped;
};

static void put_voxel(struct gz_volume *volume, size_t index, double value, double scale)
{
	if (volume->type == GZ_VOXEL_U8)
		((uint8_t *)volume->voxels)[index] = (uint8_t)(255 * value + 0.5);
	else if (volume->type == GZ_VOXEL_U16)
		((uint16_t *)volume->voxels)[index] = (uint16_t)(65535 * value + 0.5);
	else
		((float *)volume->voxels)[index] = (float)(scale * value);
}

/* Of all formulas but the chameleon's, which makes rows. */
static double value_at(const struct making *making, const double p[3])
{
	switch (making->which) {
	case GZ_PROCEDURAL_SHELLS:
		return shells_at(p);
	case GZ_PROCEDURAL_SPLASH:
		return gz_splash_at(&making->splash, p);
	default:
		return supernova_at(p);
	}
}

static double longest_mm(const struct gz_volume *volume)
{
	double longest = 0;
	for (int i = 0; i < 3; i++) {
		double edge = volume->dims[i] * volume->spacing[i];
		longest = edge > longest ? edge : longest;
	}
	return longest;
}

static double middle_of(const struct gz_volume *volume, int axis, int index, double longest)
{
	return (2 * index + 1 - volume->dims[axis]) * volume->spacing[axis] / longest;
}

static void fill_chameleon_row(const struct making *making, double y, double z, double longest,
			       size_t row)
{
	enum { AT_ONCE = 1024 };
	struct gz_volume *volume = making->volume;
	const double step = 2 * volume->spacing[0] / longest;
	float values[AT_ONCE];
	for (int x = 0; x < volume->dims[0]; x += AT_ONCE) {
		int left = volume->dims[0] - x, count = left < AT_ONCE ? left : AT_ONCE;
		const struct gz_chameleon_row values_at = {
			.y = y,
			.z = z,
			.first = middle_of(volume, 0, x, longest),
			.step = step,
			.count = count,
		};
		gz_chameleon_draw_row(making->chameleon, &values_at, values);
		for (int i = 0; i < count; i++)
			put_voxel(volume, row + (size_t)x + (size_t)i, (double)values[i], 1);
	}
}

static void fill_procedural_row(const struct making *making, int y, int z)
{
	struct gz_volume *volume = making->volume;
	const int *dims = volume->dims;
	const double scale = value_scale(making->which), longest = longest_mm(volume);
	const size_t row = ((size_t)z * (size_t)dims[1] + (size_t)y) * (size_t)dims[0];
	double p[3] = { 0, middle_of(volume, 1, y, longest), middle_of(volume, 2, z, longest) };
	if (making->which == GZ_PROCEDURAL_CHAMELEON) {
		fill_chameleon_row(making, p[1], p[2], longest, row);
		return;
	}
	for (int x = 0; x < dims[0]; x++) {
		p[0] = middle_of(volume, 0, x, longest);
		put_voxel(volume, row + (size_t)x, value_at(making, p), scale);
	}
}

/* One slice. The thread that asked for the volume also tells how far it is. */
static void fill_slice(void *user, size_t part, int worker)
{
	struct making *making = user;
	const int *dims = making->volume->dims;
	for (int y = 0; y < dims[1] && !atomic_load(&making->stopped); y++) {
		const double share = (double)atomic_load(&making->slices_done) / dims[2];
		if (worker == 0 &&
		    !gz_loading_goes_on(making->loading, share, gz_procedural_names[making->which]))
			atomic_store(&making->stopped, true);
		fill_procedural_row(making, y, (int)part);
	}
	atomic_fetch_add(&making->slices_done, 1);
}

static enum gz_result fill_with(struct making *making)
{
	struct gz_workers *workers = NULL;
	enum gz_result result = gz_workers_create(0, &workers);
	if (result != GZ_OK)
		return result;
	gz_workers_run(workers, fill_slice, making, (size_t)making->volume->dims[2]);
	gz_workers_destroy(&workers);
	/* The other threads may have made all slices of a small volume. */
	const bool goes_on =
		!atomic_load(&making->stopped) &&
		gz_loading_goes_on(making->loading, 1, gz_procedural_names[making->which]);
	return goes_on ? GZ_OK : GZ_ERR_CANCELLED;
}

static enum gz_result fill_volume(struct making *making)
{
	const struct gz_volume *volume = making->volume;
	if (making->which == GZ_PROCEDURAL_SPLASH)
		gz_splash_lay_out(&making->splash);
	if (making->which != GZ_PROCEDURAL_CHAMELEON)
		return fill_with(making);
	double coarsest = volume->spacing[0];
	for (int i = 1; i < 3; i++)
		coarsest = volume->spacing[i] > coarsest ? volume->spacing[i] : coarsest;
	enum gz_result result =
		gz_chameleon_create(2 * coarsest / longest_mm(volume), &making->chameleon);
	if (result == GZ_OK)
		result = fill_with(making);
	gz_chameleon_destroy(&making->chameleon);
	return result;
}

enum gz_voxel_type gz_procedural_type(enum gz_procedural which)
{
	static const enum gz_voxel_type types[GZ_PROCEDURAL_COUNT] = { GZ_VOXEL_U8, GZ_VOXEL_F32,
								       GZ_VOXEL_U16, GZ_VOXEL_U8 };
	return types[which];
}

enum gz_result gz_volume_generate(const struct gz_procedural_request *request,
				  const struct gz_loading *loading, const struct gz_log *log,
				  struct gz_volume *out_volume)
{
	const enum gz_procedural which = request->which;
	const enum gz_voxel_type type = request->type;
	const int *dims = request->dims;
	const double *spacing = request->spacing;
	static const double steps[GZ_VOXEL_TYPE_COUNT] = { 255, 65535, 0 };
	struct gz_volume volume = { .dims = { dims[0], dims[1], dims[2] },
				    .spacing = { spacing[0], spacing[1], spacing[2] },
				    .type = type,
				    .oriented = true };
	if ((unsigned)which >= GZ_PROCEDURAL_COUNT || (unsigned)type >= GZ_VOXEL_TYPE_COUNT)
		return GZ_ERR_INVAL;
	struct making making = { .which = which, .volume = &volume, .loading = loading };
	enum gz_result result = gz_volume_allocate_in(&volume, loading);
	if (result == GZ_OK && steps[type] > 0)
		volume.slope = value_scale(which) / steps[type];
	if (result == GZ_OK)
		result = fill_volume(&making);
	if (result != GZ_OK) {
		if (result != GZ_ERR_CANCELLED)
			gz_err(log, "%s: cannot make %d x %d x %d voxels: %s; choose smaller dims",
			       gz_procedural_names[which], dims[0], dims[1], dims[2],
			       gz_result_text(result));
		if (volume.voxels)
			gz_volume_free(&volume);
		return result;
	}
	gz_volume_find_range(&volume);
	*out_volume = volume;
	return GZ_OK;
}
