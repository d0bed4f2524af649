/* Formats that are recognised to say how to convert them; they are not read. */
#include <string.h>

#include "render/data/file_start.h"
#include "render/data/format.h"

#define GZ_LOG_MODULE "volume"

/* Bytes that a file begins with. */
struct foreign_magic {
	const char *bytes;
	size_t size;
	const char *name;
	const char *remedy;
};

#define MAGIC(text) (text), sizeof(text) - 1
#define FROM_MINC   "convert it with: mincconvert -2 FILE out.mnc (minc-tools)"
#define FROM_ITK    "convert it with ITK or 3D Slicer to NRRD"
#define FROM_COMPRESSED                                                               \
	"unpack it first, with gunzip, bunzip2 or unzstd, and open the unpacked file" \
	" or its folder"
#define COMPRESSED_DICOM "a compressed DICOM file"
#define FROM_PARAVIEW    "save it as MetaImage with ParaView, or as NRRD with ITK"

static const struct foreign_magic foreign_magics[] = {
	{ MAGIC("CDF\001"), "MINC 1 (netCDF)", FROM_MINC },
	{ MAGIC("CDF\002"), "MINC 1 (netCDF)", FROM_MINC },
	{ MAGIC("# vtk DataFile"), "VTK", FROM_PARAVIEW },
	{ MAGIC("<VTKFile"), "VTK XML", FROM_PARAVIEW },
	{ MAGIC("<?xml version=\"1.0\"?>\n<VTKFile"), "VTK XML", FROM_PARAVIEW },
	{ MAGIC("II*\0"), "TIFF", FROM_ITK },
	{ MAGIC("MM\0*"), "TIFF", FROM_ITK },
	{ MAGIC("II+\0"), "TIFF", FROM_ITK },
	{ MAGIC("MM\0+"), "TIFF", FROM_ITK },
};

static const struct foreign_magic *find_foreign_magic(const struct gz_file_start *start)
{
	for (size_t i = 0; i < sizeof foreign_magics / sizeof foreign_magics[0]; i++)
		if (gz_file_start_has(start, 0, foreign_magics[i].bytes, foreign_magics[i].size))
			return &foreign_magics[i];
	return NULL;
}

static bool is_compressed_dicom(const struct gz_file_start *start)
{
	return start->coding != GZ_CODING_PLAIN && gz_file_start_has(start, 128, "DICM", 4);
}

static bool foreign_knows_start(const struct gz_file_start *start)
{
	return is_compressed_dicom(start) || find_foreign_magic(start) != NULL;
}

static const char *foreign_name_start(const struct gz_file_start *start)
{
	return is_compressed_dicom(start) ? COMPRESSED_DICOM : find_foreign_magic(start)->name;
}

static enum gz_result refuse_foreign(const struct gz_volume_file *file,
				     struct gz_volume *out_volume)
{
	struct gz_file_start start;
	(void)out_volume;
	/* It may have changed since it was recognised. */
	const bool known = gz_file_start_read(file->path, &start) && foreign_knows_start(&start);
	const char *remedy = !known                        ? FROM_ITK
			     : is_compressed_dicom(&start) ? FROM_COMPRESSED
							   : find_foreign_magic(&start)->remedy;
	gz_err(file->log, "%s: %s is not read; %s", file->path,
	       known ? foreign_name_start(&start) : "it", remedy);
	return GZ_ERR_UNSUPPORTED;
}

const struct gz_volume_format gz_format_foreign = {
	.name = "MINC 1, VTK, TIFF, compressed DICOM",
	.layout = GZ_LAYOUT_IN_FILE,
	.knows_start = foreign_knows_start,
	.name_start = foreign_name_start,
	.load = refuse_foreign,
	.limits = "not read; recognised, so that the message says how to convert them",
};
