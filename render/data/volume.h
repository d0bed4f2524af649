/**
 * @file
 * A volume in memory, turned to RAS+, and how it is loaded, made and identified: scalar values, and
 * for some files a colour beside each (render/data/voxel_colour.h).
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

struct gz_volume;
struct gz_series_list;

/** What the values of voxels with colours of their own are to be: scene key volume.opacity. */
enum gz_opacity_source {
	GZ_OPACITY_AUTO, /**< alpha if the file has one, and in a file of one time point if it is
			    not the same everywhere; else luminance */
	GZ_OPACITY_LUMINANCE,
	GZ_OPACITY_ALPHA, /**< colours without alpha are refused */
};

/** How slices that do not lie evenly become voxels. */
enum gz_resampling {
	GZ_RESAMPLING_OFF,     /**< not at all: missing slices and uneven ones are refused */
	GZ_RESAMPLING_LINEAR,  /**< interpolated between the two nearest slices and voxels */
	GZ_RESAMPLING_NEAREST, /**< taken from the nearest: for labels, whose numbers mean nothing
				  between each other */
	GZ_RESAMPLING_COUNT,
};

/** "off", "linear", "nearest"; NULL-terminated, in the order of enum gz_resampling. */
extern const char *const gz_resampling_names[];

/** How a volume is loaded, made or written. Zero-initialised, or NULL in its place: no reports,
 *  voxels in memory, no way to stop. */
struct gz_loading {
	/**
	 * Optional: reports progress, several times, on the thread that loads.
	 *
	 * @param user   the member user
	 * @param share  of the work that is done, 0 to 1
	 * @param what   what is loaded: a path, or the name of a formula; valid during the call
	 * @return false to stop: the loader frees everything and returns GZ_ERR_CANCELLED
	 */
	bool (*report)(void *user, double share, const char *what);
	void *user;
	/** Folder for a nameless file that holds the voxels, so that a volume may be larger than
	 *  memory; its disk space is freed with the volume. NULL: voxels in memory. Borrowed. */
	const char *scratch;
	size_t scratch_from; /**< bytes; smaller volumes are kept in memory in any case */
	/** Memory for the bricks of a file of bricks, bytes; 0: a quarter of the machine's. */
	size_t brick_bytes;
	/** UID of the DICOM series wanted; NULL or empty: the file's own, or the only one.
	 * Borrowed; other formats ignore it. */
	const char *series_uid;
	/** What to do where several series are meant: list them in it (render/data/series_list.h)
	 *  and return GZ_ERR_CHOICE, without a line in the log. NULL: refuse with GZ_ERR_FORMAT. */
	struct gz_series_list *series_list;
	/** Of DICOM series whose slices do not lie evenly; other formats ignore it. */
	enum gz_resampling resampling;
	int time_point; /**< of a file that holds several, from 0; other files have only 0 */
	enum gz_opacity_source opacity; /**< of a file of colours; others ignore it */
	/** The member number_range of another time point that was loaded before. Borrowed. NULL:
	 *  found by reading all of them. */
	const double *number_range;
	/**
	 * Optional: gives the memory of the voxels, instead of the above.
	 *
	 * @param user    the member user
	 * @param volume  all but its voxels and their range is set
	 * @param bytes   of the voxels and their colours, with GZ_VOLUME_PADDING
	 * @return zeroed, aligned to a page; gz_volume_free() unmaps it. NULL: none; the loader
	 * then returns GZ_ERR_NO_MEM
	 */
	void *(*give_memory)(void *user, const struct gz_volume *volume, size_t bytes);
};

/** Report the share of the work that is done, 0 to 1. Returns false if the loader must stop. */
static inline bool gz_loading_goes_on(const struct gz_loading *loading, double share,
				      const char *what)
{
	return !loading || !loading->report || loading->report(loading->user, share, what);
}

/** How voxels are stored. Loaders convert every other type into one of these, if possible without
 *  loss: signed integers get an offset that the intercept takes back, wider numbers become float.
 */
enum gz_voxel_type {
	GZ_VOXEL_U8,
	GZ_VOXEL_U16, /**< host byte order */
	GZ_VOXEL_F32, /**< finite: NaN and infinities in a file become the least finite value,
			 logged */
	GZ_VOXEL_TYPE_COUNT,
};

/** Size of a voxel, bytes; 0 for an unknown type. */
size_t gz_voxel_size(enum gz_voxel_type type);

/** A voxel as it is stored, without the volume's slope and intercept. `voxels` is an array of
 * `type` with more than `index` elements. Exact. */
static inline double gz_voxel_stored(enum gz_voxel_type type, const void *voxels, size_t index)
{
	return type == GZ_VOXEL_U8    ? ((const uint8_t *)voxels)[index]
	       : type == GZ_VOXEL_U16 ? ((const uint16_t *)voxels)[index]
				      : (double)((const float *)voxels)[index];
}

/** What the values of a volume are if its voxels have colours of their own. */
enum gz_volume_colour {
	GZ_COLOUR_NONE, /**< no colours: they follow from the values by the transfer function */
	GZ_COLOUR_LUMINANCE, /**< the luminance of the colours */
	GZ_COLOUR_ALPHA,     /**< the alpha of the colours */
};

