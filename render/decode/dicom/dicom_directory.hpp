/* A DICOMDIR: which files belong to it. Inside the DICOM reader. */
#ifndef GZ_RENDER_DECODE_DICOM_DIRECTORY_HPP
#define GZ_RENDER_DECODE_DICOM_DIRECTORY_HPP

#include <cstddef>
#include <string>
#include <vector>

namespace gz_dicom
{

/* The files that its records name. */
struct directory {
	std::vector<std::string> files; /* those that are there, each once */
	size_t missing = 0;             /* the others */
	std::string example;            /* one of them */
};

/* Whether a file is a DICOMDIR by its name. */
bool is_directory_file(const std::string &path);

/* Read the records of a DICOMDIR. `folder` is the one it lies in, which the names of its files are
 * relative to; names that lead out of it are no names. False if it is none or is damaged. Throws
 * std::bad_alloc. */
bool read_directory(const std::string &path, const std::string &folder, directory &out);

} // namespace gz_dicom

#endif
