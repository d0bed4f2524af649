/* Segmentations (PS3.3, C.8.20.2): frames of one segment each become slices of labels. Inside the
 * DICOM reader. */
#ifndef GZ_RENDER_DECODE_DICOM_SEGMENTS_HPP
#define GZ_RENDER_DECODE_DICOM_SEGMENTS_HPP

#include <cstdint>
#include <string>
#include <vector>

#include <gdcmDataSet.h>

extern "C" {
#include "base/log.h"
#include "base/result.h"
}
#include "render/decode/dicom/dicom_file.hpp"

namespace gz_dicom
{

/* One segment: what its voxels are. */
struct segment {
	int number = 0;
	std::string label;
	bool coloured = false;
	int rgb[3] = {}; /* 0 to 255, of the recommended CIELab value */
};

/* What a file of segments says. */
struct segmentation {
	bool fractional = false;
	int full = 1;              /* what a fraction of 1 is stored as */
	std::vector<segment> all;  /* in the order of the file */
	std::vector<int> of_frame; /* number of the segment of each frame; 0: not told */

	int greatest_number() const;
};

/* If the data set is a segmentation whose frames are those of single segments, note what it says in
 * `image`. Its slices must be there. */
void take_segments(const gdcm::DataSet &data, head &image);

/* Replace the frames of a segmentation by slices at even distances from the first to the last; a
 * slice has no part where frames were left out because they are empty. Logs names and colours.
 * GZ_ERR_FORMAT, GZ_ERR_UNSUPPORTED: logged with the reason. */
gz_result stack_segments(head &image, const gz_log *log);

/* Put a frame of a segment into a slice of labels, which begins as zeros. `fractions` is a scratch
 * of as many numbers, zeros at first, used if the segmentation is fractional. Where several
 * segments lie, the greatest fraction wins, else the later frame.
 * @return whether a voxel had another segment before */
bool put_segment(const segmentation &of, int number, const std::vector<uint8_t> &frame,
		 std::vector<uint16_t> &labels, std::vector<uint8_t> &fractions);

} // namespace gz_dicom

#endif
