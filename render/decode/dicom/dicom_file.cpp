#include "render/decode/dicom/dicom_file.hpp"

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <mutex>
#include <sys/stat.h>

#include <gdcmCSAHeader.h>
#include <gdcmMediaStorage.h>
#include <gdcmReader.h>
#include <gdcmTrace.h>

#include "render/data/dicom_name.h"
#include "render/data/volume.h"
#include "render/decode/dicom/dicom_dose.hpp"
#include "render/decode/dicom/dicom_elements.hpp"
#include "render/decode/dicom/dicom_guard.hpp"
#include "render/decode/dicom/dicom_lengths.hpp"
#include "render/decode/dicom/dicom_segments.hpp"
#include "render/decode/dicom/dicom_text.hpp"

namespace gz_dicom
{

namespace
{

/* Best ratio of what is decoded here. Chosen: an empty picture in JPEG-LS takes one bit for a run
 * of up to 32768 pixels, but the head of its file is longer than the rest by then. */
const uint64_t compression_ratio = 4096;

/* Most bytes that a byte of a deflated file becomes (zlib's technical notes: 1032). */
const uint64_t deflate_ratio = 1032;

/* Fragments of one file (chosen: four for each of the most frames). */
const size_t fragments_max = 65536;

/* Slices of a mosaic (chosen: scanners make up to 144). */
const int tiles_max = 1024;

const gdcm::Tag item_tag(0xfffe, 0xe000), sequence_end(0xfffe, 0xe0dd);

const gdcm::Tag float_pixels(0x7fe0, 0x0008), double_pixels(0x7fe0, 0x0009);

const gdcm::Tag character_set(0x0008, 0x0005), image_instance_uid(0x0008, 0x0018),
	image_type(0x0008, 0x0008), study_date(0x0008, 0x0020), modality(0x0008, 0x0060),
	patient_name(0x0010, 0x0010), series_number(0x0020, 0x0011),
	series_description(0x0008, 0x103e), slice_thickness(0x0018, 0x0050),
	spacing_between_slices(0x0018, 0x0088), series_instance_uid(0x0020, 0x000e),
	instance_number(0x0020, 0x0013), image_position(0x0020, 0x0032),
	image_orientation(0x0020, 0x0037), samples_per_pixel(0x0028, 0x0002),
	photometric_interpretation(0x0028, 0x0004), planar_configuration(0x0028, 0x0006),
	number_of_frames(0x0028, 0x0008), rows(0x0028, 0x0010), columns(0x0028, 0x0011),
	pixel_spacing(0x0028, 0x0030), bits_allocated(0x0028, 0x0100), bits_stored(0x0028, 0x0101),
	high_bit(0x0028, 0x0102), pixel_representation(0x0028, 0x0103),
	rescale_intercept(0x0028, 0x1052), rescale_slope(0x0028, 0x1053),
	plane_position(0x0020, 0x9113), plane_orientation(0x0020, 0x9116),
	pixel_measures(0x0028, 0x9110), value_transformation(0x0028, 0x9145),
	frame_content(0x0020, 0x9111), temporal_position_index(0x0020, 0x9128);

/* The functional groups of an enhanced image (PS3.3, C.7.6.16). */
class groups
{
      public:
	explicit groups(const gdcm::DataSet &all) : data(all)
	{
		shared = sequence_of(all, shared_groups);
		frames = sequence_of(all, frame_groups);
	}

	/* Calls `use` with the item that holds a group for a frame: its own, else the shared one,
	 * else the data set itself. */
	template <typename F> auto in(uint32_t frame, const gdcm::Tag &tag, F use) const
	{
		const gdcm::DataSet *const outers[2] = { item_of(frames, frame),
							 item_of(shared, 0) };
		for (const gdcm::DataSet *outer : outers) {
			if (!outer)
				continue;
			const items group = sequence_of(*outer, tag);
			const gdcm::DataSet *item = item_of(group, 0);
			if (item)
				return use(*item);
		}
		return use(data);
	}

