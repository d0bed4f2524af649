/* A list of series: one row each at once, then their pictures. */
#include "render/decode/dicom/dicom_list.h"

#include <algorithm>
#include <cctype>
#include <cstring>
#include <map>
#include <memory>
#include <new>
#include <string>
#include <vector>

#include "render/decode/dicom/dicom_folder.hpp"
#include "render/decode/dicom/dicom_picture.hpp"
#include "render/decode/dicom/dicom_stack.hpp"
#include "render/decode/dicom/dicom_text.hpp"

#define GZ_LOG_MODULE "dicom"

namespace
{

using namespace gz_dicom;

/* Characters of a UID (PS3.5, 9). */
const size_t uid_max = 64;

/* A log that keeps the first error and nothing else. */
class first_error
{
      public:
	first_error()
	{
		gz_log_init(&log, keep, this, "*:error");
	}
	first_error(const first_error &) = delete;
	first_error &operator=(const first_error &) = delete;

	gz_log log {};
	std::string text;

      private:
	static void keep(void *user, gz_log_level level, const char *module, const char *message)
	{
		auto *self = static_cast<first_error *>(user);
		(void)module;
		if (level == GZ_LOG_ERROR && self->text.empty())
			self->text = message;
	}
};

/* A message about a file of the series without the name of that file. */
std::string without_path(const std::string &message, const std::vector<std::string> &paths)
{
	for (const std::string &path : paths)
		if (message.compare(0, path.size(), path) == 0 &&
		    message.compare(path.size(), 2, ": ") == 0)
			return message.substr(path.size() + 2);
	return message;
}

template <size_t size> void put_text(char (&field)[size], const std::string &text)
{
	const std::string cut = cut_utf8(text, size - 1);
	std::memcpy(field, cut.c_str(), cut.size() + 1);
}

/* "DOE^JOHN=..." as people write it: the first spelling, parts apart (PS3.5, 6.2.1). */
std::string readable_name(const std::string &name)
{
	std::string one;
	for (size_t at = 0; at < name.size() && one.empty(); at = name.find('=', at) + 1) {
		const size_t end = std::min(name.find('=', at), name.size());
		one = name.substr(at, end - at);
		if (end == name.size())
			break;
	}
	std::replace(one.begin(), one.end(), '^', ' ');
	one.erase(std::unique(one.begin(), one.end(),
			      [](char a, char b) { return a == ' ' && b == ' '; }),
		  one.end());
	const size_t last = one.find_last_not_of(' ');
	return last == std::string::npos ? "" : one.substr(0, last + 1);
}

/* "20240331" as "2024-03-31"; else as it is. */
std::string readable_date(const std::string &date)
{
	const bool digits = date.size() == 8 && std::all_of(date.begin(), date.end(), [](char c) {
				    return std::isdigit((unsigned char)c);
			    });
	return digits ? date.substr(0, 4) + "-" + date.substr(4, 2) + "-" + date.substr(6) : date;
}

/* Why a UID cannot choose its series; "": it can. */
std::string fault_of_uid(const std::string &uid)
{
	if (uid.empty())
		return "has no series UID; open one of its files";
	const bool sound = uid.size() <= uid_max && std::all_of(uid.begin(), uid.end(), [](char c) {
				   return std::isgraph((unsigned char)c);
			   });
	return sound ? "" : "has a malformed series UID; open one of its files";
}

/* A series of the list. */
class listed_series
{
      public:
	listed_series(const gz_volume_file &file, std::vector<head> images);
	gz_decode_series row {};
	stack slices; /* none: it cannot be shown */

      private:
	void describe(const head &first);
	std::unique_ptr<first_error> error; /* the log of the slices */
};

void listed_series::describe(const head &first)
{
	put_text(row.uid, first.series_uid);
	put_text(row.patient, readable_name(first.patient));
	put_text(row.date, readable_date(first.date));
	put_text(row.description, first.description);
	put_text(row.modality, first.modality);
	put_text(row.reason, fault_of_uid(first.series_uid));
}

/* What is wrong with its slices is found as if it were loaded. What else would be said of them is
 * said then. */
listed_series::listed_series(const gz_volume_file &file, std::vector<head> images)
    : error(new first_error)
{
	std::vector<std::string> paths = { file.path };
	size_t count = 0;
	describe(images[0]);
	for (const head &h : images) {
		paths.push_back(h.path);
		count += h.slices.size();
	}
	const gz_result result = open_stack(file, std::move(images), &error->log, slices);
	if (result != GZ_OK && !row.reason[0])
		put_text(row.reason, without_path(error->text, paths));
	row.slices = result == GZ_OK ? geometry_of_files(*slices).dims[2]
				     : (int32_t)std::min<size_t>(count, INT32_MAX);
	if (row.reason[0])
		slices.reset();
}

/* The images of each series, in the order of the list. */
std::vector<std::vector<head>> group_images(found_images &images)
{
	if (images.one_file)
		return { std::move(images.heads) };
	const std::vector<std::string> uids = series_among(images.heads);
	std::map<std::string, size_t> place;
	std::vector<std::vector<head>> groups(uids.size());
	for (size_t i = 0; i < uids.size(); i++)
		place[uids[i]] = i;
	for (head &h : images.heads)
		groups[place[h.series_uid]].push_back(std::move(h));
	return groups;
}

class lister
{
      public:
	lister(const gz_volume_file &of, const gz_decode_listener &to) : file(of), listener(to)
	{
	}
	gz_result list(found_images &images);

