#include "render/decode/minc/minc_hdf.h"

#include <string.h>

/* How many elements an attribute has; below 0: it is damaged. */
static hssize_t attribute_elements(hid_t attribute)
{
	const hid_t space = H5Aget_space(attribute);
	const hssize_t count = space >= 0 ? H5Sget_simple_extent_npoints(space) : -1;
	if (space >= 0)
		H5Sclose(space);
	return count;
}

static bool read_number_attribute(hid_t attribute, double *out, size_t count)
{
	const hid_t type = H5Aget_type(attribute);
	const H5T_class_t kind = type >= 0 ? H5Tget_class(type) : H5T_NO_CLASS;
	if (type >= 0)
		H5Tclose(type);
	return (kind == H5T_INTEGER || kind == H5T_FLOAT) &&
	       attribute_elements(attribute) == (hssize_t)count &&
	       H5Aread(attribute, H5T_NATIVE_DOUBLE, out) >= 0;
}

bool gz_hdf_numbers(hid_t object, const char *name, double *out, size_t count)
{
	double numbers[3];
	const hid_t attribute =
		H5Aexists(object, name) > 0 ? H5Aopen(object, name, H5P_DEFAULT) : GZ_HDF_NONE;
	if (attribute < 0)
		return false;
	const bool read = count <= 3 && read_number_attribute(attribute, numbers, count);
	H5Aclose(attribute);
	if (read)
		memcpy(out, numbers, count * sizeof numbers[0]);
	return read;
}

static bool read_variable_text(hid_t attribute, hid_t type, char out[GZ_HDF_TEXT_SIZE])
{
	char *text = NULL;
	if (H5Aread(attribute, type, &text) < 0 || !text)
		return false;
	const bool fits = strlen(text) < GZ_HDF_TEXT_SIZE;
	if (fits)
		memcpy(out, text, strlen(text) + 1);
	H5free_memory(text);
	return fits;
}

static bool read_text_attribute(hid_t attribute, hid_t type, char out[GZ_HDF_TEXT_SIZE])
{
	if (H5Tget_class(type) != H5T_STRING || attribute_elements(attribute) != 1)
		return false;
	if (H5Tis_variable_str(type) > 0)
		return read_variable_text(attribute, type, out);
	const size_t size = H5Tget_size(type);
	if (size >= GZ_HDF_TEXT_SIZE || H5Aread(attribute, type, out) < 0)
		return false;
	out[size] = 0;
	return true;
}

bool gz_hdf_text(hid_t object, const char *name, char out[GZ_HDF_TEXT_SIZE])
{
	const hid_t attribute =
		H5Aexists(object, name) > 0 ? H5Aopen(object, name, H5P_DEFAULT) : GZ_HDF_NONE;
	const hid_t type = attribute >= 0 ? H5Aget_type(attribute) : GZ_HDF_NONE;
	const bool read = type >= 0 && read_text_attribute(attribute, type, out);
	if (!read)
		out[0] = 0;
	if (type >= 0)
		H5Tclose(type);
	if (attribute >= 0)
		H5Aclose(attribute);
	return read;
}

/* A link to another file is not followed. */
static herr_t refuse_other_file(const char *from_file, const char *from_group, const char *to_file,
				const char *to_object, unsigned *flags, hid_t access, void *user)
{
	(void)from_file;
	(void)from_group;
	(void)to_file;
	(void)to_object;
	(void)flags;
	(void)access;
	(void)user;
	return -1;
}

hid_t gz_hdf_access(void)
{
	const hid_t access = H5Pcreate(H5P_DATASET_ACCESS);
	if (access >= 0 && H5Pset_elink_cb(access, refuse_other_file, NULL) >= 0)
		return access;
	if (access >= 0)
		H5Pclose(access);
	return GZ_HDF_NONE;
}

hid_t gz_hdf_open(const char *path)
{
	H5Eset_auto2(H5E_DEFAULT, NULL, NULL);
	H5PLset_loading_state(0); /* no filters from files of others */
	const hid_t access = H5Pcreate(H5P_FILE_ACCESS);
	hid_t file = GZ_HDF_NONE;
	/* Locks need a call that a decoder may not make. Closing it closes all that is in it. */
	if (access >= 0 && H5Pset_file_locking(access, false, true) >= 0 &&
	    H5Pset_fclose_degree(access, H5F_CLOSE_STRONG) >= 0)
		file = H5Fopen(path, H5F_ACC_RDONLY, access);
	if (access >= 0)
		H5Pclose(access);
	return file;
}

bool gz_hdf_is_in_file(hid_t part)
{
	const hid_t properties = H5Dget_create_plist(part);
	const bool in = properties >= 0 && H5Pget_layout(properties) != H5D_VIRTUAL &&
			H5Pget_layout(properties) >= 0 && H5Pget_external_count(properties) == 0;
	if (properties >= 0)
		H5Pclose(properties);
	return in;
}

int gz_hdf_sizes(hid_t part, hsize_t sizes[GZ_HDF_AXES_MAX])
{
	const hid_t space = H5Dget_space(part);
	int rank = space >= 0 && H5Sis_simple(space) > 0 ? H5Sget_simple_extent_ndims(space) : -1;
	if (rank > GZ_HDF_AXES_MAX ||
	    (rank > 0 && H5Sget_simple_extent_dims(space, sizes, NULL) != rank))
		rank = -1;
	if (space >= 0)
		H5Sclose(space);
	return rank;
}

bool gz_hdf_has_filters(hid_t properties, int count)
{
	for (unsigned i = 0; (int)i < count; i++) {
		unsigned flags, values[1];
		size_t value_count = 1;
		const H5Z_filter_t filter =
			H5Pget_filter2(properties, i, &flags, &value_count, values, 0, NULL, NULL);
		if (filter < 0 || H5Zfilter_avail(filter) <= 0)
			return false;
	}
	return true;
}