      private:
	const gdcm::DataSet &data;
	items shared, frames;
};

/* What one group says of the sizes of pixels. */
void take_measures(const gdcm::DataSet &measures, format &f)
{
	double rows_columns[2], thickness;
	/* Between rows comes first (PS3.3, 10.7.1.3). */
	if (numbers_of(measures, pixel_spacing, rows_columns, 2)) {
		f.spacing[0] = rows_columns[1];
		f.spacing[1] = rows_columns[0];
		f.spaced = true;
	}
	if (numbers_of(measures, spacing_between_slices, &thickness, 1) ||
	    numbers_of(measures, slice_thickness, &thickness, 1))
		f.thickness = std::fabs(thickness);
	if (numbers_of(measures, spacing_between_slices, &thickness, 1))
		f.between = std::fabs(thickness);
}

format format_of(const gdcm::DataSet &data, const groups &functional)
{
	format f;
	f.columns = f.frame_columns = short_of(data, columns, 0);
	f.rows = f.frame_rows = short_of(data, rows, 0);
	f.bits_allocated = short_of(data, bits_allocated, 0);
	f.bits_stored = short_of(data, bits_stored, f.bits_allocated);
	f.high_bit = short_of(data, high_bit, f.bits_stored - 1);
	f.is_signed = short_of(data, pixel_representation, 0) == 1;
	f.samples = short_of(data, samples_per_pixel, 1);
	f.colours = colour_kind_of(text_of(data, photometric_interpretation));
	functional.in(0, pixel_measures,
		      [&f](const gdcm::DataSet &measures) { take_measures(measures, f); });
	return f;
}

/* When a frame was taken. */
void take_times(const gdcm::DataSet &data, const groups &functional, slice &s)
{
	static const gdcm::Tag tags[TIME_KEYS] = { { 0x0020, 0x0100 },
						   { 0x0020, 0x0012 },
						   { 0x0018, 0x1060 },
						   { 0x0008, 0x0033 },
						   { 0x0008, 0x0032 } };
	for (int key = 0; key < TIME_KEYS; key++)
		if (!numbers_of(data, tags[key], &s.when[key], 1))
			s.when[key] = std::nan("");
	functional.in(s.frame, frame_content, [&s](const gdcm::DataSet &group) {
		uint32_t index;
		const gdcm::ByteValue *value = value_of(group, temporal_position_index);
		if (!value || value->GetLength() < sizeof index)
			return;
		std::memcpy(&index, value->GetPointer(), sizeof index);
		s.when[TIME_POSITION] = index;
	});
}

slice slice_of(const gdcm::DataSet &data, const groups &functional, uint32_t frame)
{
	slice s;
	double directions[6];
	s.frame = frame;
	s.number = decimal_of(data, instance_number, 0);
	take_times(data, functional, s);
	s.placed = functional.in(frame, plane_position, [&s](const gdcm::DataSet &group) {
		return numbers_of(group, image_position, s.position.x, 3);
	}) && functional.in(frame, plane_orientation, [&](const gdcm::DataSet &group) {
		return numbers_of(group, image_orientation, directions, 6);
	});
	if (s.placed)
		for (int i = 0; i < 3; i++) {
			s.row.x[i] = directions[i];
			s.column.x[i] = directions[3 + i];
		}
	functional.in(frame, value_transformation, [&s](const gdcm::DataSet &scale) {
		double slope, intercept;
		if (numbers_of(scale, rescale_slope, &slope, 1) && slope != 0)
			s.slope = slope;
		if (numbers_of(scale, rescale_intercept, &intercept, 1))
			s.intercept = intercept;
	});
	return s;
}

/* Siemens keeps the slices of one volume as tiles of one image, the mosaic. */
struct mosaic {
	int slices = 0, tiles_a_row = 0;
	bool backwards = false; /* the slices go against the normal of their planes */
};

std::string csa_text(gdcm::CSAHeader &header, const char *name)
{
	if (!header.FindCSAElementByName(name))
		return "";
	const gdcm::CSAElement &element = header.GetCSAElementByName(name);
	const gdcm::ByteValue *value = element.IsEmpty() ? nullptr : element.GetByteValue();
	return value ? std::string(value->GetPointer(), value->GetLength()) : "";
}

mosaic mosaic_of(const gdcm::DataSet &data, const format &numbers, const slice &whole)
{
	mosaic m;
	const gdcm::PrivateTag &tag = gdcm::CSAHeader::GetCSAImageHeaderInfoTag();
	if (text_of(data, image_type).find("MOSAIC") == std::string::npos ||
	    !data.FindDataElement(tag))
		return m;
	gdcm::CSAHeader header;
	double count, normal[3];
	if (!header.LoadFromDataElement(data.GetDataElement(tag)) ||
	    !numbers_in(csa_text(header, "NumberOfImagesInMosaic"), &count, 1) || count < 2 ||
	    count > tiles_max)
		return m;
	m.tiles_a_row = (int)std::ceil(std::sqrt(count));
	if (numbers.columns % m.tiles_a_row != 0 || numbers.rows % m.tiles_a_row != 0)
		return mosaic();
	m.slices = (int)count;
	if (numbers_in(csa_text(header, "SliceNormalVector"), normal, 3)) {
		const vector3 told = { { normal[0], normal[1], normal[2] } };
		m.backwards = whole.placed && dot(told, cross(whole.row, whole.column)) < 0;
	}
	return m;
}

/* The slices of a mosaic. Where the stack begins does not matter: only directions are kept. */
void split_mosaic(const mosaic &m, head &out)
{
	const slice whole = out.slices[0];
	format &numbers = out.numbers;
	const vector3 normal = cross(whole.row, whole.column);
	const double length = std::sqrt(dot(normal, normal));
	const double gap = (numbers.thickness > 0 ? numbers.thickness : numbers.spacing[0]) /
			   (length > 0 ? length * length : 1);
	numbers.columns /= m.tiles_a_row;
	numbers.rows /= m.tiles_a_row;
	out.slices.clear();
	for (int k = 0; k < m.slices; k++) {
		slice s = whole;
		s.first_column = k % m.tiles_a_row * numbers.columns;
		s.first_row = k / m.tiles_a_row * numbers.rows;
		for (int i = 0; i < 3; i++)
			s.position.x[i] += (m.backwards ? -k : k) * gap * normal.x[i];
		if (!whole.placed)
			s.number = k;
		out.slices.push_back(s);
	}
}

/* An element or item as its bytes say it: tag and length. */
struct element_head {
	gdcm::Tag tag;
	uint64_t length;
};

uint32_t number_at(const unsigned char *bytes, int size, bool big_endian)
{
	uint32_t number = 0;
	for (int i = 0; i < size; i++)
		number = number << 8 | bytes[big_endian ? i : size - 1 - i];
	return number;
}

gdcm::Tag tag_at(const unsigned char *bytes, bool big_endian)
{
	return { (uint16_t)number_at(bytes, 2, big_endian),
		 (uint16_t)number_at(bytes + 2, 2, big_endian) };
}

bool read_item(std::istream &file, element_head &out)
{
	unsigned char bytes[8];
	if (!file.read((char *)bytes, sizeof bytes))
		return false;
	out = { tag_at(bytes, false), number_at(bytes + 4, 4, false) };
	return true;
}

/* Fragments of an encapsulated element, and the offsets of its table (PS3.5, A.4). */
struct fragments {
	std::vector<span> all;
	std::vector<uint32_t> table;
	uint64_t origin = 0; /* of the table's offsets */
};

bool read_table(std::istream &file, uint64_t length, fragments &out)
{
	if (length > 4 * fragments_max || length % 4 != 0)
		return false;
	std::vector<unsigned char> bytes(length);
	if (length > 0 && !file.read((char *)bytes.data(), (std::streamsize)length))
		return false;
	for (size_t i = 0; i < length; i += 4)
		out.table.push_back(number_at(&bytes[i], 4, false));
	return true;
}

bool read_fragments(std::istream &file, uint64_t file_size, fragments &out)
{
	element_head item { gdcm::Tag(), 0 };
	if (!read_item(file, item) || item.tag != item_tag || !read_table(file, item.length, out))
		return false;
	out.origin = (uint64_t)file.tellg();
	while (read_item(file, item)) {
		if (item.tag == sequence_end)
			return true;
		const auto at = (uint64_t)file.tellg();
		if (item.tag != item_tag || item.length > file_size - at ||
		    out.all.size() >= fragments_max)
			return false;
		out.all.push_back({ at, item.length });
		file.seekg((std::streamoff)item.length, std::ios::cur);
	}
	return false;
}

/* Whether a fragment begins a picture of JPEG, JPEG-LS or JPEG 2000. */
bool begins_picture(std::istream &file, const span &fragment)
{
	unsigned char bytes[2] = { 0, 0 };
	file.clear();
	file.seekg((std::streamoff)fragment.offset);
	return fragment.length >= 2 && file.read((char *)bytes, 2) && bytes[0] == 0xff &&
	       (bytes[1] == 0xd8 || bytes[1] == 0x4f);
}

/* Which fragments are whose frame: one each, or as the table or the pictures in them say. False if
 * nothing tells it. */
bool share_out(std::istream &file, const fragments &found, uint64_t count,
	       std::vector<std::vector<span>> &out)
{
	const bool one_each = found.all.size() == count;
	for (const span &fragment : found.all) {
		const uint64_t offset = fragment.offset - 8 - found.origin;
		const bool in_table = std::find(found.table.begin(), found.table.end(), offset) !=
				      found.table.end();
		const bool begins =
			out.empty() || one_each ||
			(count > 1 &&
			 (found.table.size() == count ? in_table : begins_picture(file, fragment)));
		if (begins)
			out.emplace_back();
		out.back().push_back(fragment);
	}
	return out.size() == count;
}

/* The head of the pixel element ends where the file is: its length, read backwards. */
bool find_pixel_element(std::istream &file, bool big_endian, uint32_t &length, bool &words)
{
	unsigned char bytes[12];
	const std::streamoff at = file.tellg();
	if (at < (std::streamoff)sizeof bytes)
		return false;
	file.seekg(at - (std::streamoff)sizeof bytes);
	if (!file.read((char *)bytes, sizeof bytes))
		return false;
	length = number_at(bytes + 8, 4, big_endian);
	words = !(bytes[4] == 'O' && bytes[5] == 'B');
	/* Explicit: tag, VR, 0, length. Implicit: tag, length, and it is always of words. */
	return tag_at(bytes, big_endian) == pixel_data ||
	       tag_at(bytes + 4, big_endian) == pixel_data;
}

/* Where the pixels lie; false if the file is damaged or cut off. */
bool locate_pixels(std::istream &file, uint64_t file_size, uint64_t frames, pixels_of_file &out)
{
	const bool big_endian = out.coding == gdcm::TransferSyntax::ExplicitVRBigEndian;
	uint32_t length = 0;
	bool words = false;
	file.clear();
	if (!find_pixel_element(file, big_endian, length, words))
		return false;
	const auto at = (uint64_t)file.tellg();
	out.encapsulated = length == undefined_length;
	if (out.encapsulated) {
		fragments found;
		if (!read_fragments(file, file_size, found))
			return false;
		return share_out(file, found, frames, out.frames) || frames > found.all.size();
	}
	out.plain = { at, length };
	const bool several_bytes = out.numbers.bits_allocated > 8;
	const bool numbers_big =
		big_endian || out.coding == gdcm::TransferSyntax::ImplicitVRBigEndianPrivateGE;
	out.swap_bytes = several_bytes ? numbers_big != gz_host_big_endian() : big_endian && words;
	return length <= file_size - at;
}

/* Whether a file of this kind must have pixels. */
bool is_of_images(const gdcm::File &file)
{
	gdcm::MediaStorage storage;
	return storage.SetFromFile(file) && gdcm::MediaStorage::IsImage(storage);
}

/* Read a file up to its pixels; all of it if it is deflated, because then no place in it is known.
 */
bool read_data_set(gdcm::Reader &reader, std::istream &file, uint64_t file_size, bool &deflated)
{
	reader.SetStream(file);
	const bool read = guarded_within(most_for_reading(file_size), [&] {
		return reader.ReadUpToTag(pixel_data, { pixel_data });
	});
	deflated = reader.GetFile().GetHeader().GetDataSetTransferSyntax() ==
		   gdcm::TransferSyntax::DeflatedExplicitVRLittleEndian;
	if (!deflated)
		return read;
	file.clear();
	file.seekg(0);
	reader.SetFile(*new gdcm::File);
	return guarded_within(most_for_reading(file_size * deflate_ratio),
			      [&] { return reader.Read(); });
}

void fill_head(const gdcm::DataSet &data, head &out)
{
	const groups functional(data);
	const std::string charset = text_of(data, character_set);
	out.series_uid = text_of(data, series_instance_uid);
	out.image_uid = text_of(data, image_instance_uid);
	out.patient = utf8_of(text_of(data, patient_name), charset, text_kind::name);
	out.date = utf8_of(text_of(data, study_date), "", text_kind::plain);
	out.description = utf8_of(text_of(data, series_description), charset, text_kind::plain);
	out.modality = utf8_of(text_of(data, modality), "", text_kind::plain);
	out.series_number = decimal_of(data, series_number, 0);
	out.numbers = format_of(data, functional);
	out.photometric = text_of(data, photometric_interpretation);
	const int claimed = decimal_of(data, number_of_frames, 1);
	out.frames = claimed < 1 ? 1 : (uint64_t)claimed;
	for (uint64_t frame = 0; frame < out.frames && frame <= frames_max; frame++) {
		format of_frame = out.numbers;
		out.slices.push_back(slice_of(data, functional, (uint32_t)frame));
		functional.in((uint32_t)frame, pixel_measures, [&](const gdcm::DataSet &measures) {
			take_measures(measures, of_frame);
		});
		out.of_one_size = out.of_one_size && of_frame == out.numbers;
	}
	place_dose(data, out);
	take_segments(data, out);
	/* If the private header is odd, the image stays whole. */
	mosaic m;
	(void)guarded([&] {
		m = mosaic_of(data, out.numbers, out.slices[0]);
		return true;
	});
	if (m.slices > 0 && out.frames == 1)
		split_mosaic(m, out);
}

bool read_head_of(std::istream &file, uint64_t file_size, head &out)
{
	gdcm::Reader reader;
	bool deflated = false;
	const bool sound = lengths_fit(file, file_size);
	file.clear();
	file.seekg(0);
	if (!sound || !read_data_set(reader, file, file_size, deflated)) {
		out.fault = head_fault::damaged;
		return false;
	}
	const gdcm::DataSet &data = reader.GetFile().GetDataSet();
	if (data.IsEmpty() || !data.FindDataElement(columns) || !data.FindDataElement(rows)) {
		out.fault =
			is_of_images(reader.GetFile()) ? head_fault::damaged : head_fault::no_image;
		return false;
	}
	fill_head(data, out);
	auto pixels = std::make_shared<pixels_of_file>();
	pixels->path = out.path;
	pixels->numbers = out.numbers;
	pixels->deflated = deflated;
	pixels->planar = short_of(data, planar_configuration, 0) == 1;
	pixels->halved = out.photometric == "YBR_FULL_422";
	if (out.numbers.colours == colour_kind::palette)
		pixels->table = palette_of(data, out.numbers.is_signed);
	pixels->coding = reader.GetFile().GetHeader().GetDataSetTransferSyntax();
	if (deflated) {
		const gdcm::ByteValue *value = value_of(data, pixel_data);
		pixels->plain = { 0, value ? (uint64_t)value->GetLength() : 0 };
		pixels->swap_bytes = out.numbers.bits_allocated > 8 && gz_host_big_endian();
	} else if (!locate_pixels(file, file_size, out.frames, *pixels)) {
		const bool floats =
			data.FindDataElement(float_pixels) || data.FindDataElement(double_pixels);
		out.fault = floats ? head_fault::of_floats : head_fault::damaged;
		return false;
	}
	out.bytes = pixels->encapsulated ? file_size * compression_ratio : pixels->plain.length;
	for (slice &s : out.slices)
		s.pixels = pixels;
	return true;
}

} // namespace

void silence_library()
{
	static std::once_flag once;
	std::call_once(once, [] {
		gdcm::Trace::DebugOff();
		gdcm::Trace::WarningOff();
		gdcm::Trace::ErrorOff();
	});
}

std::string text_of_fault(head_fault fault)
{
	switch (fault) {
	case head_fault::closed:
		return std::string("cannot be read: ") + strerror(EACCES) +
		       "; check its permissions";
	case head_fault::damaged:
		return "damaged or cut off; fetch it again";
	case head_fault::of_floats:
		return "its pixels are floating-point numbers, which are not read; convert it";
	default:
		return "no DICOM image; name a file that holds one, or its folder";
	}
}

bool read_head(const std::string &name, head &out)
{
	struct stat status;
	out.fault = head_fault::no_image;
	if (stat(name.c_str(), &status) != 0 || !S_ISREG(status.st_mode))
		return false;
	std::ifstream file(name, std::ios::binary);
	out.path = name;
	if (!file) {
		out.fault = head_fault::closed;
		return false;
	}
	/* What is false without a word is no image; else it may be half read. */
	bool ended = false, found = false;
	try {
		(void)guarded([&] {
			found = read_head_of(file, (uint64_t)status.st_size, out);
			ended = true;
			return true;
		});
	} catch (const std::bad_alloc &) {
		ended = false; /* a length that nothing can hold */
	}
	if (ended && found) {
		out.fault = head_fault::none;
		return true;
	}
	if (!ended)
		out.fault = head_fault::damaged;
	if (out.fault == head_fault::damaged && !gz_dicom_is(name.c_str()))
		out.fault = head_fault::no_image;
	return false;
}

} // namespace gz_dicom
