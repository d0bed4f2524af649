/* Series over time: several images at each place. Inside the DICOM reader. */
#ifndef GZ_RENDER_DECODE_DICOM_TIME_HPP
#define GZ_RENDER_DECODE_DICOM_TIME_HPP

#include <cstddef>
#include <vector>

#include "render/decode/dicom/dicom_file.hpp"

namespace gz_dicom
{

/* What order_in_time() found. */
struct time_order {
	size_t points = 1;        /* images at each place that are kept */
	const char *by = nullptr; /* what tells their order, for people; NULL: one image a place */
	size_t left_out = 0;      /* images */
	std::vector<double> incomplete; /* temporal positions that some places lack */
};

/*
 * Order the images of one stack, which are sorted by where they lie: all places of the first time
 * point, then all of the second. Every place keeps as many images as the one with the fewest has.
 *
 * The order at a place is that of the first of these that all images have and no two images of one
 * place share: temporal position, acquisition number, trigger time, content time, acquisition time;
 * otherwise that of their instance numbers.
 */
time_order order_in_time(std::vector<slice> &slices);

} // namespace gz_dicom

#endif
