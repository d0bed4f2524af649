/* The pixels of one frame. Inside the DICOM reader. */
#ifndef GZ_RENDER_DECODE_DICOM_FRAME_HPP
#define GZ_RENDER_DECODE_DICOM_FRAME_HPP

#include <cstdint>
#include <string>
#include <vector>

#include "base/result.h"
#include "render/decode/dicom/dicom_file.hpp"

namespace gz_dicom
{

/* Decode a frame as it is stored: frame_bytes() of it, in host byte order; of colours, three bytes
 * a pixel. On failure `why` is a line for the log. GZ_ERR_IO, GZ_ERR_FORMAT, GZ_ERR_UNSUPPORTED.
 * Threads: any. */
gz_result decode_frame(const pixels_of_file &pixels, uint32_t frame, std::vector<uint8_t> &out,
		       std::string &why);

} // namespace gz_dicom

#endif
