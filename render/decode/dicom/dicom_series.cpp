/* GDCM is C++, so this file is. Nothing it throws leaves it. */
#include "render/decode/dicom/dicom_series.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <memory>
#include <new>
#include <string>
#include <vector>

#include "render/decode/dicom/dicom_file.hpp"
#include "render/decode/dicom/dicom_folder.hpp"
#include "render/decode/dicom/dicom_frame.hpp"
#include "render/decode/dicom/dicom_pool.hpp"
#include "render/decode/dicom/dicom_segments.hpp"
#include "render/decode/dicom/dicom_spacing.hpp"
#include "render/decode/dicom/dicom_stack.hpp"
#include "render/decode/dicom/dicom_time.hpp"

extern "C" {
#include "render/data/float_scaling.h"
}

#define GZ_LOG_MODULE "dicom"

namespace
{

using namespace gz_dicom;

/* Memory that a codec takes for a pixel beside what it gives, bytes (JPEG 2000 works on integers of
 * 32 bits, and keeps a few), of one number. */
const uint64_t codec_bytes_a_pixel = 16;

class reader
{
      public:
	reader(const gz_volume_file &of, const gz_log *to, std::vector<head> images)
	    : path(of.path), loading(of.loading), log(to), heads(std::move(images))
	{
	}
	gz_result open();
	gz_result read(uint64_t index, void *voxels);
	decoded_slice decode(size_t index) const;
	gz_dicom_geometry geometry_of_files() const;
	gz_dicom_geometry geometry {};

      private:
	gz_result check_colour(const head &h) const;
	gz_result check_head(const head &h) const;
	gz_result join();
	gz_result place();
	gz_result order();
	gz_result measure();
	void scale_floats();
	void finish();
	gz_result read_slice(size_t index, void *voxels);
	gz_result find_least(double &out_least);
	void cut_colours(const slice &s, const std::vector<uint8_t> &frame, void *voxels) const;
	decoded_slice decode_segments(const slice &s) const;
	void widen(const slice &s, const std::vector<uint8_t> &frame, void *voxels) const;
	size_t slice_bytes() const;

