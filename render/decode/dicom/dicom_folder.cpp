#include "render/decode/dicom/dicom_folder.hpp"

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <dirent.h>
#include <map>
#include <memory>
#include <set>
#include <sys/stat.h>
#include <tuple>
#include <utility>

#include "render/data/dicom_name.h"
#include "render/decode/dicom/dicom_directory.hpp"

#define GZ_LOG_MODULE "dicom"

namespace gz_dicom
{

namespace
{

/* Files of a folder that are looked at. Chosen: a long perfusion study has some ten thousand. */
const size_t files_max = 65536;

/* Folders within folders that are looked into (chosen: a DICOM medium has four levels). */
const int depth_max = 8;

/* Series of a folder that are listed one by one. */
const size_t listed_max = 40;

class collector
{
      public:
	collector(const gz_volume_file &of, found_images &to)
	    : file(of), path(of.path), log(of.log), out(to)
	{
	}
	gz_result collect(const std::string &choice);

      private:
	gz_result collect_file(const std::string &choice);
	gz_result collect_directory(const std::string &folder);
	gz_result collect_folder(const std::string &folder);
	gz_result collect_tree(const std::string &folder, int depth);
	gz_result collect_where_images_are(const std::string &folder);
	bool look_at(const std::string &name);
	void note_left_out() const;

	const gz_volume_file &file;
	const std::string path;
	const gz_log *log;
	found_images &out;
	/* Files that give no images, though they may be of the series. */
	struct left_out {
		size_t count = 0;
		std::string example; /* one of them */
	};

