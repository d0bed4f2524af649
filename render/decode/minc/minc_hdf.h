/* What is asked of HDF5: small steps that free all that they open. For this room. */
#ifndef GZ_RENDER_DECODE_MINC_HDF_H
#define GZ_RENDER_DECODE_MINC_HDF_H

#include <hdf5.h>
#include <stdbool.h>
#include <stddef.h>

/** No object. Handles below 0 are none. */
#define GZ_HDF_NONE ((hid_t)-1)

/** Most axes of what is read. */
#define GZ_HDF_AXES_MAX 5

/** Size of a text with its NUL, bytes; longer ones count as missing. */
#define GZ_HDF_TEXT_SIZE 512

/** Open a file to be read, without locks, which need a call that a decoder may not make. HDF5
 * prints no errors from then on and loads no filters. H5Fclose() closes all that is in the file. */
hid_t gz_hdf_open(const char *path);

/** How links and data sets are opened: links to other files are not followed. H5Pclose() frees it.
 */
hid_t gz_hdf_access(void);

/** The numbers of an attribute. @return false, and @p out unchanged, if there is none, or not
 *  @p count of them, which is 3 at most. */
bool gz_hdf_numbers(hid_t object, const char *name, double *out, size_t count);

/** The text of an attribute. @return false, and an empty @p out, if there is none */
bool gz_hdf_text(hid_t object, const char *name, char out[GZ_HDF_TEXT_SIZE]);

/** Whether all numbers of a data set are in its own file, where their size can be checked. */
bool gz_hdf_is_in_file(hid_t part);

/** The edges of a data set, the slowest first. @return how many; 0: a single number; below 0: none
 *  that can be read, or more than GZ_HDF_AXES_MAX */
int gz_hdf_sizes(hid_t part, hsize_t sizes[GZ_HDF_AXES_MAX]);

/** Whether HDF5 has all filters, @p count of them, of a data set's creation properties. */
bool gz_hdf_has_filters(hid_t properties, int count);

#endif