	const std::string path;
	const gz_loading *loading; /* NULL: none */
	const gz_log *log;
	std::vector<head> heads;
	format numbers;
	std::vector<slice> slices; /* of the first time point */
	std::vector<slice> stacks; /* of all, one behind the other */
	size_t time_points = 1;
	std::shared_ptr<const segmentation> segments; /* NULL: an image */
	bool told_overlap = false;
	bool scaled_apart = false;         /* slices have scales of their own */
	gz_float_scaling scaling { 0, 1 }; /* of their values */
	even_grid even;                    /* what the slices are resampled onto, if they are */
	std::unique_ptr<resampler> resampled;
	uint64_t pool_begin = 0; /* its first slice */
	std::unique_ptr<slice_pool> pool;
};

/* Colours are of 3 x 8 bits, or in a table. */
gz_result reader::check_colour(const head &h) const
{
	const format &f = h.numbers;
	const bool three = f.colours == colour_kind::rgb || f.colours == colour_kind::ybr;
	const auto &pixels = h.slices[0].pixels;
	if (three ? f.samples != 3 || f.bits_allocated != 8 || f.bits_stored != 8 || f.is_signed
		  : f.samples != 1 || f.colours == colour_kind::other) {
		gz_err(log,
		       "%s: colour, %d values of %d bits a pixel, %s; read are 3 of 8 bits, as RGB "
		       "or YBR_FULL, and PALETTE COLOR",
		       h.path.c_str(), f.samples, f.bits_stored, h.photometric.c_str());
		return GZ_ERR_UNSUPPORTED;
	}
	if (three && pixels->halved && !pixels->encapsulated) {
		gz_err(log,
		       "%s: colour, YBR_FULL_422 without compression, is not read; convert it to "
		       "RGB",
		       h.path.c_str());
		return GZ_ERR_UNSUPPORTED;
	}
	if (f.colours == colour_kind::palette && pixels->table.rgb.empty()) {
		gz_err(log,
		       "%s: its table of colours is missing, damaged or segmented; convert it to "
		       "RGB, for instance with gdcmconv --apply-lut",
		       h.path.c_str());
		return GZ_ERR_UNSUPPORTED;
	}
	return GZ_OK;
}

gz_result reader::check_head(const head &h) const
{
	const format &f = h.numbers;
	const gz_result colour = check_colour(h);
	if (colour != GZ_OK)
		return colour;
	const bool bits = f.bits_allocated == 1 && h.segments && !h.segments->fractional;
	if ((!bits && f.bits_allocated != 8 && f.bits_allocated != 16 && f.bits_allocated != 32) ||
	    (h.segments &&
	     (f.bits_allocated > 8 || f.samples != 1 || f.colours != colour_kind::none)) ||
	    (f.colours != colour_kind::none && f.bits_allocated > 16) || f.bits_stored < 1 ||
	    f.bits_stored > f.bits_allocated || f.high_bit < f.bits_stored - 1 ||
	    f.high_bit >= f.bits_allocated) {
		gz_err(log, "%s: pixels of %d bits in %d up to bit %d; 8, 16 and 32 are read",
		       h.path.c_str(), f.bits_stored, f.bits_allocated, f.high_bit);
		return GZ_ERR_UNSUPPORTED;
	}
	if (f.columns < 1 || f.rows < 1 || f.columns > GZ_VOLUME_DIM_MAX ||
	    f.rows > GZ_VOLUME_DIM_MAX || !(f.spacing[0] > 0) || !(f.spacing[1] > 0)) {
		gz_err(log, "%s: %d x %d pixels, %g x %g mm apart; allowed: 1 to %d, above 0",
		       h.path.c_str(), f.columns, f.rows, f.spacing[0], f.spacing[1],
		       GZ_VOLUME_DIM_MAX);
		return GZ_ERR_FORMAT;
	}
	if (!h.of_one_size) {
		gz_err(log, "%s: its frames have pixels of several sizes; only one size is read",
		       h.path.c_str());
		return GZ_ERR_UNSUPPORTED;
	}
	if (h.frames > frames_max || f.stored_bytes(h.frames) > h.bytes) {
		gz_err(log,
		       "%s: truncated: %llu frames of %llu bytes are more than it can hold, or "
		       "more "
		       "than %llu; fetch it again",
		       h.path.c_str(), (unsigned long long)h.frames,
		       (unsigned long long)f.frame_bytes(), (unsigned long long)frames_max);
		return GZ_ERR_FORMAT;
	}
	return GZ_OK;
}

/* The slices of all files, which must be of one format. */
gz_result reader::join()
{
	std::sort(heads.begin(), heads.end(),
		  [](const head &a, const head &b) { return a.path < b.path; });
	numbers = heads[0].numbers;
	segments = heads[0].segments;
	geometry.labels = segments != nullptr;
	geometry.modality = gz_modality_of_term(heads[0].modality.c_str());
	if (segments && heads.size() > 1) {
		gz_err(log, "%s: holds %zu segmentations in one series; name one of its files",
		       path.c_str(), heads.size());
		return GZ_ERR_FORMAT;
	}
	for (head &h : heads) {
		gz_result result = check_head(h);
		if (result == GZ_OK && h.segments)
			result = stack_segments(h, log);
		if (result != GZ_OK)
			return result;
		if (h.segments)
			numbers.thickness = h.numbers.thickness;
		if (!(h.numbers == numbers)) {
			gz_err(log,
			       "%s: its pixels are not as those of %s; keep one kind in the folder",
			       h.path.c_str(), heads[0].path.c_str());
			return GZ_ERR_FORMAT;
		}
		geometry.bytes_bound += h.bytes;
		slices.insert(slices.end(), h.slices.begin(), h.slices.end());
	}
	if (slices.size() > frames_max) {
		gz_err(log, "%s: %zu slices; name a folder with fewer", path.c_str(),
		       slices.size());
		return GZ_ERR_FORMAT;
	}
	return GZ_OK;
}

/* Where each slice lies along the stack; by number where the files do not say. */
gz_result reader::place()
{
	geometry.oriented =
		std::all_of(slices.begin(), slices.end(), [](const slice &s) { return s.placed; });
	if (!geometry.oriented) {
		gz_warn(log,
			"%s: does not say where its slices lie; taken in the order of their "
			"numbers",
			path.c_str());
		for (slice &s : slices)
			s.along = s.number + (double)s.frame;
		return GZ_OK;
	}
	const slice &first = slices[0];
	const vector3 normal = cross(first.row, first.column);
	if (std::fabs(dot(normal, normal) - 1) > 0.02) {
		gz_err(log, "%s: the directions of its rows and columns do not form a right angle",
		       first.path().c_str());
		return GZ_ERR_FORMAT;
	}
	for (slice &s : slices) {
		if (dot(s.row, first.row) < 0.999 || dot(s.column, first.column) < 0.999) {
			gz_err(log,
			       "%s: lies in another plane than %s; keep one stack in the folder",
			       s.path().c_str(), first.path().c_str());
			return GZ_ERR_FORMAT;
		}
		s.along = dot(s.position, normal);
	}
	return GZ_OK;
}

/* Sort by place, and at each place by time. */
gz_result reader::order()
{
	std::stable_sort(slices.begin(), slices.end(), [](const slice &a, const slice &b) {
		return a.along < b.along || (a.along == b.along && a.number < b.number);
	});
	const time_order found = order_in_time(slices);
	time_points = found.points;
	if (time_points > 1)
		gz_info(log, "%s: %zu images at each place: time points, in the order of their %s",
			path.c_str(), time_points, found.by);
	if (!found.incomplete.empty())
		gz_warn(log,
			"%s: temporal position %g%s lacks images at some places; its others are "
			"left out (%zu)",
			path.c_str(), found.incomplete[0],
			found.incomplete.size() > 1 ? ", like others," : "", found.left_out);
	else if (found.left_out > 0)
		gz_warn(log,
			"%s: some places have more images than others; only %zu of each are shown "
			"(%zu left out)",
			path.c_str(), time_points, found.left_out);
	if (slices.size() / time_points <= GZ_VOLUME_DIM_MAX) {
		stacks = slices;
		slices.resize(slices.size() / time_points);
		return GZ_OK;
	}
	gz_err(log, "%s: %zu slices; allowed: %d", path.c_str(), slices.size() / time_points,
	       GZ_VOLUME_DIM_MAX);
	return GZ_ERR_FORMAT;
}

/* The distance of slices, and the grid for those that do not lie evenly. */
gz_result reader::measure()
{
	geometry.spacing[2] = numbers.thickness > 0 ? numbers.thickness : numbers.spacing[0];
	if (!geometry.oriented || slices.size() < 2)
		return GZ_OK;
	const gz_volume_file file = { path.c_str(), nullptr, loading, log };
	const placed_stack stack = { stacks, slices.size(), numbers,
				     numbers.colours != colour_kind::none ? 3 : 1 };
	return measure_stack(stack, file, even, geometry.spacing[2]);
}

gz_raw_type stored_type(const format &f)
{
	if (f.bits_stored <= 8)
		return f.is_signed ? GZ_RAW_INT8 : GZ_RAW_UINT8;
	if (f.bits_stored <= 16)
		return f.is_signed ? GZ_RAW_INT16 : GZ_RAW_UINT16;
	return f.is_signed ? GZ_RAW_INT32 : GZ_RAW_UINT32;
}

/* Values of slices with scales of their own are rounded to floats once, so that those outside of
 * their range, and differences far from 0, are scaled before. Which values there are is not known
 * yet: those that the stored bits can have count. */
void reader::scale_floats()
{
	const double range = std::ldexp(1, numbers.bits_stored);
	const double first = numbers.is_signed ? -range / 2 : 0;
	double least = HUGE_VAL, greatest = -HUGE_VAL;
	for (const slice &s : stacks)
		for (const double stored : { first, first + range - 1 }) {
			least = std::min(least, stored * s.slope + s.intercept);
			greatest = std::max(greatest, stored * s.slope + s.intercept);
		}
	(void)gz_float_scaling_find(least, greatest, &scaling);
	geometry.slope = 1 / scaling.scale;
	geometry.intercept = scaling.offset;
}

/* Patient coordinates of DICOM go left and to the back, ours right and to the front. */
void reader::finish()
{
	const vector3 normal = cross(slices[0].row, slices[0].column);
	const vector3 identity[3] = { { { 1, 0, 0 } }, { { 0, 1, 0 } }, { { 0, 0, 1 } } };
	const vector3 axes[3] = { slices[0].row, slices[0].column, normal };
	for (int axis = 0; axis < 3; axis++)
		for (int i = 0; i < 3; i++)
			geometry.direction[axis][i] = !geometry.oriented ? identity[axis].x[i]
						      : i < 2            ? -axes[axis].x[i]
									 : axes[axis].x[i];
	const int dims[3] = { numbers.columns, numbers.rows, (int)slices.size() };
	std::copy_n(even ? even.grid.dims : dims, 3, geometry.dims);
	geometry.spacing[0] = numbers.spacing[0];
	geometry.spacing[1] = numbers.spacing[1];
	geometry.spacing_assumed = !numbers.spaced;
	geometry.time_points = (int)time_points;
	const bool coloured = numbers.colours != colour_kind::none;
	geometry.channels = coloured ? 3 : 1;
	scaled_apart = !coloured && std::any_of(stacks.begin(), stacks.end(), [&](const slice &s) {
		return s.slope != slices[0].slope || s.intercept != slices[0].intercept;
	});
	geometry.slope = slices[0].slope;
	geometry.intercept = slices[0].intercept;
	if (scaled_apart)
		scale_floats();
	geometry.type = coloured ? GZ_RAW_UINT8
			: segments
				? segments->greatest_number() < 256 ? GZ_RAW_UINT8 : GZ_RAW_UINT16
			: scaled_apart ? GZ_RAW_FLOAT32
				       : stored_type(numbers);
	/* Numbers may be wider in memory than in the file, and empty slices may be left out of it.
	 * The files hold all that is resampled. */
	geometry.bytes_bound *= 4;
	if (segments)
		geometry.bytes_bound = slice_bytes() * slices.size();
	if (even)
		geometry.bytes_bound = (uint64_t)geometry.dims[0] * (uint64_t)geometry.dims[1] *
				       (uint64_t)geometry.dims[2] * (uint64_t)time_points *
				       (uint64_t)geometry.channels *
				       gz_raw_type_size(geometry.type);
}

gz_dicom_geometry reader::geometry_of_files() const
{
	gz_dicom_geometry of_files = geometry;
	of_files.dims[0] = numbers.columns;
	of_files.dims[1] = numbers.rows;
	of_files.dims[2] = (int)slices.size();
	return of_files;
}

gz_result reader::open()
{
	gz_result result = join();
	if (result == GZ_OK)
		result = place();
	if (result == GZ_OK)
		result = order();
	if (result == GZ_OK)
		result = measure();
	if (result == GZ_OK)
		finish();
	return result;
}

size_t reader::slice_bytes() const
{
	return (size_t)numbers.columns * (size_t)numbers.rows * (size_t)geometry.channels *
	       gz_raw_type_size(geometry.type);
}

/* The colours of a slice out of those of its frame. */
void reader::cut_colours(const slice &s, const std::vector<uint8_t> &frame, void *voxels) const
{
	const size_t row = 3 * (size_t)numbers.columns;
	for (int y = 0; y < numbers.rows; y++) {
		const size_t at = (size_t)(s.first_row + y) * (size_t)numbers.frame_columns +
				  (size_t)s.first_column;
		std::memcpy((uint8_t *)voxels + (size_t)y * row, &frame[3 * at], row);
	}
}

/* A pixel as it is allocated. */
uint32_t raw_pixel(const format &f, const std::vector<uint8_t> &frame, size_t at)
{
	uint16_t two;
	uint32_t four;
	switch (f.bits_allocated) {
	case 8:
		return frame[at];
	case 16:
		std::memcpy(&two, &frame[2 * at], sizeof two);
		return two;
	default:
		std::memcpy(&four, &frame[4 * at], sizeof four);
		return four;
	}
}

/* Put a number at a place of an array of a type. */
void put_number(gz_raw_type type, int64_t value, size_t at, void *voxels)
{
	switch (type) {
	case GZ_RAW_UINT8:
		((uint8_t *)voxels)[at] = (uint8_t)value;
		break;
	case GZ_RAW_INT8:
		((int8_t *)voxels)[at] = (int8_t)value;
		break;
	case GZ_RAW_UINT16:
		((uint16_t *)voxels)[at] = (uint16_t)value;
		break;
	case GZ_RAW_INT16:
		((int16_t *)voxels)[at] = (int16_t)value;
		break;
	case GZ_RAW_UINT32:
		((uint32_t *)voxels)[at] = (uint32_t)value;
		break;
	default:
		((int32_t *)voxels)[at] = (int32_t)value;
		break;
	}
}

/* Stored bits to numbers of the geometry's type: other bits, overlays of old, are masked out. */
void reader::widen(const slice &s, const std::vector<uint8_t> &frame, void *voxels) const
{
	const int shift = numbers.high_bit + 1 - numbers.bits_stored;
	const uint32_t mask = (uint32_t)((UINT64_C(1) << numbers.bits_stored) - 1);
	const int64_t sign = numbers.is_signed ? INT64_C(1) << (numbers.bits_stored - 1) : 0;
	size_t i = 0;
	for (int y = 0; y < numbers.rows; y++) {
		size_t at = (size_t)(s.first_row + y) * (size_t)numbers.frame_columns +
			    (size_t)s.first_column;
		for (int x = 0; x < numbers.columns; x++, i++, at++) {
			const uint32_t raw = raw_pixel(numbers, frame, at) >> shift & mask;
			const int64_t value = ((int64_t)raw ^ sign) - sign;
			if (geometry.type == GZ_RAW_FLOAT32)
				((float *)voxels)[i] = (float)(((double)value * s.slope +
								s.intercept - scaling.offset) *
							       scaling.scale);
			else
				put_number(geometry.type, value, i, voxels);
		}
	}
}

/* A slice of labels, of all frames that lie there. */
decoded_slice reader::decode_segments(const slice &s) const
{
	decoded_slice made;
	const size_t count = (size_t)numbers.columns * (size_t)numbers.rows;
	std::vector<uint16_t> labels(count);
	std::vector<uint8_t> frame, fractions(segments->fractional ? count : 0);
	for (const segment_frame &part : s.parts) {
		made.result = decode_frame(*s.pixels, part.frame, frame, made.why);
		if (made.result != GZ_OK)
			return made;
		if (put_segment(*segments, part.number, frame, labels, fractions))
			made.overlap = true;
	}
	made.voxels.resize(slice_bytes());
	for (size_t i = 0; i < count; i++)
		put_number(geometry.type, labels[i], i, made.voxels.data());
	return made;
}

decoded_slice reader::decode(size_t index) const
{
	const slice &s = stacks[index];
	if (segments)
		return decode_segments(s);
	decoded_slice made;
	std::vector<uint8_t> frame;
	made.result = decode_frame(*s.pixels, s.frame, frame, made.why);
	if (made.result == GZ_OK) {
		made.voxels.resize(slice_bytes());
		if (numbers.colours != colour_kind::none)
			cut_colours(s, frame, made.voxels.data());
		else
			widen(s, frame, made.voxels.data());
	}
	return made;
}

gz_result reader::read_slice(size_t index, void *voxels)
{
	if (!pool) {
		pool_begin = index;
		pool.reset(new slice_pool(
			stacks.size() - pool_begin,
			numbers.frame_bytes() + codec_bytes_a_pixel * (uint64_t)geometry.channels *
							(uint64_t)numbers.frame_columns *
							(uint64_t)numbers.frame_rows,
			[this](size_t at) { return decode(pool_begin + at); }));
	}
	const decoded_slice made = pool->take();
	if (made.result != GZ_OK) {
		gz_err(log, "%s: %s", stacks[index].path().c_str(), made.why.c_str());
		return made.result;
	}
	if (made.overlap && !told_overlap) {
		told_overlap = true;
		gz_warn(log, "%s: segments overlap; where they do, %s is shown", path.c_str(),
			segments->fractional ? "the one with the greatest fraction"
					     : "the one whose frame comes later");
	}
	std::memcpy(voxels, made.voxels.data(), made.voxels.size());
	return GZ_OK;
}

/* The least number of the first time point, whose slices are decoded for it. */
gz_result reader::find_least(double &out_least)
{
	const size_t count = (size_t)numbers.columns * (size_t)numbers.rows;
	std::vector<uint8_t> voxels(slice_bytes());
	double least = HUGE_VAL;
	for (size_t i = 0; i < slices.size(); i++) {
		if (!gz_loading_goes_on(loading, 0, path.c_str()))
			return GZ_ERR_CANCELLED;
		const gz_result result = read_slice(i, voxels.data());
		if (result != GZ_OK)
			return result;
		least = std::min(least, gz_slice_least(geometry.type, voxels.data(), count));
	}
	pool.reset();
	out_least = least;
	return GZ_OK;
}

/* Where slices are moved, voxels that lie in none get the least number, as dcm2niix does (air in
 * CT); colours get black. */
gz_result reader::read(uint64_t index, void *voxels)
{
	if (!even)
		return read_slice(index, voxels);
	if (!resampled) {
		double fill = 0;
		const bool finds = even.grid.shifted && geometry.channels == 1;
		const gz_result result = finds ? find_least(fill) : GZ_OK;
		if (result != GZ_OK)
			return result;
		resampled.reset(new resampler(
			even.grid, geometry.type, fill,
			[this](size_t slice, void *to) { return read_slice(slice, to); }));
	}
	return resampled->read(index, voxels);
}

} // namespace

