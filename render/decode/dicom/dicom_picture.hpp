/* A slice as a small picture. Inside the DICOM reader. */
#ifndef GZ_RENDER_DECODE_DICOM_PICTURE_HPP
#define GZ_RENDER_DECODE_DICOM_PICTURE_HPP

#include <cstdint>
#include <vector>

#include "render/decode/decode_protocol.h"
#include "render/decode/dicom/dicom_series.h"

namespace gz_dicom
{

/* Make a picture of the voxels of a slice: as large as it can be in its proportions, in the middle,
 * and from black to white as its own values go, but for the darkest and brightest hundredth. False
 * if there is none, since the voxels are no numbers. */
bool make_picture(const gz_dicom_geometry &geometry, const std::vector<uint8_t> &voxels,
		  uint8_t out[GZ_DECODE_PICTURE_EDGE * GZ_DECODE_PICTURE_EDGE]);

} // namespace gz_dicom

#endif
