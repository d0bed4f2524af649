#include "render/decode/dicom/dicom_directory.hpp"

#include <algorithm>
#include <cctype>
#include <fstream>
#include <set>
#include <strings.h>
#include <sys/stat.h>

#include <gdcmReader.h>

#include "render/decode/dicom/dicom_elements.hpp"
#include "render/decode/dicom/dicom_guard.hpp"
#include "render/decode/dicom/dicom_lengths.hpp"

namespace gz_dicom
{

namespace
{

/* PS3.3, F.3.2.2. */
const gdcm::Tag directory_records(0x0004, 0x1220), record_in_use(0x0004, 0x1410),
	referenced_file(0x0004, 0x1500);

/* Records that are looked at (chosen: those of as many files as are read, and of what they belong
 * to). */
const size_t records_max = 131072;

/* Folders of a medium within each other, and the file (PS3.10, 8.2). */
const size_t components_max = 8;

bool is_file(const std::string &path)
{
	struct stat status;
	return stat(path.c_str(), &status) == 0 && S_ISREG(status.st_mode);
}

/* "A\B\C" as a path below the folder; "" if it is none. */
std::string path_of_record(const std::string &folder, const std::string &id)
{
	std::string path = folder;
	size_t count = 0;
	for (size_t at = 0; at <= id.size(); count++) {
		const size_t end = std::min(id.find('\\', at), id.size());
		std::string part = id.substr(at, end - at);
		part.erase(part.find_last_not_of(' ') + 1);
		if (part.empty() || part == "." || part == ".." ||
		    part.find('/') != std::string::npos || part.find('\0') != std::string::npos)
			return "";
		path += "/" + part;
		at = end + 1;
	}
	return count <= components_max ? path : "";
}

/* The names of a medium have capitals, but systems may show small letters (ISO 9660). */
std::string find_as_written(const std::string &folder, const std::string &path)
{
	std::string small = path;
	std::transform(small.begin() + (std::ptrdiff_t)folder.size(), small.end(),
		       small.begin() + (std::ptrdiff_t)folder.size(),
		       [](unsigned char c) { return (char)std::tolower(c); });
	return is_file(path) || !is_file(small) ? path : small;
}

bool is_record_in_use(const gdcm::DataSet &record)
{
	const gdcm::ByteValue *flag = value_of(record, record_in_use);
	return !flag || flag->GetLength() < 2 || flag->GetPointer()[0] || flag->GetPointer()[1];
}

void add_file_of_record(const gdcm::DataSet &record, const std::string &folder,
			std::set<std::string> &seen, directory &out)
{
	const std::string id = text_of(record, referenced_file);
	if (id.empty() || !is_record_in_use(record))
		return;
	const std::string named = path_of_record(folder, id);
	const std::string path = named.empty() ? "" : find_as_written(folder, named);
	if (!seen.insert(path.empty() ? id : path).second)
		return;
	if (!path.empty() && is_file(path))
		out.files.push_back(path);
	else if (out.missing++ == 0)
		out.example = path.empty() ? id : path;
}

bool read_records(std::istream &file, uint64_t file_size, const std::string &folder, directory &out)
{
	if (!lengths_fit(file, file_size))
		return false;
	file.clear();
	file.seekg(0);
	gdcm::Reader reader;
	reader.SetStream(file);
	if (!guarded_within(most_for_reading(file_size), [&] { return reader.Read(); }))
		return false;
	const items records = sequence_of(reader.GetFile().GetDataSet(), directory_records);
	if (!records)
		return false;
	std::set<std::string> seen;
	for (size_t i = 0; i < records_max; i++) {
		const gdcm::DataSet *record = item_of(records, i);
		if (!record)
			break;
		add_file_of_record(*record, folder, seen, out);
	}
	return true;
}

} // namespace

bool is_directory_file(const std::string &path)
{
	const size_t slash = path.rfind('/');
	return strcasecmp(path.c_str() + (slash == std::string::npos ? 0 : slash + 1),
			  "DICOMDIR") == 0;
}

bool read_directory(const std::string &path, const std::string &folder, directory &out)
{
	struct stat status;
	std::ifstream file(path, std::ios::binary);
	if (!file || stat(path.c_str(), &status) != 0)
		return false;
	return guarded([&] { return read_records(file, (uint64_t)status.st_size, folder, out); });
}

} // namespace gz_dicom
