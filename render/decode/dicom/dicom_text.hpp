/* Texts of a DICOM file as UTF-8. Inside the DICOM reader. */
#ifndef GZ_RENDER_DECODE_DICOM_TEXT_HPP
#define GZ_RENDER_DECODE_DICOM_TEXT_HPP

#include <string>

namespace gz_dicom
{

/* Open the converters. The C library keeps them in files, so a process calls it before it is
 * confined; in others it is not needed. A converter that is missing makes '?'. Not while other
 * threads use utf8_of(). */
void prepare_texts();

/* What a text is: in names a new part begins in the first character set again. */
enum class text_kind { plain, name };

/* A text as UTF-8 without control characters. `charset` is the value of Specific Character Set
 * (0008,0005); without one, the text may be ASCII or UTF-8. Bytes that mean nothing become '?'.
 * Threads: one. */
std::string utf8_of(const std::string &text, const std::string &charset, text_kind kind);

/* At most `size` bytes of UTF-8, with no character cut. */
std::string cut_utf8(const std::string &text, size_t size);

} // namespace gz_dicom

#endif
