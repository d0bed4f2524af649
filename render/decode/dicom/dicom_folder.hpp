/* Which images a path stands for, and of which series. Inside the DICOM reader. */
#ifndef GZ_RENDER_DECODE_DICOM_FOLDER_HPP
#define GZ_RENDER_DECODE_DICOM_FOLDER_HPP

#include <string>
#include <vector>

extern "C" {
#include "base/result.h"
#include "render/data/volume_import.h"
}
#include "render/decode/dicom/dicom_file.hpp"

namespace gz_dicom
{

/* The images at a path. */
struct found_images {
	std::vector<head> heads;
	bool chosen = false;   /* the path or the caller means one series: */
	std::string series;    /* its UID, empty where files lack one */
	bool one_file = false; /* its frames are the slices, whatever its series */
};

/* Find the images of a file's path as gz_dicom_series_open() describes it. `choice`: UID of the
 * series wanted; empty: none. Returns what that function does; logged. */
gz_result find_images(const gz_volume_file &file, const std::string &choice, found_images &out);

/* UIDs of the series among images, by patient, date, number and UID. */
std::vector<std::string> series_among(const std::vector<head> &heads);

/* Keep the images of the series that is meant; if none is, there must be only one.
 * GZ_ERR_NOT_FOUND, GZ_ERR_FORMAT; logged with the series that there are. */
gz_result keep_one_series(const gz_volume_file &file, found_images &images);

} // namespace gz_dicom

#endif