/** By which kind of device a volume was made, as far as its file says so. */
enum gz_modality {
	GZ_MODALITY_UNKNOWN, /**< the file does not say; most formats cannot */
	GZ_MODALITY_CT,
	GZ_MODALITY_MR,
	GZ_MODALITY_OTHER,
	GZ_MODALITY_COUNT,
};

/** The modality of a term of DICOM (PS3.3, C.7.3.1.1.1): "CT", "MR". OT ("other") and an empty term
 *  say nothing of the values and give GZ_MODALITY_UNKNOWN. */
enum gz_modality gz_modality_of_term(const char *term);

/** Longest edge of a volume, voxels. */
#define GZ_VOLUME_DIM_MAX 16384

/** Longest edge of a volume in voxel lengths; it may be longer than its number of voxels if spacing
 * is anisotropic. Chosen: four times GZ_VOLUME_DIM_MAX. At the finest sampling a ray across the box
 * then has fewer than 2^22 samples, so that a sample's number plus a half is exact in single
 * precision. */
#define GZ_VOLUME_EDGE_LENGTHS_MAX 65536

/** Most time points of a file. Chosen: more than NIfTI can have, and the bytes of all of them can
 * be counted in 64 bits. */
#define GZ_TIME_POINTS_MAX 65536

/** Readable bytes after the last voxel, so that wide loads need no special case at the end. */
#define GZ_VOLUME_PADDING 64

struct gz_brick_pool;

