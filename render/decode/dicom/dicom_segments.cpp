#include "render/decode/dicom/dicom_segments.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <memory>
#include <numeric>

#include "render/data/volume.h"
#include "render/decode/dicom/dicom_elements.hpp"

#define GZ_LOG_MODULE "dicom"

namespace gz_dicom
{

namespace
{

const gdcm::Tag segmentation_type(0x0062, 0x0001), segment_sequence(0x0062, 0x0002),
	segment_number(0x0062, 0x0004), segment_label(0x0062, 0x0005),
	identification(0x0062, 0x000a), referenced_number(0x0062, 0x000b),
	display_value(0x0062, 0x000d), maximum_fraction(0x0062, 0x000e);

/* How far a frame may be from an even distance, and within its plane from the first, as a share of
 * the distance of slices or pixels (chosen: positions are rounded far below it). */
const double off_most = 0.05;

/* Frames nearer to each other lie in one slice, mm (chosen: positions are rounded far below it). */
const double same_place = 1e-3;

/* Segments whose names are logged. */
const size_t named_max = 40;

/* From CIELab as DICOM stores it (PS3.3, C.10.7.1.1; its white is D50) to sRGB (IEC 61966-2-1,
 * with Bradford's adaptation to D65). */
void rgb_of_lab(const uint16_t lab[3], int out[3])
{
	static const double white[3] = { 0.9642, 1.0, 0.8249 };
	static const double to_linear[3][3] = { { 3.1338561, -1.6168667, -0.4906146 },
						{ -0.9787684, 1.9161415, 0.0334540 },
						{ 0.0719453, -0.2289914, 1.4052427 } };
	const double l = lab[0] * 100 / 65535.0, a = lab[1] * 255 / 65535.0 - 128,
		     b = lab[2] * 255 / 65535.0 - 128;
	const double f[3] = { (l + 16) / 116 + a / 500, (l + 16) / 116, (l + 16) / 116 - b / 200 };
	double xyz[3];
	for (int i = 0; i < 3; i++)
		xyz[i] = white[i] *
			 (f[i] > 6.0 / 29 ? f[i] * f[i] * f[i] : (f[i] - 4.0 / 29) * 108 / 841);
	for (int i = 0; i < 3; i++) {
		const double linear = to_linear[i][0] * xyz[0] + to_linear[i][1] * xyz[1] +
				      to_linear[i][2] * xyz[2];
		const double shown = linear <= 0.0031308
					     ? 12.92 * linear
					     : 1.055 * std::pow(linear, 1 / 2.4) - 0.055;
		out[i] = (int)std::lround(255 * std::min(1.0, std::max(0.0, shown)));
	}
}

segment segment_of(const gdcm::DataSet &item)
{
	segment s;
	uint16_t lab[3];
	s.number = short_of(item, segment_number, 0);
	s.label = text_of(item, segment_label);
	const gdcm::ByteValue *value = value_of(item, display_value);
	s.coloured = value && value->GetLength() == sizeof lab;
	if (s.coloured) {
		std::memcpy(lab, value->GetPointer(), sizeof lab);
		rgb_of_lab(lab, s.rgb);
	}
	return s;
}

/* The segment that a functional group names; 0: none. */
int number_in_group(const gdcm::DataSet *group)
{
	if (!group)
		return 0;
	const items sequence = sequence_of(*group, identification);
	const gdcm::DataSet *item = item_of(sequence, 0);
	return item ? short_of(*item, referenced_number, 0) : 0;
}

/* Gaps between neighbours that do not lie at the same place. */
std::vector<double> gaps_of(const std::vector<slice> &frames)
{
	std::vector<double> along, gaps;
	for (const slice &s : frames)
		along.push_back(s.along);
	std::sort(along.begin(), along.end());
	for (size_t i = 1; i < along.size(); i++)
		if (along[i] - along[i - 1] > same_place)
			gaps.push_back(along[i] - along[i - 1]);
	return gaps;
}

/* Whether all gaps are whole multiples of a distance. */
bool are_multiples(const std::vector<double> &gaps, double distance)
{
	return distance > 0 && std::all_of(gaps.begin(), gaps.end(), [&](double gap) {
		       const double times = gap / distance;
		       return times > 0.9 && std::fabs(times - std::round(times)) < off_most;
	       });
}

/* The usual gap: the mean of those near the least. */
double usual_gap(const std::vector<double> &gaps)
{
	const double least = *std::min_element(gaps.begin(), gaps.end());
	double sum = 0;
	size_t near = 0;
	for (const double gap : gaps)
		if (gap < 1.5 * least) {
			sum += gap;
			near++;
		}
	return sum / (double)near;
}

/* Distance of slices: what the file says, as slices without a segment may be left out; else a frame
 * is as thick as it says, if the gaps allow it; else that of neighbours. Positions are rounded, so
 * that it is made to fit the whole stack. */
double distance_of_slices(const head &image, const gz_log *log)
{
	const format &numbers = image.numbers;
	const std::vector<double> gaps = gaps_of(image.slices);
	if (gaps.empty())
		return numbers.between > 0     ? numbers.between
		       : numbers.thickness > 0 ? numbers.thickness
					       : numbers.spacing[0];
	const double stack = std::accumulate(gaps.begin(), gaps.end(), 0.0);
	const bool told = are_multiples(gaps, numbers.between);
	const bool thick = !told && are_multiples(gaps, numbers.thickness);
	const double guess = told ? numbers.between : thick ? numbers.thickness : usual_gap(gaps);
	const double count = std::max(1.0, std::round(stack / guess));
	if (thick && count > (double)gaps.size())
		gz_warn(log,
			"%s: does not say how far apart its slices lie; taken to be their "
			"thickness, %g mm, so that %.0f between its frames are empty",
			image.path.c_str(), numbers.thickness, count - (double)gaps.size());
	return stack / count;
}

/* How far a frame lies beside the first within the plane, in pixels. */
double pixels_aside(const slice &s, const slice &first, const format &numbers)
{
	vector3 away {};
	for (int i = 0; i < 3; i++)
		away.x[i] = s.position.x[i] - first.position.x[i];
	return std::max(std::fabs(dot(away, first.row)) / numbers.spacing[0],
			std::fabs(dot(away, first.column)) / numbers.spacing[1]);
}

gz_result refuse_segments(const head &image, const gz_log *log, const char *what)
{
	gz_err(log, "%s: a segmentation %s", image.path.c_str(), what);
	return GZ_ERR_UNSUPPORTED;
}

void log_segments(const head &image, const gz_log *log)
{
	const segmentation &segments = *image.segments;
	for (size_t i = 0; i < segments.all.size() && i < named_max; i++) {
		const segment &s = segments.all[i];
		char colour[32] = "no colour";
		if (s.coloured)
			snprintf(colour, sizeof colour, "#%02x%02x%02x", (unsigned)s.rgb[0],
				 (unsigned)s.rgb[1], (unsigned)s.rgb[2]);
		gz_info(log, "%s: segment %d is %s, %s", image.path.c_str(), s.number,
			s.label.empty() ? "without a name" : s.label.c_str(), colour);
	}
	if (segments.all.size() > named_max)
		gz_info(log, "%s: and %zu more segments", image.path.c_str(),
			segments.all.size() - named_max);
}

gz_result check_segments(const head &image, const gz_log *log)
{
	const segmentation &segments = *image.segments;
	const slice &first = image.slices[0];
	for (size_t k = 0; k < image.slices.size(); k++) {
		const slice &s = image.slices[k];
		if (!s.placed)
			return refuse_segments(image, log,
					       "whose frames do not say where they lie");
		if (dot(s.row, first.row) < 0.999 || dot(s.column, first.column) < 0.999 ||
		    pixels_aside(s, first, image.numbers) > off_most)
			return refuse_segments(image, log,
					       "whose frames do not lie one above the other");
		if (segments.of_frame[k] < 1)
			return refuse_segments(image, log,
					       "whose frames do not say which segment they are");
	}
	return GZ_OK;
}

/* Slices at even distances, each with its frames. */
gz_result collect_frames(const head &image, double distance, std::vector<slice> &out,
			 const gz_log *log)
{
	double least = HUGE_VAL, greatest = -HUGE_VAL;
	for (const slice &s : image.slices) {
		least = std::min(least, s.along);
		greatest = std::max(greatest, s.along);
	}
	const double last = std::round((greatest - least) / distance);
	if (!(last < GZ_VOLUME_DIM_MAX)) {
		gz_err(log, "%s: slices %g mm apart over %g mm; allowed: %d", image.path.c_str(),
		       distance, greatest - least, GZ_VOLUME_DIM_MAX);
		return GZ_ERR_FORMAT;
	}
	const slice &first = image.slices[0];
	const vector3 normal = cross(first.row, first.column);
	slice empty = first;
	empty.parts.clear();
	for (int k = 0; k <= (int)last; k++) {
		slice s = empty;
		s.number = k;
		s.along = least + k * distance;
		for (int i = 0; i < 3; i++)
			s.position.x[i] += (s.along - first.along) * normal.x[i];
		out.push_back(s);
	}
	for (size_t k = 0; k < image.slices.size(); k++) {
		const double at = (image.slices[k].along - least) / distance;
		if (std::fabs(at - std::round(at)) > off_most)
			return refuse_segments(image, log, "whose frames lie at uneven distances");
		out[(size_t)std::round(at)].parts.push_back(
			{ image.slices[k].frame, image.segments->of_frame[k] });
	}
	return GZ_OK;
}

} // namespace

int segmentation::greatest_number() const
{
	return of_frame.empty() ? 0 : *std::max_element(of_frame.begin(), of_frame.end());
}

void take_segments(const gdcm::DataSet &data, head &image)
{
	const std::string type = text_of(data, segmentation_type);
	if (type != "BINARY" && type != "FRACTIONAL")
		return;
	auto segments = std::make_shared<segmentation>();
	const items listed = sequence_of(data, segment_sequence),
		    frames = sequence_of(data, frame_groups),
		    shared = sequence_of(data, shared_groups);
	segments->fractional = type == "FRACTIONAL";
	if (segments->fractional)
		segments->full = std::max(1, short_of(data, maximum_fraction, 255));
	for (size_t i = 0; listed && i < listed->GetNumberOfItems(); i++)
		segments->all.push_back(segment_of(*item_of(listed, i)));
	for (size_t k = 0; k < image.slices.size(); k++) {
		const int own = number_in_group(item_of(frames, k));
		segments->of_frame.push_back(own ? own : number_in_group(item_of(shared, 0)));
	}
	image.segments = segments;
}

gz_result stack_segments(head &image, const gz_log *log)
{
	std::vector<slice> slices;
	gz_result result = check_segments(image, log);
	if (result != GZ_OK)
		return result;
	const vector3 normal = cross(image.slices[0].row, image.slices[0].column);
	for (slice &s : image.slices)
		s.along = dot(s.position, normal);
	const double distance = distance_of_slices(image, log);
	result = collect_frames(image, distance, slices, log);
	if (result != GZ_OK)
		return result;
	image.slices = slices;
	image.numbers.thickness = distance;
	log_segments(image, log);
	return GZ_OK;
}

bool put_segment(const segmentation &of, int number, const std::vector<uint8_t> &frame,
		 std::vector<uint16_t> &labels, std::vector<uint8_t> &fractions)
{
	bool overlap = false;
	/* Of a fraction at least half counts (chosen: the surface of the segment is there). */
	const int least = of.fractional ? (of.full + 1) / 2 : 1;
	for (size_t i = 0; i < labels.size() && i < frame.size(); i++) {
		if (frame[i] < least)
			continue;
		overlap = overlap || (labels[i] != 0 && labels[i] != number);
		if (of.fractional && frame[i] < fractions[i])
			continue;
		labels[i] = (uint16_t)number;
		if (of.fractional)
			fractions[i] = frame[i];
	}
	return overlap;
}

} // namespace gz_dicom
