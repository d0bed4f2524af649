/* From voxels to bits. */
#include <math.h>
#include <string.h>
#ifdef __SSE2__
#include <emmintrin.h>
#endif

#include "render/mesh/isosurface_rows.h"

/* Of 32 voxels, those at or above the threshold. Every x86-64 has SSE2; it reads voxels faster than
 * memory delivers them. */
#ifdef __SSE2__
static uint32_t word_of_u8(const uint8_t *voxels, uint8_t threshold)
{
	const __m128i least = _mm_set1_epi8((char)threshold);
	uint32_t word = 0;
	for (int i = 0; i < 2; i++) {
		const __m128i v = _mm_loadu_si128((const __m128i *)(voxels + 16 * i));
		const __m128i above = _mm_cmpeq_epi8(_mm_max_epu8(v, least), v);
		word |= (uint32_t)_mm_movemask_epi8(above) << 16 * i;
	}
	return word;
}

static uint32_t word_of_u16(const uint16_t *voxels, uint16_t threshold)
{
	const __m128i least = _mm_set1_epi16((short)threshold), zero = _mm_setzero_si128();
	uint32_t word = 0;
	for (int i = 0; i < 2; i++) {
		const __m128i *v = (const __m128i *)(voxels + 16 * i);
		const __m128i low = _mm_subs_epu16(least, _mm_loadu_si128(v));
		const __m128i high = _mm_subs_epu16(least, _mm_loadu_si128(v + 1));
		const __m128i above =
			_mm_packs_epi16(_mm_cmpeq_epi16(low, zero), _mm_cmpeq_epi16(high, zero));
		word |= (uint32_t)_mm_movemask_epi8(above) << 16 * i;
	}
	return word;
}

static uint32_t word_of_f32(const float *voxels, float threshold)
{
	const __m128 least = _mm_set1_ps(threshold);
	uint32_t word = 0;
	for (int i = 0; i < 8; i++) {
		const __m128 above = _mm_cmpge_ps(_mm_loadu_ps(voxels + 4 * i), least);
		word |= (uint32_t)_mm_movemask_ps(above) << 4 * i;
	}
	return word;
}
#else
#define DEFINE_WORD(name, type)                                          \
	static uint32_t name(const type *voxels, type threshold)         \
	{                                                                \
		uint32_t word = 0;                                       \
		for (int i = 0; i < GZ_ISO_WORD; i++)                    \
			word |= (uint32_t)(voxels[i] >= threshold) << i; \
		return word;                                             \
	}
DEFINE_WORD(word_of_u8, uint8_t)
DEFINE_WORD(word_of_u16, uint16_t)
DEFINE_WORD(word_of_f32, float)
#endif

/* A row of words; the last may be incomplete. known: of each word, or NULL. */
#define DEFINE_CLASSIFY(name, word_of, type)                                                     \
	static void name(const type *voxels, size_t count, type threshold, const uint8_t *known, \
			 uint32_t *bits)                                                         \
	{                                                                                        \
		const size_t whole = count / GZ_ISO_WORD, rest = count % GZ_ISO_WORD;            \
		for (size_t w = 0; w < whole; w++) {                                             \
			if (known && known[w] != GZ_ISO_MIXED)                                   \
				bits[w] = known[w] == GZ_ISO_ABOVE ? UINT32_MAX : 0;             \
			else                                                                     \
				bits[w] = word_of(voxels + w * GZ_ISO_WORD, threshold);          \
		}                                                                                \
		if (rest > 0) {                                                                  \
			type last[GZ_ISO_WORD] = { 0 };                                          \
			memcpy(last, voxels + whole * GZ_ISO_WORD, rest * sizeof last[0]);       \
			bits[whole] = word_of(last, threshold) & ((UINT32_C(1) << rest) - 1);    \
		}                                                                                \
	}

DEFINE_CLASSIFY(classify_u8, word_of_u8, uint8_t)
DEFINE_CLASSIFY(classify_u16, word_of_u16, uint16_t)
DEFINE_CLASSIFY(classify_f32, word_of_f32, float)

/* The blocks' words of a row of voxels. */
static const uint8_t *known_words(const struct gz_iso_job *job, size_t y, size_t z)
{
	if (!job->blocks)
		return NULL;
	const size_t edge = (size_t)job->blocks->edge;
	return job->known + (z / edge * (size_t)job->blocks->dims[1] + y / edge) * job->words;
}

void gz_iso_classify_row(const struct gz_iso_job *job, size_t row)
{
	const struct gz_volume *volume = job->volume;
	const size_t count = (size_t)volume->dims[0], rows = (size_t)volume->dims[1];
	uint32_t *bits = job->bits + row * job->words;
	const uint8_t *known = known_words(job, row % rows, row / rows);
	const float threshold = ceilf(job->isovalue); /* for whole numbers */
	bits[job->words - 1] = 0;
	if (volume->type == GZ_VOXEL_U8)
		classify_u8((const uint8_t *)volume->voxels + row * count, count,
			    (uint8_t)threshold, known, bits);
	else if (volume->type == GZ_VOXEL_U16)
		classify_u16((const uint16_t *)volume->voxels + row * count, count,
			     (uint16_t)threshold, known, bits);
	else
		classify_f32((const float *)volume->voxels + row * count, count, job->isovalue,
			     known, bits);
}

void gz_iso_find_known(const struct gz_iso_job *job, size_t block_row)
{
	const struct gz_value_blocks *blocks = job->blocks;
	const size_t count = (size_t)blocks->dims[0], edge = (size_t)blocks->edge;
	const float *least = blocks->least + block_row * count;
	const float *greatest = blocks->greatest + block_row * count;
	uint8_t *known = job->known + block_row * job->words;
	for (size_t w = 0; w < job->words; w++) {
		const size_t last = (w * GZ_ISO_WORD + GZ_ISO_WORD - 1) / edge;
		bool below = true, above = true;
		for (size_t b = w * GZ_ISO_WORD / edge; b <= last && b < count; b++) {
			below = below && greatest[b] < job->isovalue;
			above = above && least[b] >= job->isovalue;
		}
		known[w] = below ? GZ_ISO_BELOW : above ? GZ_ISO_ABOVE : GZ_ISO_MIXED;
	}
}
