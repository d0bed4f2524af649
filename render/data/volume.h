/**
 * @file
 * A scalar volume in memory, turned to RAS+, and how it is loaded, made and identified.
 *
 * World frame: the box has the edges dims * spacing / max(dims * spacing), centred at the origin;
 * data sit at voxel centres; z is up. The voxel length is the smallest spacing.
 */
#ifndef GZ_RENDER_DATA_VOLUME_H
#define GZ_RENDER_DATA_VOLUME_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/log.h"
#include "base/result.h"

/** Whether this machine stores the most significant byte of a number first. */
static inline bool gz_host_big_endian(void)
{
	const uint16_t one = 1;
	return *(const uint8_t *)&one == 0;
}

/** What a loader is told beside the file. Zero-initialised is silent, in memory and goes on to the
 *  end; NULL stands for that everywhere. */
struct gz_loading {
	/**
	 * Told how far the loading is: often, at the beginning and at the end, on the thread that
	 * loads. May be NULL.
	 *
	 * @param user   as below
	 * @param share  done, 0 to 1
	 * @param what   is loaded: a path, or the name of a formula; valid during the call
	 * @return false to stop: the loader frees what it has and returns GZ_ERR_CANCELLED
	 */
	bool (*report)(void *user, double share, const char *what);
	void *user;
	/** Folder for a nameless file that the voxels are kept in, so that a volume may be larger
	 *  than the memory; its blocks are freed with the volume. NULL: in memory. Borrowed. */
	const char *scratch;
	size_t scratch_from; /**< bytes: smaller volumes stay in memory all the same */
	/** Bytes of memory for the bricks of a file of bricks; 0: a quarter of the machine's. */
	size_t brick_bytes;
};

/** Report a share of the work; false where the loader is to stop. */
static inline bool gz_loading_goes_on(const struct gz_loading *loading, double share,
				      const char *what)
{
	return !loading || !loading->report || loading->report(loading->user, share, what);
}

/** How voxels are stored. Loaders turn every other type into one of these without loss where that
 *  can be: signed integers by an offset that goes into the intercept, wider ones as float. */
enum gz_voxel_type {
	GZ_VOXEL_U8,
	GZ_VOXEL_U16, /**< host byte order */
	GZ_VOXEL_F32, /**< finite: NaN and infinities in a file become the least finite value,
			 logged */
	GZ_VOXEL_TYPE_COUNT,
};

/** Bytes of one voxel. */
size_t gz_voxel_size(enum gz_voxel_type type);

/** Longest edge of a volume, voxels. */
#define GZ_VOLUME_DIM_MAX 16384

/** Longest edge of a volume in voxel lengths, which anisotropic spacing stretches. Chosen: four
 * times GZ_VOLUME_DIM_MAX; at the finest sampling a ray across the box then has less than 2^22
 * samples, so that their number and a half is exact in single precision. */
#define GZ_VOLUME_EDGE_LENGTHS_MAX 65536

/** Bytes readable behind the last voxel, so that wide loads need no edge case. */
#define GZ_VOLUME_PADDING 64

struct gz_brick_pool;

/** A volume. Read-only once loaded; may be shared by threads, but for its bricks. */
struct gz_volume {
	int dims[3];       /**< voxels along x (right), y (front), z (up): x varies fastest */
	double spacing[3]; /**< between voxel centres, mm or whatever the file has; above 0 */
	enum gz_voxel_type type;
	void *voxels; /**< dims[0] * dims[1] * dims[2] of them, and GZ_VOLUME_PADDING bytes; NULL
			 where there are bricks */
	struct gz_brick_pool *bricks; /**< of a volume that is fetched from a file of bricks as it
					 is looked at, by one renderer at a time; else NULL */
	double slope;                 /**< data value = slope * stored + intercept; not 0 */
	double intercept;
	double stored_min, stored_max; /**< over all voxels */
	bool oriented;                 /**< the file told where right, front and up are */
	size_t mapped; /**< bytes of a scratch file that voxels are; 0: they are in memory */
};

/** Type names of raw files. */
enum gz_raw_type {
	GZ_RAW_UINT8,
	GZ_RAW_INT8,
	GZ_RAW_UINT16,
	GZ_RAW_INT16,
	GZ_RAW_UINT32,
	GZ_RAW_INT32,
	GZ_RAW_FLOAT32,
	GZ_RAW_FLOAT64,
	GZ_RAW_TYPE_COUNT,
};

/** "uint8", … NULL-terminated, in the order of enum gz_raw_type. */
extern const char *const gz_raw_type_names[];

/** What a headerless file needs to be told. */
struct gz_raw_layout {
	int dims[3];
	enum gz_raw_type type;
	bool big_endian;
	double spacing[3];
};

