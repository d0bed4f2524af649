#include "render/data/dicom_head.hpp"

#include <sys/stat.h>

#include "render/data/volume.h"

namespace gz_dicom
{

namespace
{

/* Best ratio of what is decoded here. Chosen: an empty picture in JPEG-LS takes one bit for a run
 * of up to 32768 pixels, but the head of its file is longer than the rest by then. */
const uint64_t compression_ratio = 4096;

bool numbers_of(DcmItem &item, const DcmTagKey &tag, double *out, unsigned long count)
{
	for (unsigned long i = 0; i < count; i++) {
		Float64 value = 0;
		if (item.findAndGetFloat64(tag, value, i).bad() || !std::isfinite(value))
			return false;
		out[i] = value;
	}
	return true;
}

int number_of(DcmItem &item, const DcmTagKey &tag, int otherwise)
{
	Uint16 value = 0;
	return item.findAndGetUint16(tag, value).good() ? value : otherwise;
}

int decimal_of(DcmItem &item, const DcmTagKey &tag, int otherwise)
{
	Sint32 value = 0;
	return item.findAndGetSint32(tag, value).good() ? (int)value : otherwise;
}

std::string text_of(DcmItem &item, const DcmTagKey &tag)
{
	OFString value;
	return item.findAndGetOFString(tag, value).good() ? std::string(value.c_str()) : "";
}

/* A functional group of a frame: its own, else the shared one; NULL if there is none (PS3.3,
 * C.7.6.16). */
DcmItem *group_of(DcmDataset &data, Uint32 frame, const DcmTagKey &tag)
{
	DcmItem *outer = nullptr, *group = nullptr;
	if (data.findAndGetSequenceItem(DCM_PerFrameFunctionalGroupsSequence, outer,
					(signed long)frame)
		    .good() &&
	    outer->findAndGetSequenceItem(tag, group, 0).good())
		return group;
	if (data.findAndGetSequenceItem(DCM_SharedFunctionalGroupsSequence, outer, 0).good() &&
	    outer->findAndGetSequenceItem(tag, group, 0).good())
		return group;
	return nullptr;
}

/* The item that holds @p tag for a frame: the functional group, else the data set itself. */
DcmItem &holder_of(DcmDataset &data, Uint32 frame, const DcmTagKey &group)
{
	DcmItem *item = group_of(data, frame, group);
	return item ? *item : data;
}

slice slice_of(DcmDataset &data, const std::string &path, Uint32 frame)
{
	slice s;
	double directions[6];
	s.path = path;
	s.frame = frame;
	s.number = decimal_of(data, DCM_InstanceNumber, 0);
	s.placed = numbers_of(holder_of(data, frame, DCM_PlanePositionSequence),
			      DCM_ImagePositionPatient, s.position.x, 3) &&
		   numbers_of(holder_of(data, frame, DCM_PlaneOrientationSequence),
			      DCM_ImageOrientationPatient, directions, 6);
	if (s.placed)
		for (int i = 0; i < 3; i++) {
			s.row.x[i] = directions[i];
			s.column.x[i] = directions[3 + i];
		}
	DcmItem &scale = holder_of(data, frame, DCM_PixelValueTransformationSequence);
	double slope, intercept;
	if (numbers_of(scale, DCM_RescaleSlope, &slope, 1) && slope != 0)
		s.slope = slope;
	if (numbers_of(scale, DCM_RescaleIntercept, &intercept, 1))
		s.intercept = intercept;
	return s;
}

/* The file's size, times what a compression may win. */
uint64_t bound_of(DcmDataset &data, const std::string &path)
{
	struct stat status;
	if (stat(path.c_str(), &status) != 0)
		return 0;
	const bool compressed = DcmXfer(data.getOriginalXfer()).isEncapsulated();
	return (uint64_t)status.st_size * (compressed ? compression_ratio : 1);
}

} // namespace

format format_of(DcmDataset &data)
{
	format f;
	double rows_columns[2], thickness;
	f.columns = number_of(data, DCM_Columns, 0);
	f.rows = number_of(data, DCM_Rows, 0);
	f.bits_allocated = number_of(data, DCM_BitsAllocated, 0);
	f.bits_stored = number_of(data, DCM_BitsStored, f.bits_allocated);
	f.high_bit = number_of(data, DCM_HighBit, f.bits_stored - 1);
	f.is_signed = number_of(data, DCM_PixelRepresentation, 0) == 1;
	DcmItem &measures = holder_of(data, 0, DCM_PixelMeasuresSequence);
	/* Between rows comes first (PS3.3, 10.7.1.3). */
	if (numbers_of(measures, DCM_PixelSpacing, rows_columns, 2)) {
		f.spacing[0] = rows_columns[1];
		f.spacing[1] = rows_columns[0];
	}
	if (numbers_of(measures, DCM_SpacingBetweenSlices, &thickness, 1) ||
	    numbers_of(measures, DCM_SliceThickness, &thickness, 1))
		f.thickness = std::fabs(thickness);
	return f;
}

bool read_head(const std::string &name, head &out)
{
	struct stat status;
	if (stat(name.c_str(), &status) != 0 || !S_ISREG(status.st_mode))
		return false;
	DcmFileFormat dicom;
	if (dicom.loadFile(name.c_str(), EXS_Unknown, EGL_noChange, head_element_max, ERM_fileOnly)
		    .bad()) {
		out.unreadable = true;
		return false;
	}
	DcmDataset &data = *dicom.getDataset();
	if (!data.tagExists(DCM_PixelData))
		return false; /* a DICOMDIR, a report */
	out.path = name;
	out.series_uid = text_of(data, DCM_SeriesInstanceUID);
	out.description = text_of(data, DCM_SeriesDescription);
	out.numbers = format_of(data);
	out.bytes = bound_of(data, name);
	const int samples = number_of(data, DCM_SamplesPerPixel, 1);
	if (samples != 1)
		out.numbers.bits_allocated = -samples; /* told by check_head() */
	const int claimed = decimal_of(data, DCM_NumberOfFrames, 1);
	out.frames = claimed < 1 ? 1 : (uint64_t)claimed;
	/* check_head() tells where a file claims more than it can hold. */
	for (uint64_t frame = 0; frame < out.frames && frame <= GZ_VOLUME_DIM_MAX; frame++)
		out.slices.push_back(slice_of(data, name, (Uint32)frame));
	return true;
}

} // namespace gz_dicom
