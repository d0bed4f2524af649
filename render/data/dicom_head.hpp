/* What the head of one DICOM file tells of its images. Inside the DICOM reader; not for users of
 * render/. */
#ifndef GZ_RENDER_DATA_DICOM_HEAD_HPP
#define GZ_RENDER_DATA_DICOM_HEAD_HPP

#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include <dcmtk/config/osconfig.h>
#include <dcmtk/dcmdata/dctk.h>

namespace gz_dicom
{

/* Longest element kept in memory while heads are read, bytes: pixels are not. */
const Uint32 head_element_max = 4096;

struct vector3 {
	double x[3];
};

inline double dot(const vector3 &a, const vector3 &b)
{
	return a.x[0] * b.x[0] + a.x[1] * b.x[1] + a.x[2] * b.x[2];
}

inline vector3 cross(const vector3 &a, const vector3 &b)
{
	return { { a.x[1] * b.x[2] - a.x[2] * b.x[1], a.x[2] * b.x[0] - a.x[0] * b.x[2],
		   a.x[0] * b.x[1] - a.x[1] * b.x[0] } };
}

/* Where one frame lies and how its numbers read. */
struct slice {
	std::string path;
	Uint32 frame = 0;
	int number = 0; /* of the instance, then of the frame */
	bool placed = false;
	vector3 position {}, row {}, column {};
	double along = 0; /* the stack */
	double slope = 1, intercept = 0;
};

/* What every slice must agree in. */
struct format {
	int columns = 0, rows = 0;
	int bits_allocated = 0, bits_stored = 0, high_bit = 0;
	bool is_signed = false;
	double spacing[2] = { 1, 1 }; /* between columns, between rows */
	double thickness = 0;         /* or spacing between slices, if told */

	bool operator==(const format &other) const
	{
		return columns == other.columns && rows == other.rows &&
		       bits_allocated == other.bits_allocated && bits_stored == other.bits_stored &&
		       high_bit == other.high_bit && is_signed == other.is_signed &&
		       std::fabs(spacing[0] - other.spacing[0]) < 1e-4 * spacing[0] &&
		       std::fabs(spacing[1] - other.spacing[1]) < 1e-4 * spacing[1];
	}
};

/* One file's head. */
struct head {
	std::string path, series_uid, description;
	format numbers;
	std::vector<slice> slices;
	uint64_t frames = 0;     /* claimed */
	uint64_t bytes = 0;      /* that its pixel data can hold */
	bool unreadable = false; /* not to be parsed: damaged, cut off, or no DICOM at all */
};

/* What every slice of the data set's file agrees in. */
format format_of(DcmDataset &data);

/* Read the head of a file; false if it holds no DICOM image. A file that claims more frames than
 * GZ_VOLUME_DIM_MAX gives one more than that. */
bool read_head(const std::string &name, head &out);

} // namespace gz_dicom

#endif
