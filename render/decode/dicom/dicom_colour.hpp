/* Colours of DICOM images: what the numbers of a pixel are, and how they become red, green and
 * blue. Inside the DICOM reader. */
#ifndef GZ_RENDER_DECODE_DICOM_COLOUR_HPP
#define GZ_RENDER_DECODE_DICOM_COLOUR_HPP

#include <cstdint>
#include <string>
#include <vector>

#include <gdcmDataSet.h>

namespace gz_dicom
{

struct pixels_of_file;

/* What the numbers of a pixel are (PS3.3, C.7.6.3.1.2). */
enum class colour_kind {
	none,    /* a value */
	rgb,     /* red, green and blue, once they are decoded */
	ybr,     /* luminance and two colour differences of full range */
	palette, /* a place in a table of colours */
	other,   /* what is not read */
};

/* The kind by the text of the element Photometric Interpretation. */
colour_kind colour_kind_of(const std::string &photometric);

/* Red, green and blue for each stored value from `first` on; values outside take the first or the
 * last. Empty: there is none. */
struct palette {
	int first = 0;
	std::vector<uint8_t> rgb;
};

/* The table of an image whose stored values have a sign or not; empty if it has none, or one that
 * is damaged or segmented. */
palette palette_of(const gdcm::DataSet &data, bool is_signed);

/* Turn a decoded frame into red, green and blue, 8 bits each, pixel by pixel. `planar`: its numbers
 * are three planes one after the other. */
std::vector<uint8_t> colours_of(const pixels_of_file &pixels, const std::vector<uint8_t> &stored,
				bool planar);

} // namespace gz_dicom

#endif
