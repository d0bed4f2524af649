/* Single elements of a data set. Inside the DICOM reader. */
#ifndef GZ_RENDER_DECODE_DICOM_ELEMENTS_HPP
#define GZ_RENDER_DECODE_DICOM_ELEMENTS_HPP

#include <cstddef>
#include <string>

#include <gdcmDataSet.h>
#include <gdcmSequenceOfItems.h>
#include <gdcmTag.h>

namespace gz_dicom
{

inline const gdcm::Tag pixel_data(0x7fe0, 0x0010);
/* The functional groups of all frames together, and of each (PS3.3, C.7.6.16). */
inline const gdcm::Tag shared_groups(0x5200, 0x9229), frame_groups(0x5200, 0x9230);

/* The bytes of an element; NULL: it is missing or empty. */
const gdcm::ByteValue *value_of(const gdcm::DataSet &data, const gdcm::Tag &tag);

/* A text without the blanks and NULs at its end. */
std::string text_of(const gdcm::DataSet &data, const gdcm::Tag &tag);

/* The first `count` numbers of a text such as "1\2.5" (PS3.5, 6.2: DS and IS). */
bool numbers_in(const std::string &text, double *out, int count);
bool numbers_of(const gdcm::DataSet &data, const gdcm::Tag &tag, double *out, int count);

/* A number of 16 bits; the library has turned it into the host's byte order. */
int short_of(const gdcm::DataSet &data, const gdcm::Tag &tag, int otherwise);

/* A whole number written as text. */
int decimal_of(const gdcm::DataSet &data, const gdcm::Tag &tag, int otherwise);

using items = gdcm::SmartPointer<gdcm::SequenceOfItems>;

/* The items of a sequence; NULL: there is none. */
items sequence_of(const gdcm::DataSet &data, const gdcm::Tag &tag);

/* An item of it, counted from 0; NULL: there is none. */
const gdcm::DataSet *item_of(const items &sequence, size_t index);

} // namespace gz_dicom

#endif
