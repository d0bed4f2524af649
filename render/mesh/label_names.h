/**
 * @file
 * Names and colours of labels, from the text files that come with atlases and segmentations.
 *
 * | format | rows | from |
 * |---|---|---|
 * | colour table | number, name, red green blue (0 to 255), and a number that is ignored |
 * FreeSurfer (FreeSurferColorLUT.txt), 3D Slicer (.ctbl) | | label descriptions | number, red green
 * blue, three numbers that are ignored, "name" | ITK-SNAP | | dseg table | a line of column names,
 * among them index and name, perhaps color (#rrggbb); columns are separated by tabs | BIDS
 * (_dseg.tsv) | | list | number, name, in all rows perhaps one more number, which is ignored |
 * MRIcron (aal.nii.txt) |
 *
 * Rows that begin with # are comments. The first row tells the format.
 *
 * 3D Slicer also writes names into the header of a segmentation (.seg.nrrd), as lines such as
 *
 *     Segment0_Name:=liver
 *     Segment0_LabelValue:=3
 *     Segment0_Color:=0.86 0.51 0.39
 *
 * Segments of another layer than the first (Segment0_Layer:=0) overlap these and are left out.
 */
#ifndef GZ_RENDER_MESH_LABEL_NAMES_H
#define GZ_RENDER_MESH_LABEL_NAMES_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/log.h"
#include "base/result.h"
#include "base/sizes.h"

/** A label's name with its NUL, bytes. Chosen: the longest of the atlases at hand has 80. */
#define GZ_LABEL_NAME_SIZE 128

/** Most rows of a file. Chosen: FreeSurfer's has 14 000. */
#define GZ_LABEL_NAMES_MAX 65536

/** Most segments that a header names. Chosen: as many as labels that can be shown. */
#define GZ_LABEL_SEGMENTS_MAX 960

/** What a file says about one label. */
struct gz_label_name {
	int32_t number;
	bool has_colour;
	float colour[3];               /**< red, green and blue, [0, 1]; with has_colour */
	char name[GZ_LABEL_NAME_SIZE]; /**< UTF-8 as in the file, without control characters */
	int line;                      /**< of the file, from 1 */
};

/** All of them. Zero-initialised is empty. */
struct gz_label_names {
	size_t count;
	struct gz_label_name *items; /**< by rising numbers, each once */
};

/**
 * Read names from text.
 *
 * @param file  its name in messages
 * @param log   may be NULL
 * @param[out] out_names  written on GZ_OK; the caller frees it with gz_label_names_free(). Of rows
 *                        with one number the first counts, with a warning
 * @retval GZ_ERR_FORMAT  none of the formats, or a row that breaks its rules; logged with the line
 * @retval GZ_ERR_FULL    more than GZ_LABEL_NAMES_MAX rows; logged
 * @retval GZ_ERR_NO_MEM  logged
 */
enum gz_result gz_label_names_parse(const char *file, const char *text, size_t size,
				    const struct gz_log *log, struct gz_label_names *out_names);

/** Read names from a file of at most 8 MiB, or from the header of a NRRD file. @return what
 *  gz_text_load() or gz_text_head_open(), and gz_label_names_parse() return; logged */
enum gz_result gz_label_names_read(const char *path, const struct gz_log *log,
				   struct gz_label_names *out_names);

/**
 * Find the file of names that lies beside a volume: of its name with .txt, .label, .ctbl, .tsv or
 * .lut.txt in place of its ending or behind it, or FreeSurferColorLUT.txt in its folder; else the
 * volume itself if it is a NRRD file, which may name segments.
 *
 * @param[out] out_path  of an existing file
 * @return false: there is none
 */
bool gz_label_names_beside(const char *volume, char out_path[GZ_PATH_SIZE]);

/** What is known about a label; NULL: nothing. Borrowed. */
const struct gz_label_name *gz_label_names_find(const struct gz_label_names *names, int32_t number);

/** Free what it holds and zero it. */
void gz_label_names_free(struct gz_label_names *names);

#endif