      private:
	gz_result send_rows(found_images &images);
	void send_picture(uint32_t index) const;
	void refuse(uint32_t index, const std::string &why) const;

	const gz_volume_file &file;
	const gz_decode_listener &listener;
	std::vector<listed_series> all;
};

gz_result lister::send_rows(found_images &images)
{
	std::vector<std::vector<head>> groups = group_images(images);
	if (groups.size() > GZ_DECODE_SERIES_MAX) {
		gz_warn(file.log, "%s: %zu series; the first %d are listed", file.path,
			groups.size(), GZ_DECODE_SERIES_MAX);
		groups.resize(GZ_DECODE_SERIES_MAX);
	}
	for (std::vector<head> &group : groups) {
		all.emplace_back(file, std::move(group));
		const gz_result result = listener.series(listener.user, &all.back().row);
		if (result != GZ_OK)
			return result;
		if (!gz_loading_goes_on(file.loading, 0, file.path))
			return GZ_ERR_CANCELLED;
	}
	return GZ_OK;
}

void lister::refuse(uint32_t index, const std::string &why) const
{
	listener.refused(listener.user, index, why.c_str());
}

/* A slice that cannot be decoded, by its compression for one, is found here. */
void lister::send_picture(uint32_t index) const
{
	const gz_dicom_series &slices = *all[index].slices;
	const gz_dicom_geometry geometry = geometry_of_files(slices);
	uint8_t pixels[GZ_DECODE_PICTURE_EDGE * GZ_DECODE_PICTURE_EDGE];
	const decoded_slice middle = decode_of_stack(slices, (size_t)geometry.dims[2] / 2);
	if (middle.result != GZ_OK) {
		refuse(index, middle.why);
		return;
	}
	if (!make_picture(geometry, middle.voxels, pixels))
		return;
	gz_decode_picture picture {};
	for (picture.band = 0; picture.band < GZ_DECODE_PICTURE_BANDS; picture.band++) {
		std::memcpy(picture.pixels, pixels + picture.band * sizeof picture.pixels,
			    sizeof picture.pixels);
		listener.picture(listener.user, index, &picture);
	}
}

gz_result lister::list(found_images &images)
{
	const gz_result result = send_rows(images);
	if (result != GZ_OK)
		return result;
	for (size_t i = 0; i < all.size(); i++) {
		if (!gz_loading_goes_on(file.loading, (double)i / (double)all.size(), file.path))
			return GZ_ERR_CANCELLED;
		try {
			if (all[i].slices)
				send_picture((uint32_t)i);
		} catch (const std::bad_alloc &) {
			refuse((uint32_t)i, "no memory to decode one of its slices");
		} catch (const std::exception &e) {
			refuse((uint32_t)i, std::string("cannot be decoded: ") + e.what());
		}
	}
	return GZ_ERR_CHOICE;
}

gz_result list_or_open(const gz_volume_file &file, const gz_decode_listener &listener,
		       gz_dicom_series **out_series)
{
	found_images images;
	gz_result result = find_images(file, "", images);
	const bool single = images.one_file || images.chosen ||
			    (result == GZ_OK && series_among(images.heads).size() < 2);
	if (result == GZ_OK && single)
		result = keep_one_series(file, images);
	if (result != GZ_OK)
		return result;
	if (!single || !out_series)
		return lister(file, listener).list(images);
	stack series;
	result = open_stack(file, std::move(images.heads), file.log, series);
	if (result == GZ_OK)
		*out_series = series.release();
	return result;
}

} // namespace

extern "C" void gz_dicom_prepare_texts(void)
{
	prepare_texts();
}

extern "C" enum gz_result gz_dicom_list(const struct gz_volume_file *file,
					const struct gz_decode_listener *listener,
					struct gz_dicom_series **out_series)
{
	return without_throwing(*file, [&] { return list_or_open(*file, *listener, out_series); });
}
