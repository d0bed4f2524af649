/* How the slices of a series lie: what is wrong with that is said, and resampled on request. Inside
 * the DICOM reader. */
#ifndef GZ_RENDER_DECODE_DICOM_SPACING_HPP
#define GZ_RENDER_DECODE_DICOM_SPACING_HPP

#include <cstdint>
#include <functional>
#include <vector>

extern "C" {
#include "base/result.h"
#include "render/data/volume_import.h"
}
#include "render/decode/dicom/dicom_file.hpp"
#include "render/decode/dicom/slice_grid.h"

namespace gz_dicom
{

/* A grid that frees itself. */
class even_grid
{
      public:
	even_grid() = default;
	~even_grid();
	even_grid(even_grid &&other) noexcept;
	even_grid(const even_grid &) = delete;
	even_grid &operator=(const even_grid &) = delete;
	even_grid &operator=(even_grid &&) = delete;

	/* Whether slices are resampled. */
	explicit operator bool() const
	{
		return grid.count > 0;
	}

	gz_slice_grid grid {};
};

/* Slices that say where they lie. */
struct placed_stack {
	/* In order along the stack, of all time points, one behind the other. */
	const std::vector<slice> &slices;
	size_t count; /* of one time point: 2 or more */
	const format &numbers;
	int channels; /* numbers of a voxel */
};

/* Look at a stack. What is wrong with it is logged. GZ_OK: `out_spacing_mm` is the distance of
 * slices, and if `file` asks for resampling and the stack needs it, `out` is the grid.
 * GZ_ERR_FORMAT: slices are missing or lie unevenly, and the file does not ask for resampling; or
 * the grid would be too large. GZ_ERR_NO_MEM. */
gz_result measure_stack(const placed_stack &stack, const gz_volume_file &file, even_grid &out,
			double &out_spacing_mm);

/* The slices of a stack resampled onto a grid, in order, one time point behind the other. Two of
 * them are kept. */
class resampler
{
      public:
	/* Gives a slice of all time points: columns * rows voxels. Any first; then the one behind
	 * that of the call before. */
	using source = std::function<gz_result(size_t index, void *voxels)>;

	resampler(const gz_slice_grid &onto, gz_raw_type number_type, double fill_with,
		  source from);

	/* A slice of the grid, counted through all time points: dims[0] * dims[1] voxels. Any
	 * first; then the one behind that of the call before. */
	gz_result read(uint64_t index, void *voxels);

      private:
	gz_result advance_to(size_t first, size_t last);

	const gz_slice_grid &grid;
	const gz_raw_type type;
	const double fill;
	const source give_slice;
	std::vector<uint8_t> given;
	std::vector<double> planes[2]; /* slice i of all time points is in i % 2 */
	size_t next = 0;               /* slice to lay */
	bool begun = false;
};

} // namespace gz_dicom

#endif
