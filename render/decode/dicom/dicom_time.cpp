#include "render/decode/dicom/dicom_time.hpp"

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

namespace gz_dicom
{

namespace
{

/* Images nearer to each other lie at one place, mm (chosen: positions are rounded far below it). */
const double same_place = 1e-3;

using place = std::vector<slice>; /* the images at one place */

std::vector<place> places_of(std::vector<slice> &slices)
{
	std::vector<place> places;
	for (slice &s : slices) {
		if (places.empty() || s.along - places.back().front().along >= same_place)
			places.emplace_back();
		places.back().push_back(std::move(s));
	}
	return places;
}

bool tells_order(const std::vector<place> &places, int key)
{
	for (const place &images : places) {
		std::vector<double> when;
		for (const slice &s : images)
			when.push_back(s.when[key]);
		std::sort(when.begin(), when.end());
		if (!std::all_of(when.begin(), when.end(),
				 [](double t) { return !std::isnan(t); }) ||
		    std::adjacent_find(when.begin(), when.end()) != when.end())
			return false;
	}
	return true;
}

/* The first key that tells the order; TIME_KEYS: none. */
int key_of(const std::vector<place> &places)
{
	int key = 0;
	while (key < TIME_KEYS && !tells_order(places, key))
		key++;
	return key;
}

void sort_place(place &images, int key)
{
	std::stable_sort(images.begin(), images.end(), [key](const slice &a, const slice &b) {
		return key < TIME_KEYS ? a.when[key] < b.when[key] : a.number < b.number;
	});
}

/* Of places with different numbers of images only the temporal positions that all have are kept:
 * otherwise an image that is missing in the middle would move those behind it. Returns those that
 * are not. */
std::vector<double> keep_common_positions(std::vector<place> &places)
{
	const auto has = [](const place &images, double position) {
		return std::any_of(images.begin(), images.end(), [position](const slice &s) {
			return s.when[TIME_POSITION] == position;
		});
	};
	std::vector<double> common;
	for (const slice &s : places[0])
		if (std::all_of(places.begin(), places.end(), [&](const place &images) {
			    return has(images, s.when[TIME_POSITION]);
		    }))
			common.push_back(s.when[TIME_POSITION]);
	if (common.empty())
		return {};
	std::set<double> others;
	for (const place &images : places)
		for (const slice &s : images)
			if (std::find(common.begin(), common.end(), s.when[TIME_POSITION]) ==
			    common.end())
				others.insert(s.when[TIME_POSITION]);
	for (place &images : places)
		images.erase(std::remove_if(images.begin(), images.end(),
					    [&](const slice &s) {
						    return std::find(common.begin(), common.end(),
								     s.when[TIME_POSITION]) ==
							   common.end();
					    }),
			     images.end());
	return { others.begin(), others.end() };
}

size_t fewest(const std::vector<place> &places)
{
	size_t count = places[0].size();
	for (const place &images : places)
		count = std::min(count, images.size());
	return count;
}

} // namespace

time_order order_in_time(std::vector<slice> &slices)
{
	static const char *const names[TIME_KEYS + 1] = { "temporal position", "acquisition number",
							  "trigger time",      "content time",
							  "acquisition time",  "instance number" };
	time_order order;
	const size_t all = slices.size();
	std::vector<place> places = places_of(slices);
	if (places.empty() || places.size() == all) {
		slices.clear();
		for (place &images : places)
			slices.push_back(std::move(images[0]));
		return order;
	}
	const int key = key_of(places);
	for (place &images : places)
		sort_place(images, key);
	const bool uneven =
		all != places.size() * places[0].size() || fewest(places) != places[0].size();
	if (uneven && key == TIME_POSITION)
		order.incomplete = keep_common_positions(places);
	order.points = fewest(places);
	order.by = names[key];
	slices.clear();
	for (size_t point = 0; point < order.points; point++)
		for (place &images : places)
			slices.push_back(std::move(images[point]));
	order.left_out = all - slices.size();
	return order;
}

} // namespace gz_dicom
