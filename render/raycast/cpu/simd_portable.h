/* Four lanes, as most processors have, by the compiler's own vectors: the vocabulary of
 * simd_avx512.h. A mask is all ones or all zeros a lane. */
#include <math.h>
#include <stdint.h>
#include <string.h>

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
SIMD int vm_any(vm a)
{
	int32_t any = 0;
	EACH_LANE any |= a[lane];
	return any != 0;
}
SIMD uint32_t vm_count(vm a)
{
	int32_t sum = 0;
	EACH_LANE sum -= a[lane];
	return (uint32_t)sum;
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
SIMD vi vi_gather(const void *base, vi index, int scale, vm mask)
{
	vi a = { 0 };
	EACH_LANE if (mask[lane])
	{
		int32_t bits;
		memcpy(&bits, (const char *)base + (int64_t)index[lane] * scale, sizeof bits);
		a[lane] = bits;
	}
	return a;
}
SIMD vf vf_gather(const float *base, vi index, vm mask)
{
	return vf_bits(vi_gather(base, index, 4, mask));
}
/* Two 32-bit words from base + index * 8 bytes; zero outside the mask. */
SIMD void gather_pair(const void *base, vi index, vm mask, vf *first, vi *second)
{
	*first = vf_bits(vi_gather(base, index, 8, mask));
	*second = vi_gather((const char *)base + 4, index, 8, mask);
}
/* gather_pair() of all lanes. */
SIMD void load_pairs(const void *base, vi index, vf *first, vi *second)
{
	gather_pair(base, index, vm_all(), first, second);
}
