/* Dose (PS3.3, C.8.8.3): where its frames lie and what its numbers mean. Inside the DICOM reader.
 */
#ifndef GZ_RENDER_DECODE_DICOM_DOSE_HPP
#define GZ_RENDER_DECODE_DICOM_DOSE_HPP

#include <gdcmDataSet.h>

#include "render/decode/dicom/dicom_file.hpp"

namespace gz_dicom
{

/* If the data set has dose, give its slices their places by the Grid Frame Offset Vector and their
 * scale by the Dose Grid Scaling. Frames without offsets have no place. */
void place_dose(const gdcm::DataSet &data, head &image);

} // namespace gz_dicom

#endif