/** A volume. Read-only once loaded. Threads may share it, except for its bricks. */
struct gz_volume {
	int dims[3];          /**< voxels along x (right), y (front), z (up): x varies fastest */
	double spacing[3];    /**< between voxel centres, mm or whatever the file has; above 0 */
	bool spacing_assumed; /**< nobody said what it is along some axis: it is 1 there */
	enum gz_voxel_type type;
	void *voxels; /**< dims[0] * dims[1] * dims[2] voxels and GZ_VOLUME_PADDING bytes; NULL
			 if the volume has bricks */
	struct gz_brick_pool *bricks; /**< of a file of bricks, whose voxels are read when they are
					 visible, by one renderer at a time; else NULL */
	/** With colours, type is GZ_VOXEL_U8, slope 1 and intercept 0, and there are no bricks. */
	enum gz_volume_colour colour;
	/** As many words as voxels, see gz_colour_pack(), and GZ_VOLUME_PADDING bytes; in the
	 * memory of the voxels. NULL without colours. */
	uint32_t *colours;
	double slope; /**< data value = slope * stored + intercept; not 0 */
	double intercept;
	double stored_min, stored_max; /**< over all voxels; of a series, over all time points */
	bool oriented;                 /**< it is known where right, front and up are */
	bool labels; /**< the file says that values are numbers of things, with nothing between */
	enum gz_modality modality;
	size_t mapped; /**< bytes of the file that holds the voxels, on the disk or in memory, which
			  may be mapped to be read only; 0: memory of the program */
	int time_points; /**< of its file, which hold volumes of one layout; 0 or 1: no series */
	int time_point;  /**< which of them this is, from 0 */
	/** With several time points: least and greatest number of all of them in the file */
	double number_range[2];
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

/** The layout of a file without a header. */
struct gz_raw_layout {
	int dims[3];
	enum gz_raw_type type;
	bool big_endian;
	double spacing[3]; /**< 0 along an axis: not known, and 1 is assumed */
	int channels; /**< numbers of a voxel: 0 or 1 its value, 3 red, green and blue, 4 and alpha
		       */
};

/**
 * Load a volume. The format follows from the ending of the name, or from the content if no format
 * has the ending: see render/data/format.h.
 *
 * @param path     a file, or a folder of one DICOM series
 * @param raw      layout of a file without a header; must be NULL for files with a header
 * @param loading  progress, cancelling, and where voxels are kept; may be NULL
 * @param log      may be NULL
 * @param[out] out_volume  written on GZ_OK; the caller frees it with gz_volume_free()
 * @retval GZ_ERR_INVAL        @p raw is missing or must not be given, there is no such time point,
 *                             or opacity is to be alpha and there is none; logged
 * @retval GZ_ERR_NOT_FOUND    no such file; logged
 * @retval GZ_ERR_IO           it cannot be read; logged
 * @retval GZ_ERR_FORMAT       truncated, too large, contradictory or of a wrong type; logged with
 *                             the remedy
 * @retval GZ_ERR_UNSUPPORTED  a format, dimension or encoding that is not read; logged
 * @retval GZ_ERR_NO_MEM       logged with the size asked for
 * @retval GZ_ERR_CANCELLED    @p loading stopped it; not logged
 * @retval GZ_ERR_CHOICE       several series, and @p loading has a list for them; not logged
 *
 * Peak memory is the volume and a small buffer: slices are converted and turned as they are read.
 */
enum gz_result gz_volume_load(const char *path, const struct gz_raw_layout *raw,
			      const struct gz_loading *loading, const struct gz_log *log,
			      struct gz_volume *out_volume);

/** Volumes computed from a formula, for scenes without a file. */
enum gz_procedural {
	GZ_PROCEDURAL_SHELLS,    /**< nested shells with spherical harmonics, like a small atom */
	GZ_PROCEDURAL_SUPERNOVA, /**< turbulent filaments round a hollow centre, float */
	GZ_PROCEDURAL_CHAMELEON, /**< an animal: soft tissue, rough skin, thin bones, 16 bit */
	GZ_PROCEDURAL_SPLASH,    /**< a drop that has fallen into a puddle: 1 inside the liquid */
	GZ_PROCEDURAL_COUNT,
};

/** "shells", "supernova", "chameleon"; NULL-terminated. */
extern const char *const gz_procedural_names[];

/** The default type of voxels of a procedural volume. */
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
 * @param[out] out_volume  written on GZ_OK; the caller frees it with gz_volume_free()
 * @retval GZ_ERR_INVAL      the request is out of range; wrong dims or spacing are logged
 * @retval GZ_ERR_NO_MEM     logged
 * @retval GZ_ERR_CANCELLED  @p loading stopped it; not logged
 */
enum gz_result gz_volume_generate(const struct gz_procedural_request *request,
				  const struct gz_loading *loading, const struct gz_log *log,
				  struct gz_volume *out_volume);

/** Bytes of the voxels of a volume with a valid layout, and of their colours, which follow after
 *  padding. The padding at the end does not count. */
size_t gz_volume_bytes(const struct gz_volume *volume);

/** Set the member colours to where it belongs, after the voxels, which are there; NULL if the
 * volume has no colours. */
void gz_volume_place_colours(struct gz_volume *volume);

/**
 * Allocate the voxels of a volume whose dims, spacing, type and colour are set, and clear the
 * padding. What voxels and colours hold is undefined; they are aligned to 64 bytes. slope becomes
 * 1, intercept 0.
 *
 * @retval GZ_ERR_INVAL   dims out of range, spacing not finite or not above 0, an edge longer than
 *                        GZ_VOLUME_EDGE_LENGTHS_MAX, or colours beside another type than
 *                        GZ_VOXEL_U8; not logged
 * @retval GZ_ERR_NO_MEM  not logged
 */
enum gz_result gz_volume_allocate(struct gz_volume *volume);

/**
 * As gz_volume_allocate(), but in a nameless file in the scratch folder of @p loading if it has one
 * and the voxels take at least scratch_from bytes. Disk space is reserved first, so that a full
 * disk is an error here and not a signal later.
 *
 * @retval GZ_ERR_FULL       the disk is full; not logged
 * @retval GZ_ERR_NOT_FOUND  there is no such folder; not logged
 * @retval GZ_ERR_IO         no file can be created there; not logged
 */
enum gz_result gz_volume_allocate_in(struct gz_volume *volume, const struct gz_loading *loading);

/** Whether dims, spacing, type and colour of @p volume are such that gz_volume_allocate() takes
 * them. */
bool gz_volume_layout_valid(const struct gz_volume *volume);

/** Whether the machine has so much memory. On a kernel that overcommits, allocating more would
 *  succeed at first and end in a signal later. */
bool gz_memory_fits_machine(size_t bytes);

/** Set stored_min and stored_max to the least and greatest voxel. */
void gz_volume_find_range(struct gz_volume *volume);

/** Free the voxels or close the bricks, and zero the struct. Accepts a zero-initialised volume. */
void gz_volume_free(struct gz_volume *volume);

/** The longest edge of a box of voxels, in voxel lengths; dims and spacing must be above 0. */
double gz_volume_edge_lengths(const int dims[3], const double spacing[3]);

/** Memory that one volume may take unless a setting says otherwise, bytes: a quarter of the
 *  machine's; 1 GiB if the system does not tell that. */
size_t gz_volume_memory_bytes(void);

/** Number of voxels. */
size_t gz_volume_voxel_count(const struct gz_volume *volume);

/** Half of each edge of the box, world units. */
void gz_volume_half_extent(const struct gz_volume *volume, double out_half[3]);

/** The voxel length, world units. */
double gz_volume_voxel_length(const struct gz_volume *volume);

/** Properties that distinguish volumes: sessions and pictures keep them, to notice when a file's
 * data have changed. */
struct gz_volume_identity {
	int dims[3];
	enum gz_voxel_type type;
	double spacing[3];
	double least, greatest; /**< data values: slope and intercept applied */
	bool has_crc;           /**< false for a file of bricks, whose voxels are not in memory */
	uint32_t crc;           /**< CRC-32 of some of the voxels, see gz_volume_identify() */
};

/**
 * Identify a volume. The CRC covers 4096 runs of 64 bytes, evenly spaced over the voxels, or all
 * voxels if there are fewer, and as many of their colours: enough to distinguish volumes, and quick
 * for any size.
 */
struct gz_volume_identity gz_volume_identify(const struct gz_volume *volume);

/** Whether two identities are equal. The CRC counts only if both have one. */
bool gz_volume_identity_same(const struct gz_volume_identity *a,
			     const struct gz_volume_identity *b);

#endif
