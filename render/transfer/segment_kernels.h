/**
 * @file
 * The loops that fill pre-integrated tables, once for each instruction set; internal to this room.
 * segment_kernels.c, segment_kernels_avx2.c and segment_kernels_avx512.c compile the same loops
 * (segment_loops.h), with the same bits.
 */
#ifndef GZ_RENDER_TRANSFER_SEGMENT_KERNELS_H
#define GZ_RENDER_TRANSFER_SEGMENT_KERNELS_H

#include "render/transfer/transfer_preintegrated.h"

enum {
	GZ_SEGMENT_PARTS = 4, /**< of a segment, whose order is kept */
	/** Rows that are filled at a time, so that whole cache lines of columns are written. */
	GZ_SEGMENT_ROWS = 64 / sizeof(struct gz_transfer_entry),
};

/** The segments from one cell to all higher cells, indexed by their width in cells less 1: mean
 *  extinction and colour of each part, for any length. One array for each part and number, so that
 *  compilers vectorise the loops. */
struct gz_segment_means {
	float extinction[GZ_SEGMENT_PARTS][GZ_PREINTEGRATED_SIZE];
	float rgb[GZ_SEGMENT_PARTS][3][GZ_PREINTEGRATED_SIZE];
};

/** What is done with rows of segments. Threads: any, for different rows. */
struct gz_segment_kernels {
	const char *name; /**< portable, avx2 or avx512 */
	/** The means of the segments from a cell to @p count higher ones. */
	void (*average)(const struct gz_transfer_sums *sums, int low, int count,
			struct gz_segment_means *out_means);
	/** Blend the parts of segments of four times @p length, front to back: rising, whose front
	 *  is the row's cell, and falling, whose back it is. */
	void (*blend)(const struct gz_segment_means *means, int count, float length,
		      struct gz_transfer_entry *out_rising, struct gz_transfer_entry *out_falling);
	/** A segment within one cell, of four times @p length. */
	void (*segment_in_cell)(const struct gz_transfer_sums *sums, int cell, float length,
				struct gz_transfer_entry *out_entry);
	/** The same segments of any length as means, whatever the order of their colours: with
	 *  extinction. */
	void (*mix)(const struct gz_transfer_sums *sums, int low, int count,
		    struct gz_transfer_entry *out_entries);
	/** A segment of any length within one cell: with extinction. */
	void (*mix_in_cell)(const struct gz_transfer_sums *sums, int cell,
			    struct gz_transfer_entry *out_entry);
};

extern const struct gz_segment_kernels gz_segment_kernels_portable;
#ifdef GZ_TRANSFER_X86
extern const struct gz_segment_kernels gz_segment_kernels_avx2;
extern const struct gz_segment_kernels gz_segment_kernels_avx512;
#endif

/** Those of a name, portable, avx2 or avx512; NULL: the best. Static. NULL if this processor does
 * not run them. */
const struct gz_segment_kernels *gz_segment_kernels_find(const char *name);

#endif
