#include "render/decode/dicom/dicom_picture.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace gz_dicom
{

namespace
{

/* Voxels that a pixel is the mean of, along each axis (chosen: more would not be seen). */
const int64_t samples_max = 8;

/* Share of the pixels that may be all black, and all white. */
const double clipped_share = 0.01;

template <typename T> float number_at(const uint8_t *voxels, size_t index)
{
	T number;
	std::memcpy(&number, voxels + index * sizeof number, sizeof number);
	return std::isfinite((float)number) ? (float)number : 0;
}

using reader_of_number = float (*)(const uint8_t *voxels, size_t index);

reader_of_number reader_of(gz_raw_type type)
{
	switch (type) {
	case GZ_RAW_UINT8:
		return number_at<uint8_t>;
	case GZ_RAW_INT8:
		return number_at<int8_t>;
	case GZ_RAW_UINT16:
		return number_at<uint16_t>;
	case GZ_RAW_INT16:
		return number_at<int16_t>;
	case GZ_RAW_UINT32:
		return number_at<uint32_t>;
	case GZ_RAW_INT32:
		return number_at<int32_t>;
	case GZ_RAW_FLOAT32:
		return number_at<float>;
	default:
		return nullptr;
	}
}

/* Columns or rows of voxels that are looked at for one of a picture. */
struct samples {
	int64_t first, step, count;
};

samples samples_of(int pixel, int pixels, int voxels)
{
	const int64_t from = (int64_t)pixel * voxels / pixels;
	const int64_t to = std::max(from + 1, ((int64_t)pixel + 1) * voxels / pixels);
	const int64_t step = (to - from + samples_max - 1) / samples_max;
	return { from, step, (to - from + step - 1) / step };
}

/* Pixels of an edge that is this share of the longest one. */
int edge_of(double share)
{
	return std::max(1, (int)std::lround(share * GZ_DECODE_PICTURE_EDGE));
}

/* The mean of the numbers of a voxel: of colours, how light it is. */
double lightness_at(const uint8_t *voxels, reader_of_number number, int channels, int64_t voxel)
{
	double sum = 0;
	for (int i = 0; i < channels; i++)
		sum += number(voxels, (size_t)(voxel * channels + i));
	return sum / channels;
}

std::vector<float> shrink(const gz_dicom_geometry &geometry, const uint8_t *voxels,
			  reader_of_number number, const int size[2])
{
	std::vector<float> means;
	means.reserve((size_t)size[0] * (size_t)size[1]);
	for (int y = 0; y < size[1]; y++) {
		const samples rows = samples_of(y, size[1], geometry.dims[1]);
		for (int x = 0; x < size[0]; x++) {
			const samples columns = samples_of(x, size[0], geometry.dims[0]);
			double sum = 0;
			for (int64_t k = 0; k < rows.count; k++)
				for (int64_t i = 0; i < columns.count; i++)
					sum += lightness_at(
						voxels, number, geometry.channels,
						(rows.first + k * rows.step) * geometry.dims[0] +
							columns.first + i * columns.step);
			means.push_back((float)(sum / (double)(rows.count * columns.count)));
		}
	}
	return means;
}

} // namespace

bool make_picture(const gz_dicom_geometry &geometry, const std::vector<uint8_t> &voxels,
		  uint8_t out[GZ_DECODE_PICTURE_EDGE * GZ_DECODE_PICTURE_EDGE])
{
	const int edge = GZ_DECODE_PICTURE_EDGE;
	const size_t count = (size_t)geometry.dims[0] * (size_t)geometry.dims[1];
	const reader_of_number number = reader_of(geometry.type);
	if (!number ||
	    voxels.size() < count * (size_t)geometry.channels * gz_raw_type_size(geometry.type))
		return false;
	const double width = geometry.dims[0] * geometry.spacing[0];
	const double height = geometry.dims[1] * geometry.spacing[1];
	const int size[2] = { edge_of(width / std::max(width, height)),
			      edge_of(height / std::max(width, height)) };
	const std::vector<float> means = shrink(geometry, voxels.data(), number, size);
	std::vector<float> sorted = means;
	std::sort(sorted.begin(), sorted.end());
	const auto clipped = (size_t)(clipped_share * (double)sorted.size());
	const double black = sorted[clipped], white = sorted[sorted.size() - 1 - clipped];
	std::memset(out, 0, (size_t)edge * (size_t)edge);
	const int left = (edge - size[0]) / 2, top = (edge - size[1]) / 2;
	auto mean = means.begin();
	for (int y = 0; y < size[1]; y++)
		for (int x = 0; x < size[0]; x++, ++mean) {
			const double share = white > black ? (*mean - black) / (white - black) : 0;
			out[(top + y) * edge + left + x] =
				(uint8_t)std::lround(255 * std::min(1.0, std::max(0.0, share)));
		}
	return true;
}

} // namespace gz_dicom
