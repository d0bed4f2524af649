#include "render/decode/dicom/dicom_spacing.hpp"

#include <algorithm>
#include <array>
#include <cstdio>
#include <string>
#include <utility>

#define GZ_LOG_MODULE "dicom"

namespace gz_dicom
{

namespace
{

/* How far slices may be shifted against each other before the log says that the gantry was tilted,
 * degrees, and how far from one line, pixels (chosen: less is not visible). */
const double tilt_most_deg = 1.0;
const double wander_most_px = 1.0;

/* Gaps that a message names one by one. */
const size_t gaps_named = 4;

const double deg_per_rad = 180 / 3.14159265358979323846;

using shifts = std::vector<std::array<double, 2>>;

/* How the slices of a stack lie against each other. */
struct lie {
	std::vector<double> along; /* of the first time point */
	shifts within; /* the plane, against the first slice, mm along rows and columns; of all
			  time points */
	gz_slice_gaps gaps {};
	double tilt_deg = 0;  /* of the line from the first to the last slice against the normal */
	double wander_mm = 0; /* greatest distance of a slice from that line */
	double wander_most_mm = 0; /* above it, the slices lie on no line */
	bool shifted = false;
};

vector3 unit(const vector3 &v)
{
	const double length = std::sqrt(dot(v, v));
	return { { v.x[0] / length, v.x[1] / length, v.x[2] / length } };
}

/* Tilt of the first time point, and how far slices of all are from the line that it makes. */
void measure_shift(const format &numbers, lie &stack)
{
	const size_t count = stack.along.size();
	const double extent = stack.along.back() - stack.along.front();
	const auto &last = stack.within[count - 1];
	stack.tilt_deg = std::atan2(std::hypot(last[0], last[1]), extent) * deg_per_rad;
	for (size_t i = 0; i < stack.within.size(); i++) {
		const double share = (stack.along[i % count] - stack.along[0]) / extent;
		const auto &shift = stack.within[i];
		stack.wander_mm = std::max(stack.wander_mm, std::hypot(shift[0] - share * last[0],
								       shift[1] - share * last[1]));
	}
	stack.wander_most_mm = wander_most_px * std::min(numbers.spacing[0], numbers.spacing[1]);
	stack.shifted = stack.tilt_deg > tilt_most_deg || stack.wander_mm > stack.wander_most_mm;
}

gz_result measure_lie(const placed_stack &stack, lie &out)
{
	const slice &first = stack.slices[0];
	const vector3 row = unit(first.row), column = unit(first.column);
	for (const slice &s : stack.slices) {
		vector3 shift {};
		for (int i = 0; i < 3; i++)
			shift.x[i] = s.position.x[i] - first.position.x[i];
		out.within.push_back({ dot(shift, row), dot(shift, column) });
		if (out.along.size() < stack.count)
			out.along.push_back(s.along);
	}
	measure_shift(stack.numbers, out);
	return gz_slice_gaps_find(out.along.data(), out.along.size(), &out.gaps);
}

std::string text_of_number(double number)
{
	char text[32];
	snprintf(text, sizeof text, "%g", number);
	return text;
}

/* The first gaps that are not the usual one, and how many more there are. */
std::string name_gaps(const lie &stack)
{
	std::string names;
	size_t found = 0;
	for (size_t i = 0; i + 1 < stack.along.size(); i++) {
		const double from = stack.along[i], to = stack.along[i + 1];
		const size_t steps = gz_slice_gap_steps(&stack.gaps, to - from);
		if (steps == 1 || found++ >= gaps_named)
			continue;
		const bool missing = stack.gaps.fault == GZ_SLICES_MISSING;
		names += names.empty() ? "" : ", ";
		names += missing ? std::to_string(steps - 1) : text_of_number(to - from) + " mm";
		names += " between " + text_of_number(from) + " and " + text_of_number(to) + " mm";
	}
	if (found > gaps_named)
		names += ", and " + std::to_string(found - gaps_named) + " more such gaps";
	return names;
}

/* What is wrong with the gaps, and where: positions are along the normal. */
std::string describe_gaps(const lie &stack)
{
	const gz_slice_gaps &gaps = stack.gaps;
	const std::string usual = text_of_number(gaps.usual_mm), where = name_gaps(stack);
	if (gaps.fault == GZ_SLICES_MISSING)
		return std::to_string(gaps.missing) + " of " +
		       std::to_string(stack.along.size() + gaps.missing) + " slices, " + usual +
		       " mm apart, " + (gaps.missing == 1 ? "is" : "are") + " missing: " + where;
	return "its slices lie " + text_of_number(gaps.least_mm) + " to " +
	       text_of_number(gaps.greatest_mm) + " mm apart, most " + usual + ": " + where;
}

std::string describe_shift(const lie &stack)
{
	char text[128];
	if (stack.wander_mm > stack.wander_most_mm)
		snprintf(text, sizeof text, "slices are shifted by up to %.1f mm off one line",
			 stack.wander_mm);
	else
		snprintf(text, sizeof text, "the gantry was tilted by %.1f degrees",
			 stack.tilt_deg);
	return text;
}

gz_result tell(const lie &stack, const gz_volume_file &file)
{
	if (stack.gaps.fault != GZ_SLICES_EVEN) {
		const char *remedy = stack.gaps.fault == GZ_SLICES_MISSING
					     ? "add what is missing, or open it with --resample"
					     : "open it with --resample";
		gz_err(file.log, "%s: %s; %s (scene key volume.resample), which interpolates",
		       file.path, describe_gaps(stack).c_str(), remedy);
		return GZ_ERR_FORMAT;
	}
	if (stack.shifted)
		gz_warn(file.log,
			"%s: %s; the slices are shown straight above each other; --resample (scene "
			"key volume.resample) puts them where they belong",
			file.path, describe_shift(stack).c_str());
	return GZ_OK;
}

void tell_resampled(const lie &stack, const gz_slice_grid &grid, const gz_volume_file &file)
{
	std::string faults;
	if (stack.gaps.fault != GZ_SLICES_EVEN)
		faults = describe_gaps(stack);
	if (stack.shifted)
		faults += (faults.empty() ? "" : "; ") + describe_shift(stack);
	gz_warn(file.log,
		"%s: resampled (%s) from %zu slices to %d, %g mm apart; what lies between slices "
		"was not measured: %s",
		file.path, gz_resampling_names[grid.how], grid.count, grid.dims[2], grid.spacing_mm,
		faults.c_str());
}

gz_result make_grid(const placed_stack &of, const lie &stack, const gz_volume_file &file,
		    even_grid &out)
{
	const format &numbers = of.numbers;
	const gz_slice_stack slices = {
		of.count,
		stack.along.data(),
		stack.shifted ? (const double(*)[2])stack.within.data() : nullptr,
		numbers.columns,
		numbers.rows,
		{ numbers.spacing[0], numbers.spacing[1] },
		of.channels,
		of.slices.size() / of.count,
	};
	const gz_result result =
		gz_slice_grid_make(&slices, &stack.gaps, file.loading->resampling, &out.grid);
	if (result == GZ_OK)
		tell_resampled(stack, out.grid, file);
	else if (result == GZ_ERR_FORMAT)
		gz_err(file.log,
		       "%s: %s, too far to be moved back: by more than %d of their widths; keep "
		       "one "
		       "stack in the folder",
		       file.path, describe_shift(stack).c_str(), GZ_SLICE_SHIFT_MAX - 1);
	else
		gz_err(file.log, "%s: no memory to resample it", file.path);
	return result;
}

} // namespace

even_grid::~even_grid()
{
	gz_slice_grid_free(&grid);
}

even_grid::even_grid(even_grid &&other) noexcept : grid(other.grid)
{
	other.grid = gz_slice_grid();
}

gz_result measure_stack(const placed_stack &of, const gz_volume_file &file, even_grid &out,
			double &out_spacing_mm)
{
	lie stack;
	gz_result result = measure_lie(of, stack);
	if (result != GZ_OK) {
		gz_err(file.log, "%s: no memory to read it", file.path);
		return result;
	}
	const bool wrong = stack.gaps.fault != GZ_SLICES_EVEN || stack.shifted;
	const bool resample = file.loading && file.loading->resampling != GZ_RESAMPLING_OFF;
	result = wrong && resample ? make_grid(of, stack, file, out) : tell(stack, file);
	out_spacing_mm =
		out ? out.grid.spacing_mm
		    : (stack.along.back() - stack.along.front()) / (double)(stack.along.size() - 1);
	return result;
}

resampler::resampler(const gz_slice_grid &onto, gz_raw_type number_type, double fill_with,
		     source from)
    : grid(onto), type(number_type), fill(fill_with), give_slice(std::move(from))
{
	const auto channels = (size_t)grid.channels;
	given.resize((size_t)grid.columns * (size_t)grid.rows * channels * gz_raw_type_size(type));
	for (std::vector<double> &plane : planes)
		plane.resize((size_t)grid.dims[0] * (size_t)grid.dims[1] * channels);
}

/* Lay slices until the last one is laid; the first call begins with the first. */
gz_result resampler::advance_to(size_t first, size_t last)
{
	if (!begun)
		next = first;
	begun = true;
	while (next <= last) {
		const gz_result result = give_slice(next, given.data());
		if (result != GZ_OK)
			return result;
		gz_slice_grid_lay(&grid, next, type, given.data(), planes[next % 2].data());
		next++;
	}
	return GZ_OK;
}

gz_result resampler::read(uint64_t index, void *voxels)
{
	const auto slices = (uint64_t)grid.dims[2];
	const gz_slice_mix mix = gz_slice_grid_mix(&grid, (int)(index % slices));
	const size_t lower = (size_t)(index / slices) * grid.count + mix.lower;
	const size_t upper = lower + (mix.weight > 0);
	const gz_result result = advance_to(lower, upper);
	if (result != GZ_OK)
		return result;
	const gz_slice_pair pair = { planes[lower % 2].data(), planes[upper % 2].data(), mix.weight,
				     fill };
	gz_slice_pair_mix(&pair, planes[0].size(), type, voxels);
	return GZ_OK;
}

} // namespace gz_dicom