struct gz_dicom_series {
	reader slices;
	const gz_log *log;
};

namespace gz_dicom
{

gz_result open_stack(const gz_volume_file &file, std::vector<head> images, const gz_log *log,
		     stack &out)
{
	stack made(new gz_dicom_series { reader(file, log, std::move(images)), log });
	const gz_result result = made->slices.open();
	if (result == GZ_OK)
		out = std::move(made);
	return result;
}

gz_result explain_exception(const gz_volume_file &file)
{
	try {
		throw;
	} catch (const std::bad_alloc &) {
		gz_err(file.log, "%s: no memory to read it", file.path);
		return GZ_ERR_NO_MEM;
	} catch (const std::exception &e) {
		gz_err(file.log, "%s: cannot be read: %s", file.path, e.what());
		return GZ_ERR_FORMAT;
	}
}

gz_dicom_geometry geometry_of_files(const gz_dicom_series &of)
{
	return of.slices.geometry_of_files();
}

decoded_slice decode_of_stack(const gz_dicom_series &of, size_t index)
{
	return of.slices.decode(index);
}

} // namespace gz_dicom

extern "C" enum gz_result gz_dicom_series_open(const struct gz_volume_file *file,
					       const char *choice,
					       struct gz_dicom_series **out_series)
{
	return without_throwing(*file, [&] {
		found_images images;
		stack series;
		gz_result result = find_images(*file, choice ? choice : "", images);
		if (result == GZ_OK)
			result = keep_one_series(*file, images);
		if (result == GZ_OK)
			result = open_stack(*file, std::move(images.heads), file->log, series);
		if (result == GZ_OK)
			*out_series = series.release();
		return result;
	});
}

extern "C" const struct gz_dicom_geometry *gz_dicom_series_geometry(
	const struct gz_dicom_series *series)
{
	return &series->slices.geometry;
}

extern "C" enum gz_result gz_dicom_series_read(struct gz_dicom_series *series, uint64_t index,
					       void *voxels)
{
	try {
		return series->slices.read(index, voxels);
	} catch (const std::bad_alloc &) {
		gz_err(series->log, "no memory to decode a DICOM image");
		return GZ_ERR_NO_MEM;
	} catch (const std::exception &e) {
		gz_err(series->log, "a DICOM image cannot be read: %s", e.what());
		return GZ_ERR_FORMAT;
	}
}

extern "C" void gz_dicom_series_close(struct gz_dicom_series **series)
{
	delete *series;
	*series = nullptr;
}