/**
 * Load a volume; the kind follows from the name: .nii, .nii.gz, .nrrd, .nhdr, .mhd, .mha, .raw,
 * .raw.zst, and .zst or .gz round raw data; .bin, .dat, .vol and .img where @p raw is given; .dcm,
 * a file that says it is DICOM, or a folder of one DICOM series.
 *
 * @param path        file
 * @param raw         layout of a headerless file; must be NULL for files that have a header
 * @param loading     who is told how far it is, and where the voxels are kept; NULL for nobody and
 * in memory
 * @param[out] out_volume  filled; the caller frees it with gz_volume_free()
 * @retval GZ_ERR_INVAL        @p raw is missing or must not be given; logged
 * @retval GZ_ERR_NOT_FOUND    no such file; logged
 * @retval GZ_ERR_IO           it cannot be read; logged
 * @retval GZ_ERR_FORMAT       truncated, oversized, contradictory, wrong type; logged with the
 * remedy
 * @retval GZ_ERR_UNSUPPORTED  a kind, dimension or encoding that is not read; logged
 * @retval GZ_ERR_NO_MEM       logged with the size asked for
 * @retval GZ_ERR_CANCELLED    @p loading said so; not logged
 *
 * Peak memory is the volume and a small buffer: slices are turned and converted as they are read.
 */
enum gz_result gz_volume_load(const char *path, const struct gz_raw_layout *raw,
			      const struct gz_loading *loading, const struct gz_log *log,
			      struct gz_volume *out_volume);

/** Volumes made by a formula, for scenes that need no file. */
enum gz_procedural {
	GZ_PROCEDURAL_SHELLS,    /**< nested shells with spherical harmonics, like a small atom */
	GZ_PROCEDURAL_SUPERNOVA, /**< turbulent filaments round a hollow centre, float */
	GZ_PROCEDURAL_CHAMELEON, /**< an animal: soft tissue, rough skin, thin bones, 16 bit */
	GZ_PROCEDURAL_COUNT,
};

/** "shells", "supernova", "chameleon"; NULL-terminated. */
extern const char *const gz_procedural_names[];

/** The type of voxel that a procedural volume has unless told otherwise. */
enum gz_voxel_type gz_procedural_type(enum gz_procedural which);

/** Which procedural volume to make. */
struct gz_procedural_request {
	enum gz_procedural which;
	const int *dims;       /**< voxels along x, y, z, each 1 to GZ_VOLUME_DIM_MAX */
	const double *spacing; /**< of voxels along x, y, z, mm, above 0. Formulas are in units of
				  the box's longest edge in mm, so a shape keeps its proportions
				  for any spacing */
	/** Of the voxels. Integers span the formula's values, which are 0 to 255 for shells and 0
	 * to 1 for the others: data values are the same for every type, except for rounding. */
	enum gz_voxel_type type;
};

/**
 * Make a procedural volume on all processors. The same request gives the same bits each time.
 *
 * @param loading  see gz_volume_load()
 * @param[out] out_volume  filled; the caller frees it with gz_volume_free()
 * @retval GZ_ERR_INVAL      the request is out of range; wrong dims or spacing are logged
 * @retval GZ_ERR_NO_MEM     logged
 * @retval GZ_ERR_CANCELLED  @p loading said so; not logged
 */
enum gz_result gz_volume_generate(const struct gz_procedural_request *request,
				  const struct gz_loading *loading, const struct gz_log *log,
				  struct gz_volume *out_volume);

/**
 * Allocate voxels for a volume whose dims, spacing and type are set, and clear the padding. Voxels
 * are aligned to 64 bytes. slope becomes 1, intercept 0. GZ_ERR_INVAL for dims out of range,
 * spacing not finite and above 0, or an edge of more than GZ_VOLUME_EDGE_LENGTHS_MAX;
 * GZ_ERR_NO_MEM.
 */
enum gz_result gz_volume_allocate(struct gz_volume *volume);

/** As gz_volume_allocate(), in a nameless file in the folder of @p loading, whose blocks are
 * reserved first; without one, or @p loading NULL, in memory. Further errors: GZ_ERR_FULL where the
 * disk has no room, GZ_ERR_IO. */
enum gz_result gz_volume_allocate_in(struct gz_volume *volume, const struct gz_loading *loading);

/** Find stored_min and stored_max. */
void gz_volume_find_range(struct gz_volume *volume);

/** Free the voxels or close the bricks, and zero the struct. Accepts a zeroed one. */
void gz_volume_free(struct gz_volume *volume);

/** The longest edge in voxel lengths, of any dims and spacing above 0. */
double gz_volume_edge_lengths(const int dims[3], const double spacing[3]);

/** Number of voxels. */
size_t gz_volume_voxel_count(const struct gz_volume *volume);

/** Half the edges of the world box. */
void gz_volume_half_extent(const struct gz_volume *volume, double out_half[3]);

/** The voxel length, in world units. */
double gz_volume_voxel_length(const struct gz_volume *volume);

/** What two volumes hardly share by chance. */
struct gz_volume_identity {
	int dims[3];
	enum gz_voxel_type type;
	double spacing[3];
	double least, greatest; /**< data values, as of slope and intercept */
	bool has_crc;           /**< voxels were looked at: none are at hand of a file of bricks */
	uint32_t crc;           /**< CRC-32 of some of the voxels, see gz_volume_identify() */
};

/**
 * Tell which volume it is.
 *
 * The CRC is of 4096 runs of 64 bytes, evenly strewn over the voxels, or of all where they are
 * fewer: enough to tell volumes apart, and quick for one of any size.
 */
struct gz_volume_identity gz_volume_identify(const struct gz_volume *volume);

/** Whether both are of one volume; of a CRC that one of them lacks, nothing is asked. */
bool gz_volume_identity_same(const struct gz_volume_identity *a,
			     const struct gz_volume_identity *b);

#endif
