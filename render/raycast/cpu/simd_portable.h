/* Four lanes, as most processors have, by the compiler's own vectors: the vocabulary of
 * simd_avx512.h. A mask is all ones or all zeros a lane. */
#include <math.h>
#include <stdint.h>
#include <string.h>
#ifdef __SSE2__
#include <emmintrin.h>
#endif

#define SIMD_LANES 4

typedef float vf __attribute__((vector_size(4 * SIMD_LANES)));
typedef int32_t vi __attribute__((vector_size(4 * SIMD_LANES)));
typedef uint32_t vu __attribute__((vector_size(4 * SIMD_LANES)));
typedef vi vm;

#define SIMD static inline __attribute__((always_inline))

#define EACH_LANE for (int lane = 0; lane < SIMD_LANES; lane++)

SIMD vf vf_set(float x)
{
	return x - (vf) { 0 };
}
SIMD vi vi_set(int32_t x)
{
	return x - (vi) { 0 };
}
SIMD vf vf_load(const float *x)
{
	vf a;
	memcpy(&a, x, sizeof a);
	return a;
}
SIMD void vf_store(float *x, vf a)
{
	memcpy(x, &a, sizeof a);
}
SIMD vi vi_load(const void *x)
{
	vi a;
	memcpy(&a, x, sizeof a);
	return a;
}
SIMD void vi_store(uint32_t *x, vi a)
{
	memcpy(x, &a, sizeof a);
}
SIMD vf vf_select(vm m, vf yes, vf no)
{
	return (vf)((m & (vi)yes) | (~m & (vi)no));
}
/* Zero outside the mask. */
SIMD vf vf_keep(vm m, vf a)
{
	return (vf)(m & (vi)a);
}
SIMD vf vf_fma(vf a, vf b, vf c)
{
	return a * b + c;
}
SIMD vf vf_min(vf a, vf b)
{
	return vf_select(a < b, a, b);
}
SIMD vf vf_max(vf a, vf b)
{
	return vf_select(a > b, a, b);
}
SIMD vf vf_sqrt(vf a)
{
	EACH_LANE a[lane] = sqrtf(a[lane]);
	return a;
}
/* 1 / a and 1 / sqrt(a) */
SIMD vf vf_inverse(vf a)
{
	return 1 / a;
}
SIMD vf vf_inverse_root(vf a)
{
	return 1 / vf_sqrt(a);
}
SIMD vf vf_ceil(vf a)
{
	EACH_LANE a[lane] = ceilf(a[lane]);
	return a;
}
SIMD vf vf_floor(vf a)
{
	EACH_LANE a[lane] = floorf(a[lane]);
	return a;
}
SIMD vf vf_abs(vf a)
{
	return (vf)((vi)a & 0x7FFFFFFF);
}
SIMD vf vf_from_i(vi a)
{
	return __builtin_convertvector(a, vf);
}
SIMD vf vf_bits(vi a)
{
	return (vf)a;
}
SIMD vi vi_bits(vf a)
{
	return (vi)a;
}
SIMD vi vi_trunc(vf a)
{
	return __builtin_convertvector(a, vi);
}
/* To nearest; only ever asked of values from 0 up. */
SIMD vi vi_round(vf a)
{
	return vi_trunc(a + 0.5F);
}
SIMD vi vi_add(vi a, vi b)
{
	return (vi)((vu)a + (vu)b);
}
SIMD vi vi_mul(vi a, vi b)
{
	return (vi)((vu)a * (vu)b);
}
SIMD vi vi_and(vi a, vi b)
{
	return a & b;
}
SIMD vi vi_or(vi a, vi b)
{
	return a | b;
}
SIMD vi vi_select(vm m, vi yes, vi no)
{
	return (vi)vf_select(m, (vf)yes, (vf)no);
}
SIMD vi vi_min(vi a, vi b)
{
	const vi m = a < b;
	return (m & a) | (~m & b);
}
#define vi_shift_right(a, n) ((vi)((vu)(a) >> (n)))
/* By a number that is not a constant. */
#define vi_shift_right_by(a, n) vi_shift_right((a), (n))
#define vi_shift_left(a, n)     ((vi)((vu)(a) << (n)))
SIMD vm vf_less(vf a, vf b)
{
	return a < b;
}
SIMD vm vi_nonzero(vi a)
{
	return a != 0;
}
SIMD vm vm_and(vm a, vm b)
{
	return a & b;
}
SIMD vm vm_or(vm a, vm b)
{
	return a | b;
}
SIMD vm vm_but(vm a, vm b)
{
	return a & ~b;
}
/* Bit i is lane i. */
SIMD unsigned vm_bits(vm a)
{
#ifdef __SSE2__
	return (unsigned)_mm_movemask_ps((__m128)a);
#else
	unsigned bits = 0;
	EACH_LANE bits |= a[lane] ? 1U << lane : 0;
	return bits;
#endif
}
SIMD int vm_any(vm a)
{
	return vm_bits(a) != 0;
}
SIMD uint32_t vm_count(vm a)
{
	return (uint32_t)(UINT64_C(0x4332322132212110) >> (4 * vm_bits(a)) & 15);
}
SIMD vm vm_all(void)
{
	return vi_set(-1);
}
SIMD vm vm_from_bits(uint32_t bits)
{
	vm a = { 0 };
	EACH_LANE a[lane] = (bits >> lane & 1) ? -1 : 0;
	return a;
}
/* 32 bits of each lane from base + index * scale bytes; zero outside the mask. Lanes outside read
 * the first ones, since that takes less time than to ask. */
