/* The lengths that a DICOM file claims, before memory is taken for them. Inside the DICOM reader.
 */
#ifndef GZ_RENDER_DECODE_DICOM_LENGTHS_HPP
#define GZ_RENDER_DECODE_DICOM_LENGTHS_HPP

#include <cstdint>
#include <istream>

namespace gz_dicom
{

/* A length that an element does not tell (PS3.5, 7.1.1). */
inline const uint32_t undefined_length = 0xffffffff;

/* Whether no element up to the pixels claims more bytes than the file, or the sequence that it lies
 * in, has left, and sequences are no deeper within each other than 128: the library takes memory
 * for what an element claims. Where the file is not as the standard says otherwise, the library may
 * know better, and the answer is true. Leaves the stream anywhere. */
bool lengths_fit(std::istream &file, uint64_t file_size);

} // namespace gz_dicom

#endif