	size_t seen = 0; /* files that were looked at */
	std::map<head_fault, left_out> faulty;
	std::set<std::pair<dev_t, ino_t>> entered; /* folders, to which links may lead back */
};

gz_result collector::collect(const std::string &choice)
{
	struct stat status;
	if (stat(path.c_str(), &status) != 0) {
		gz_err(log, "%s: cannot open it: %s; check its name and permissions", path.c_str(),
		       strerror(errno));
		return GZ_ERR_NOT_FOUND;
	}
	out.chosen = !choice.empty();
	out.series = choice;
	const gz_result r =
		S_ISDIR(status.st_mode) ? collect_where_images_are(path) : collect_file(choice);
	if (r != GZ_OK)
		return r;
	note_left_out();
	if (!out.heads.empty())
		return GZ_OK;
	gz_err(log, "%s: no DICOM image in this folder; name another", path.c_str());
	return GZ_ERR_FORMAT;
}

/* A file stands for the others of its series in its folder, a DICOMDIR for what its records name.
 * One with several slices stands for itself. */
gz_result collector::collect_file(const std::string &choice)
{
	const size_t slash = path.rfind('/');
	const std::string folder = slash == std::string::npos ? "."
				   : slash == 0               ? "/"
							      : path.substr(0, slash);
	if (is_directory_file(path))
		return collect_directory(folder);
	head h;
	if (!read_head(path, h)) {
		gz_err(log, "%s: %s", path.c_str(), text_of_fault(h.fault).c_str());
		return GZ_ERR_FORMAT;
	}
	if (h.slices.size() > 1) {
		out.one_file = true;
		out.heads.push_back(h);
		return GZ_OK;
	}
	out.chosen = true;
	out.series = choice.empty() ? h.series_uid : choice;
	return collect_folder(folder);
}

/* The files that the records of a DICOMDIR name; of a damaged one, all in its folder and below. */
gz_result collector::collect_directory(const std::string &folder)
{
	directory records;
	if (!read_directory(path, folder, records) || records.files.empty()) {
		gz_warn(log,
			"%s: its records cannot be read or name no file that is there; all images "
			"in its folder are taken instead",
			path.c_str());
		return collect_tree(folder, 0);
	}
	if (records.missing > 0)
		gz_warn(log,
			"%s: files of its records that are missing: %zu, such as %s; copy the "
			"whole medium",
			path.c_str(), records.missing, records.example.c_str());
	for (const std::string &name : records.files) {
		if (seen++ == files_max)
			break;
		if (!look_at(name))
			return GZ_ERR_CANCELLED;
	}
	return GZ_OK;
}

/* The folder's own images; if it has none, those in its sub-folders. */
gz_result collector::collect_where_images_are(const std::string &folder)
{
	const gz_result r = collect_folder(folder);
	return r == GZ_OK && out.heads.empty() && faulty.empty() ? collect_tree(folder, 0) : r;
}

/* All images in a folder and its sub-folders, each folder once. */
gz_result collector::collect_tree(const std::string &folder, int depth)
{
	struct stat here;
	if (stat(folder.c_str(), &here) != 0 || !entered.emplace(here.st_dev, here.st_ino).second)
		return GZ_OK;
	gz_result r = collect_folder(folder);
	std::unique_ptr<DIR, int (*)(DIR *)> entries(opendir(folder.c_str()), closedir);
	if (depth >= depth_max || !entries)
		return r;
	for (dirent *entry; r == GZ_OK && seen < files_max && (entry = readdir(entries.get()));) {
		const std::string name = folder + "/" + entry->d_name;
		struct stat status;
		if (entry->d_name[0] != '.' && stat(name.c_str(), &status) == 0 &&
		    S_ISDIR(status.st_mode))
			r = collect_tree(name, depth + 1);
	}
	return r;
}

/* Such a file may be a slice at the end of the series, which nobody would miss: it is told. */
void collector::note_left_out() const
{
	for (const auto &kind : faulty)
		gz_warn(log, "%s: %s; left out (such files here: %zu)", kind.second.example.c_str(),
			text_of_fault(kind.first).c_str(), kind.second.count);
}

/* Read one head; false if loading shall stop. */
bool collector::look_at(const std::string &name)
{
	head h;
	if (is_directory_file(name))
		return true;
	if (read_head(name, h))
		out.heads.push_back(std::move(h));
	else if (h.fault != head_fault::no_image && faulty[h.fault].count++ == 0)
		faulty[h.fault].example = name;
	return gz_loading_goes_on(file.loading, 0, path.c_str());
}

gz_result collector::collect_folder(const std::string &folder)
{
	std::unique_ptr<DIR, int (*)(DIR *)> entries(opendir(folder.c_str()), closedir);
	if (!entries) {
		gz_err(log, "%s: cannot read the folder: %s; check its permissions", folder.c_str(),
		       strerror(errno));
		return GZ_ERR_IO;
	}
	for (dirent *entry; seen < files_max && (entry = readdir(entries.get()));) {
		if (entry->d_name[0] == '.')
			continue;
		seen++;
		if (!look_at(folder + "/" + entry->d_name))
			return GZ_ERR_CANCELLED;
	}
	return GZ_OK;
}

/* The first image of a series, and how many it has. */
struct series_example {
	const head *first = nullptr;
	size_t files = 0;
};

series_example example_of(const std::vector<head> &heads, const std::string &uid)
{
	series_example example;
	for (const head &h : heads)
		if (h.series_uid == uid && example.files++ == 0)
			example.first = &h;
	return example;
}

/* One line a series: what people know it by, and its UID. */
void log_series(const gz_log *log, const found_images &images, const std::vector<std::string> &uids)
{
	for (size_t i = 0; i < uids.size() && i < listed_max; i++) {
		const series_example one = example_of(images.heads, uids[i]);
		gz_info(log, "series %s: %s, %s, %s, %zu files, such as %s", uids[i].c_str(),
			one.first->patient.c_str(), one.first->date.c_str(),
			one.first->description.c_str(), one.files, one.first->path.c_str());
	}
}

std::string names_of_series(const found_images &images, const std::vector<std::string> &uids)
{
	std::string names;
	for (size_t i = 0; i < uids.size() && i < listed_max; i++) {
		const series_example one = example_of(images.heads, uids[i]);
		names += (names.empty() ? "" : ", ") + one.first->path + " (" +
			 one.first->description + ", " + std::to_string(one.files) + ")";
	}
	return names;
}

/* A folder may hold a file twice; its copies are no further time points. */
void leave_out_copies(const gz_volume_file &file, std::vector<head> &heads)
{
	using identity = std::tuple<std::string, int, std::vector<double>>;
	std::set<identity> seen;
	const size_t all = heads.size();
	const auto is_copy = [&](const head &h) {
		const slice &s = h.slices[0];
		std::vector<double> where(s.position.x, s.position.x + 3);
		for (const double when : s.when)
			where.push_back(std::isnan(when) ? -1 : when);
		return !h.image_uid.empty() &&
		       !seen.emplace(h.image_uid, s.number, std::move(where)).second;
	};
	heads.erase(std::remove_if(heads.begin(), heads.end(), is_copy), heads.end());
	if (heads.size() < all)
		gz_info(file.log, "%s: %zu files are copies of others, by their UIDs; left out",
			file.path, all - heads.size());
}

} // namespace

gz_result find_images(const gz_volume_file &file, const std::string &choice, found_images &out)
{
	return collector(file, out).collect(choice);
}

std::vector<std::string> series_among(const std::vector<head> &heads)
{
	using place = std::tuple<std::string, std::string, int, std::string>;
	std::map<std::string, place> first;
	for (const head &h : heads) {
		const place at(h.patient, h.date, h.series_number, h.series_uid);
		const auto found = first.emplace(h.series_uid, at).first;
		found->second = std::min(found->second, at);
	}
	std::vector<place> places;
	places.reserve(first.size());
	for (const auto &series : first)
		places.push_back(series.second);
	std::sort(places.begin(), places.end());
	std::vector<std::string> uids;
	uids.reserve(places.size());
	for (const place &at : places)
		uids.push_back(std::get<3>(at));
	return uids;
}

gz_result keep_one_series(const gz_volume_file &file, found_images &images)
{
	const std::string &wanted = images.series;
	if (images.one_file)
		return GZ_OK;
	const std::vector<std::string> uids = series_among(images.heads);
	if (uids.size() > 1 && !images.chosen) {
		log_series(file.log, images, uids);
		gz_err(file.log,
		       "%s: holds %zu series; name one file of the one wanted, or give its UID as "
		       "volume.series (gazeview --list-series lists them): %s",
		       file.path, uids.size(), names_of_series(images, uids).c_str());
		return GZ_ERR_FORMAT;
	}
	if (images.chosen && std::find(uids.begin(), uids.end(), wanted) == uids.end()) {
		log_series(file.log, images, uids);
		gz_err(file.log, "%s: no series %s here; volume.series can be one of %zu others",
		       file.path, wanted.c_str(), uids.size());
		return GZ_ERR_NOT_FOUND;
	}
	if (images.chosen)
		images.heads.erase(
			std::remove_if(images.heads.begin(), images.heads.end(),
				       [&](const head &h) { return h.series_uid != wanted; }),
			images.heads.end());
	leave_out_copies(file, images.heads);
	return GZ_OK;
}

} // namespace gz_dicom
