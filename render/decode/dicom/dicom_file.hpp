/* What the head of one DICOM file tells of its images, and where their pixels lie. Inside the DICOM
 * reader; not for users of render/. */
#ifndef GZ_RENDER_DECODE_DICOM_FILE_HPP
#define GZ_RENDER_DECODE_DICOM_FILE_HPP

#include <cmath>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include <gdcmTransferSyntax.h>

#include "render/decode/dicom/dicom_colour.hpp"

namespace gz_dicom
{

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

/* Bytes of a file. */
struct span {
	uint64_t offset, length;
};

/* What every slice must agree in. */
struct format {
	int columns = 0, rows = 0;             /* of a slice */
	int frame_columns = 0, frame_rows = 0; /* of a frame, which may be a mosaic of slices */
	int bits_allocated = 0, bits_stored = 0, high_bit = 0;
	bool is_signed = false;
	int samples = 1; /* numbers of a pixel */
	colour_kind colours = colour_kind::none;
	double spacing[2] = { 1, 1 }; /* between columns, between rows */
	bool spaced = false;          /* spacing is told */
	double thickness = 0;         /* or spacing between slices, if told */
	double between = 0;           /* spacing between slices, if told */

	bool operator==(const format &other) const
	{
		return columns == other.columns && rows == other.rows &&
		       bits_allocated == other.bits_allocated && bits_stored == other.bits_stored &&
		       high_bit == other.high_bit && is_signed == other.is_signed &&
		       samples == other.samples && colours == other.colours &&
		       std::fabs(spacing[0] - other.spacing[0]) < 1e-4 * spacing[0] &&
		       std::fabs(spacing[1] - other.spacing[1]) < 1e-4 * spacing[1];
	}

	uint64_t frame_pixels() const
	{
		return (uint64_t)frame_columns * (uint64_t)frame_rows;
	}

	/* Of a frame in memory, where a single bit has a byte. */
	uint64_t frame_bytes() const
	{
		return frame_pixels() * (uint64_t)samples * (uint64_t)((bits_allocated + 7) / 8);
	}

	/* Of so many frames in the file, where single bits follow each other (PS3.5, 8.1.1). */
	uint64_t stored_bytes(uint64_t frames) const
	{
		return bits_allocated == 1 ? (frames * frame_pixels() + 7) / 8
					   : frames * frame_bytes();
	}
};

/* The pixels of one file. */
struct pixels_of_file {
	std::string path;
	format numbers;
	gdcm::TransferSyntax::TSType coding = gdcm::TransferSyntax::TS_END;
	bool encapsulated = false;
	bool deflated = false;   /* the whole file is: it is read as a whole */
	bool swap_bytes = false; /* of plain pixels */
	bool planar = false;     /* plain pixels of colours are in three planes */
	bool halved = false;     /* plain pixels have half the colours: YBR_FULL_422 */
	palette table;           /* of an image that needs one */
	span plain {};           /* all frames, one after the other */
	std::vector<std::vector<span>> frames; /* fragments of each, if encapsulated */
};

/* What tells when an image was taken, the most certain first. */
enum time_key {
	TIME_POSITION,    /* Temporal Position Identifier, or Index of an enhanced image */
	TIME_ACQUISITION, /* Acquisition Number */
	TIME_TRIGGER,     /* Trigger Time */
	TIME_CONTENT,     /* Content Time */
	TIME_ACQUIRED,    /* Acquisition Time */
	TIME_KEYS,
};

/* A frame of a segmentation, and the number of its segment. */
struct segment_frame {
	uint32_t frame;
	int number;
};

struct segmentation;

/* Where one slice lies and how its numbers read. */
struct slice {
	std::shared_ptr<const pixels_of_file> pixels;
	uint32_t frame = 0;
	int first_column = 0, first_row = 0; /* in the frame */
	int number = 0;                      /* of the instance, then of the frame */
	bool placed = false;
	vector3 position {}, row {}, column {};
	double along = 0; /* the stack */
	double slope = 1, intercept = 0;
	double when[TIME_KEYS] = {};      /* not a number: not told */
	std::vector<segment_frame> parts; /* that make it, in a segmentation */

	const std::string &path() const
	{
		return pixels->path;
	}
};

/* Frames of one file. Chosen: a hundred time points or segments of a hundred slices, and more. */
const uint64_t frames_max = 262144;

/* Why a file gives no images. */
enum class head_fault {
	none,
	no_image, /* a DICOMDIR, a report, or no DICOM at all */
	closed,   /* it cannot be read */
	damaged,  /* or cut off, though it may begin like DICOM */
	of_floats /* its pixels are floating-point numbers (PS3.3, C.7.6.24) */
};

/* The fault in words, for a message. */
std::string text_of_fault(head_fault fault);

/* One file's head. */
struct head {
	std::string path, series_uid, image_uid;          /* as in the file */
	std::string patient, date, description, modality; /* UTF-8 */
	int series_number = 0;
	format numbers;
	std::string photometric;
	std::vector<slice> slices;
	std::shared_ptr<const segmentation> segments; /* if it is a segmentation */
	uint64_t frames = 0;                          /* claimed */
	uint64_t bytes = 0;                           /* that its pixel data can hold */
	bool of_one_size = true;                      /* the pixels of all its frames */
	head_fault fault = head_fault::none;
};

/* Read the head of a file; false if it gives no images, with the fault. A file that claims more
 * frames than frames_max gives one more than that. */
bool read_head(const std::string &name, head &out);

/* Let the library keep its messages for itself. */
void silence_library();

} // namespace gz_dicom

#endif