SIMD vi vi_gather(const void *base, vi index, int scale, vm mask)
{
	int32_t bits[SIMD_LANES];
	const vi from = index & mask;
	EACH_LANE memcpy(&bits[lane], (const char *)base + (int64_t)from[lane] * scale,
			 sizeof bits[lane]);
	return vi_load(bits) & mask;
}
SIMD vf vf_gather(const float *base, vi index, vm mask)
{
	return vf_bits(vi_gather(base, index, 4, mask));
}
/* Two 32-bit words of each lane from base + index * 8 bytes. */
SIMD void load_pairs(const void *base, vi index, vf *first, vi *second)
{
	typedef int64_t two __attribute__((vector_size(16)));
	int64_t words[SIMD_LANES];
	EACH_LANE memcpy(&words[lane], (const char *)base + (int64_t)index[lane] * 8,
			 sizeof words[lane]);
	const vi low = (vi)(two) { words[0], words[1] }, high = (vi)(two) { words[2], words[3] };
#ifdef __clang__
	*first = (vf)__builtin_shufflevector(low, high, 0, 2, 4, 6);
	*second = __builtin_shufflevector(low, high, 1, 3, 5, 7);
#else
	*first = (vf)__builtin_shuffle(low, high, (vi) { 0, 2, 4, 6 });
	*second = __builtin_shuffle(low, high, (vi) { 1, 3, 5, 7 });
#endif
}
/* load_pairs(), zero outside the mask. */
SIMD void gather_pair(const void *base, vi index, vm mask, vf *first, vi *second)
{
	vf a;
	vi b;
	load_pairs(base, index & mask, &a, &b);
	*first = (vf)((vi)a & mask);
	*second = b & mask;
}

/* What only beams need. */

/* 0, 1, 2, ... */
SIMD vf vf_counting(void)
{
	return (vf) { 0, 1, 2, 3 };
}
/* To the nearest whole number, of numbers whose size is below 2^22. */
SIMD vf vf_nearest(vf a)
{
	const vf much = vf_set(0x1.8p23F);
	return (a + much) - much;
}
/* The least and the greatest of the lanes of a mask. */
SIMD float vf_least_of(vf a, vm mask)
{
	float least = INFINITY;
	EACH_LANE if (mask[lane] && a[lane] < least) least = a[lane];
	return least;
}
SIMD float vf_greatest_of(vf a, vm mask)
{
	return -vf_least_of(vf_set(0) - a, mask);
}
/* Store the lanes of a mask side by side. Writes up to SIMD_LANES floats. Returns how many. */
SIMD int vf_store_packed(float *x, vf a, vm mask)
{
	const unsigned bits = vm_bits(mask);
	int count = 0;
	EACH_LANE
	{
		x[count] = a[lane];
		count += bits >> lane & 1;
	}
	return count;
}
SIMD vi vi_xor(vi a, vi b)
{
	return a ^ b;
}
SIMD vm vi_less(vi a, vi b)
{
	return a < b;
}
SIMD vi vi_shift_right_each(vi a, vi by)
{
	return (vi)((vu)a >> (vu)by);
}
/* Of two signed words a lane: low * low + high * high. */
SIMD vi vi_sum_of_products(vi a, vi b)
{
#ifdef __SSE2__
	return (vi)_mm_madd_epi16((__m128i)a, (__m128i)b);
#else
	const vi low = (vi)((vu)a << 16) >> 16, other = (vi)((vu)b << 16) >> 16;
	return low * other + (a >> 16) * (b >> 16);
#endif
}
/* For each lane two neighbours of `bytes` a voxel along x, from index + `from`, as words, of 16-bit
 * values less 32768. */
SIMD vi load_word_pairs(int bytes, const void *voxels, int64_t from,
			const int32_t index[SIMD_LANES])
{
	const char *base = (const char *)voxels + from * bytes;
	int32_t bits[SIMD_LANES];
	EACH_LANE memcpy(&bits[lane], base + (int64_t)index[lane] * bytes, sizeof bits[lane]);
	const vi pair = vi_load(bits);
	if (bytes == 1)
		return (pair & 0xFF) | (vi)((vu)(pair & 0xFF00) << 8);
	return pair ^ (int32_t)0x80008000;
}
