/* A series as a stack of slices, from the heads of its files. Inside the DICOM reader. */
#ifndef GZ_RENDER_DECODE_DICOM_STACK_HPP
#define GZ_RENDER_DECODE_DICOM_STACK_HPP

#include <memory>
#include <vector>

extern "C" {
#include "base/log.h"
#include "base/result.h"
}
#include "render/decode/dicom/dicom_file.hpp"
#include "render/decode/dicom/dicom_pool.hpp"
#include "render/decode/dicom/dicom_series.h"

namespace gz_dicom
{

struct close_stack {
	void operator()(gz_dicom_series *series) const
	{
		gz_dicom_series_close(&series);
	}
};

using stack = std::unique_ptr<gz_dicom_series, close_stack>;

/* Put the slices of images in order. What is wrong with them goes to `log`, which outlives the
 * stack. Returns as gz_dicom_series_open(). Throws. */
gz_result open_stack(const gz_volume_file &file, std::vector<head> images, const gz_log *log,
		     stack &out);

/* As gz_dicom_series_geometry(), but with the columns, rows and slices that the files have: those
 * before slices are resampled. */
gz_dicom_geometry geometry_of_files(const gz_dicom_series &of);

/* Decode one slice of the files, counted from the bottom: voxels of geometry_of_files(). Throws.
 * Threads: any. */
decoded_slice decode_of_stack(const gz_dicom_series &of, size_t index);

/* Log the exception that is being caught. Returns GZ_ERR_NO_MEM or GZ_ERR_FORMAT. */
gz_result explain_exception(const gz_volume_file &file);

/* Run `work`, which returns enum gz_result, and log what it throws. */
template <typename F> gz_result without_throwing(const gz_volume_file &file, F work)
{
	try {
		silence_library();
		return work();
	} catch (...) {
		return explain_exception(file);
	}
}

} // namespace gz_dicom

#endif
