#include "render/decode/dicom/dicom_colour.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "render/decode/dicom/dicom_file.hpp"

namespace gz_dicom
{

namespace
{

/* Most entries of a table (PS3.3, C.7.6.3.1.5: 0 stands for it). */
const int entries_max = 65536;

const gdcm::Tag descriptors[3] = { { 0x0028, 0x1101 }, { 0x0028, 0x1102 }, { 0x0028, 0x1103 } };
const gdcm::Tag tables[3] = { { 0x0028, 0x1201 }, { 0x0028, 0x1202 }, { 0x0028, 0x1203 } };

std::vector<uint16_t> words_of(const gdcm::DataSet &data, const gdcm::Tag &tag)
{
	const gdcm::ByteValue *value =
		data.FindDataElement(tag) ? data.GetDataElement(tag).GetByteValue() : nullptr;
	std::vector<uint16_t> words(value ? value->GetLength() / sizeof(uint16_t) : 0);
	if (!words.empty())
		std::memcpy(words.data(), value->GetPointer(), words.size() * sizeof words[0]);
	return words;
}

/* `count` entries of a table, to 8 bits. They are words, or two of 8 bits in a word, the lower one
 * first. Some writers tell 16 bits and fill 8. */
bool entries_of(const std::vector<uint16_t> &words, size_t count, int bits,
		std::vector<uint8_t> &out)
{
	const bool packed = words.size() < count;
	if (words.size() < (packed ? (count + 1) / 2 : count) || (packed && bits != 8))
		return false;
	const bool wide = bits == 16 && *std::max_element(words.begin(), words.end()) > 255;
	out.resize(count);
	for (size_t i = 0; i < count; i++) {
		const uint16_t word = words[packed ? i / 2 : i];
		const int shift = packed ? (int)(i % 2) * 8 : wide ? 8 : 0;
		out[i] = (uint8_t)(word >> shift);
	}
	return true;
}

uint8_t to_byte(double x)
{
	return (uint8_t)std::lround(std::min(255.0, std::max(0.0, x)));
}

/* PS3.3, C.7.6.3.1.2: YBR_FULL, solved for red, green and blue. */
void from_ybr(const uint8_t ybr[3], uint8_t rgb[3])
{
	const double y = ybr[0], blue = ybr[1] - 128.0, red = ybr[2] - 128.0;
	rgb[0] = to_byte(y + 1.402 * red);
	rgb[1] = to_byte(y - 0.344136 * blue - 0.714136 * red);
	rgb[2] = to_byte(y + 1.772 * blue);
}

/* A stored value of a palette image; other bits are masked out. */
int stored_value(const format &n, const std::vector<uint8_t> &stored, size_t pixel)
{
	uint16_t raw = stored[pixel];
	if (n.bits_allocated == 16)
		std::memcpy(&raw, &stored[2 * pixel], sizeof raw);
	const uint32_t bits = raw >> (n.high_bit + 1 - n.bits_stored);
	const uint32_t sign = n.is_signed ? 1U << (n.bits_stored - 1) : 0;
	return (int)((bits & ((1U << n.bits_stored) - 1)) ^ sign) - (int)sign;
}

void from_palette(const palette &table, int value, uint8_t rgb[3])
{
	const int last = (int)(table.rgb.size() / 3) - 1;
	const int entry = std::min(std::max(value - table.first, 0), last);
	std::memcpy(rgb, &table.rgb[3 * (size_t)entry], 3);
}

} // namespace

colour_kind colour_kind_of(const std::string &photometric)
{
	static const struct {
		const char *name;
		colour_kind kind;
	} kinds[] = {
		{ "", colour_kind::none },
		{ "MONOCHROME1", colour_kind::none },
		{ "MONOCHROME2", colour_kind::none },
		{ "RGB", colour_kind::rgb },
		/* whose transforms are those of JPEG 2000 */
		{ "YBR_RCT", colour_kind::rgb },
		{ "YBR_ICT", colour_kind::rgb },
		{ "YBR_FULL", colour_kind::ybr },
		{ "YBR_FULL_422", colour_kind::ybr },
		{ "PALETTE COLOR", colour_kind::palette },
	};
	for (const auto &k : kinds)
		if (photometric == k.name)
			return k.kind;
	return colour_kind::other;
}

palette palette_of(const gdcm::DataSet &data, bool is_signed)
{
	palette table;
	std::vector<uint8_t> channels[3];
	size_t count = 0;
	for (int i = 0; i < 3; i++) {
		const std::vector<uint16_t> descriptor = words_of(data, descriptors[i]);
		if (descriptor.size() < 3)
			return {};
		const size_t entries = descriptor[0] == 0 ? entries_max : descriptor[0];
		const int bits = descriptor[2];
		if ((i > 0 && entries != count) || (bits != 8 && bits != 16) ||
		    !entries_of(words_of(data, tables[i]), entries, bits, channels[i]))
			return {};
		count = entries;
		/* Red speaks for all. */
		if (i == 0)
			table.first = is_signed ? (int16_t)descriptor[1] : descriptor[1];
	}
	for (size_t i = 0; i < count; i++)
		for (const std::vector<uint8_t> &channel : channels)
			table.rgb.push_back(channel[i]);
	return table;
}

std::vector<uint8_t> colours_of(const pixels_of_file &pixels, const std::vector<uint8_t> &stored,
				bool planar)
{
	const format &n = pixels.numbers;
	const size_t count = (size_t)n.frame_columns * (size_t)n.frame_rows;
	const size_t from_pixel = planar ? 1 : 3, from_channel = planar ? count : 1;
	std::vector<uint8_t> rgb(3 * count);
	for (size_t i = 0; i < count; i++) {
		uint8_t *out = &rgb[3 * i];
		if (n.colours == colour_kind::palette) {
			from_palette(pixels.table, stored_value(n, stored, i), out);
			continue;
		}
		uint8_t numbers[3];
		for (size_t channel = 0; channel < 3; channel++)
			numbers[channel] = stored[i * from_pixel + channel * from_channel];
		if (n.colours == colour_kind::ybr)
			from_ybr(numbers, out);
		else
			std::memcpy(out, numbers, 3);
	}
	return rgb;
}

} // namespace gz_dicom
