#include "render/decode/dicom/dicom_frame.hpp"

#include <algorithm>
#include <cstring>
#include <fstream>

#include <gdcmDataElement.h>
#include <gdcmFragment.h>
#include <gdcmImage.h>
#include <gdcmJPEG2000Codec.h>
#include <gdcmReader.h>
#include <gdcmSequenceOfFragments.h>

#include "render/decode/dicom/dicom_elements.hpp"
#include "render/decode/dicom/dicom_guard.hpp"

namespace gz_dicom
{

namespace
{

/* Frames up to this size are decoded by one thread. Chosen: the memory limit of slice_pool still
 * lets eight of them be decoded at a time. */
const uint64_t alone_pixels = (uint64_t)1 << 22;

/* What a frame in RLE begins with: the number of segments and where each lies
 * (PS3.5, G.5). The library believes them. */
bool rle_head_valid(const std::vector<char> &bytes, int bytes_a_pixel)
{
	const size_t head = 64;
	if (bytes.size() < head)
		return false;
	uint32_t numbers[16], before = 0;
	for (size_t i = 0; i < 16; i++) {
		const auto *at = (const unsigned char *)&bytes[4 * i];
		numbers[i] = at[0] | (uint32_t)at[1] << 8 | (uint32_t)at[2] << 16 |
			     (uint32_t)at[3] << 24;
	}
	if (numbers[0] != (uint32_t)bytes_a_pixel || numbers[1] != head)
		return false;
	for (uint32_t i = 1; i <= numbers[0]; i++) {
		if (numbers[i] <= before || numbers[i] >= bytes.size())
			return false;
		before = numbers[i];
	}
	return true;
}

/* Turn the bytes of each number round; bytes that are numbers by themselves, two by two, because
 * they are stored in words. */
void swap_numbers(std::vector<uint8_t> &bytes, int bits)
{
	const size_t size = bits == 32 ? 4 : 2;
	for (size_t i = 0; i + size <= bytes.size(); i += size)
		std::reverse(&bytes[i], &bytes[i] + size);
}

bool read_spans(const std::string &path, const std::vector<span> &spans, std::vector<char> &out)
{
	std::ifstream file(path, std::ios::binary);
	uint64_t size = 0;
	for (const span &s : spans)
		size += s.length;
	out.resize(size);
	size_t at = 0;
	for (const span &s : spans) {
		file.seekg((std::streamoff)s.offset);
		if (s.length > 0 && !file.read(&out[at], (std::streamsize)s.length))
			return false;
		at += s.length;
	}
	return (bool)file;
}

gdcm::DataElement element_of(const std::vector<char> &bytes)
{
	gdcm::Fragment fragment;
	fragment.SetByteValue(bytes.data(), gdcm::VL((uint32_t)bytes.size()));
	gdcm::SmartPointer<gdcm::SequenceOfFragments> fragments = new gdcm::SequenceOfFragments;
	fragments->AddFragment(fragment);
	gdcm::DataElement element(pixel_data);
	element.SetVR(gdcm::VR::OB);
	element.SetValue(*fragments);
	return element;
}

/* What the library is told of the numbers: it leaves all of them as they are. */
gdcm::PhotometricInterpretation photometric_of(const format &n)
{
	using kinds = gdcm::PhotometricInterpretation;
	return n.samples == 1                  ? kinds::MONOCHROME2
	       : n.colours == colour_kind::ybr ? kinds::YBR_FULL
					       : kinds::RGB;
}

gdcm::PixelFormat stored_format(const format &n)
{
	return gdcm::PixelFormat((uint16_t)n.samples, (uint16_t)n.bits_allocated,
				 (uint16_t)n.bits_stored, (uint16_t)n.high_bit,
				 n.is_signed ? 1 : 0);
}

/* Whether the numbers that a codec gave are as the head says: it may find others in the stream. */
bool numbers_agree(const gdcm::PixelFormat &found, const format &n)
{
	return found.GetBitsAllocated() == n.bits_allocated &&
	       found.GetSamplesPerPixel() == n.samples;
}

bool is_jpeg_2000(gdcm::TransferSyntax::TSType coding)
{
	using ts = gdcm::TransferSyntax;
	return coding == ts::JPEG2000Lossless || coding == ts::JPEG2000 ||
	       coding == ts::JPEG2000Part2Lossless || coding == ts::JPEG2000Part2;
}

/* One grey frame by the codec itself: an image would start a thread for each processor, for each of
 * the frames that are decoded side by side. Large frames get them: memory limits how many of those
 * are decoded at a time. */
bool decode_jpeg_2000(const format &n, const std::vector<char> &bytes, std::vector<uint8_t> &out)
{
	const unsigned dims[3] = { (unsigned)n.frame_columns, (unsigned)n.frame_rows, 1 };
	gdcm::JPEG2000Codec codec;
	codec.SetNumberOfThreadsForDecompression(n.frame_pixels() > alone_pixels ? -1 : 0);
	codec.SetPixelFormat(stored_format(n));
	codec.SetNumberOfDimensions(2);
	codec.SetDimensions(dims);
	codec.SetPhotometricInterpretation(photometric_of(n));
	gdcm::DataElement decoded;
	if (!codec.Decode(element_of(bytes), decoded))
		return false;
	const gdcm::ByteValue *value = decoded.GetByteValue();
	if (!value || value->GetLength() < out.size() || !numbers_agree(codec.GetPixelFormat(), n))
		return false;
	const auto *numbers = (const uint8_t *)value->GetPointer();
	/* Of up to 8 bits the codec gives bytes, even if 16 are allocated. */
	if (n.bits_allocated == 16 && codec.GetPixelFormat().GetBitsStored() <= 8)
		std::copy_n(numbers, out.size() / 2, (uint16_t *)(void *)out.data());
	else
		std::memcpy(out.data(), numbers, out.size());
	return true;
}

/* One frame, told to the library as an image of its own. */
bool decode_picture(const pixels_of_file &pixels, const std::vector<char> &bytes,
		    std::vector<uint8_t> &out)
{
	const format &n = pixels.numbers;
	if (is_jpeg_2000(pixels.coding) && n.samples == 1 && n.bits_allocated <= 16)
		return decode_jpeg_2000(n, bytes, out);
	gdcm::Image image;
	image.SetNumberOfDimensions(2);
	image.SetDimension(0, (unsigned)n.frame_columns);
	image.SetDimension(1, (unsigned)n.frame_rows);
	image.SetPixelFormat(stored_format(n));
	image.SetPhotometricInterpretation(photometric_of(n));
	image.SetTransferSyntax(gdcm::TransferSyntax(pixels.coding));
	image.SetDataElement(element_of(bytes));
	if (image.GetBufferLength() != out.size() || !image.GetBuffer((char *)out.data()))
		return false;
	return numbers_agree(image.GetPixelFormat(), n);
}

bool is_supported(gdcm::TransferSyntax::TSType coding)
{
	using ts = gdcm::TransferSyntax;
	switch (coding) {
	case ts::JPEGBaselineProcess1:
	case ts::JPEGExtendedProcess2_4:
	case ts::JPEGExtendedProcess3_5:
	case ts::JPEGSpectralSelectionProcess6_8:
	case ts::JPEGFullProgressionProcess10_12:
	case ts::JPEGLosslessProcess14:
	case ts::JPEGLosslessProcess14_1:
	case ts::JPEGLSLossless:
	case ts::JPEGLSNearLossless:
	case ts::JPEG2000Lossless:
	case ts::JPEG2000:
	case ts::JPEG2000Part2Lossless:
	case ts::JPEG2000Part2:
	case ts::RLELossless:
		return true;
	default:
		return false;
	}
}

gz_result decode_fragments(const pixels_of_file &pixels, uint32_t frame, std::vector<uint8_t> &out,
			   std::string &why)
{
	const gdcm::TransferSyntax coding(pixels.coding);
	const char *name = coding.GetString();
	const std::string kind = name ? name : "of an unknown kind";
	std::vector<char> bytes;
	if (!is_supported(pixels.coding)) {
		why = "its pixels, " + kind +
		      ", cannot be decoded; convert it, for instance with "
		      "gdcmconv --raw";
		return GZ_ERR_UNSUPPORTED;
	}
	if (frame < pixels.frames.size() && !read_spans(pixels.path, pixels.frames[frame], bytes)) {
		why = "cannot be read again; was it moved?";
		return GZ_ERR_IO;
	}
	const bool rle = pixels.coding == gdcm::TransferSyntax::RLELossless;
	const int bytes_a_pixel = pixels.numbers.samples * pixels.numbers.bits_allocated / 8;
	if (bytes.empty() || (rle && !rle_head_valid(bytes, bytes_a_pixel)) ||
	    !guarded([&] { return decode_picture(pixels, bytes, out); })) {
		why = "its pixels, " + kind + ", are damaged; fetch it again";
		return GZ_ERR_FORMAT;
	}
	return GZ_OK;
}

/* A deflated file has no places: it is read again as a whole. */
bool read_deflated(const pixels_of_file &pixels, uint64_t at, std::vector<uint8_t> &out)
{
	gdcm::Reader reader;
	reader.SetFileName(pixels.path.c_str());
	if (!reader.Read() || !reader.GetFile().GetDataSet().FindDataElement(pixel_data))
		return false;
	const gdcm::ByteValue *value =
		reader.GetFile().GetDataSet().GetDataElement(pixel_data).GetByteValue();
	if (!value || at > value->GetLength() || out.size() > value->GetLength() - at)
		return false;
	std::memcpy(out.data(), value->GetPointer() + at, out.size());
	return true;
}

bool read_plain(const pixels_of_file &pixels, uint64_t at, std::vector<uint8_t> &out)
{
	std::ifstream file(pixels.path, std::ios::binary);
	if (at > pixels.plain.length || out.size() > pixels.plain.length - at)
		return false;
	file.seekg((std::streamoff)(pixels.plain.offset + at));
	return (bool)file.read((char *)out.data(), (std::streamsize)out.size());
}

/* Single bits, the first in the lowest place of its byte, as bytes of 0 and 1. Frames follow each
 * other without a gap. */
void unpack_bits(const std::vector<uint8_t> &bytes, uint64_t first, std::vector<uint8_t> &out)
{
	for (size_t i = 0; i < out.size(); i++)
		out[i] = bytes[(first + i) / 8] >> (first + i) % 8 & 1;
}

/* A frame of single bits: the words that hold it. */
bool read_bits(const pixels_of_file &pixels, uint32_t frame, std::vector<uint8_t> &out)
{
	const uint64_t bit = frame * pixels.numbers.frame_pixels();
	const uint64_t first = bit / 16 * 2;
	const uint64_t end = std::min((bit + out.size() + 15) / 16 * 2, pixels.plain.length);
	if (end <= first || bit + out.size() > 8 * end)
		return false;
	std::vector<uint8_t> bytes(end - first);
	const bool read = pixels.deflated
				  ? guarded([&] { return read_deflated(pixels, first, bytes); })
				  : read_plain(pixels, first, bytes);
	if (!read)
		return false;
	if (pixels.swap_bytes)
		swap_numbers(bytes, 16);
	unpack_bits(bytes, bit - 8 * first, out);
	return true;
}

bool read_numbers(const pixels_of_file &pixels, uint32_t frame, std::vector<uint8_t> &out)
{
	const uint64_t at = frame * pixels.numbers.frame_bytes();
	const bool read = pixels.deflated ? guarded([&] { return read_deflated(pixels, at, out); })
					  : read_plain(pixels, at, out);
	if (read && pixels.swap_bytes)
		swap_numbers(out, pixels.numbers.bits_allocated);
	return read;
}

/* Decode the numbers of a frame. */
gz_result decode_numbers(const pixels_of_file &pixels, uint32_t frame, std::vector<uint8_t> &out,
			 std::string &why)
{
	const uint64_t size = pixels.numbers.frame_bytes();
	out.assign(size, 0);
	if (pixels.encapsulated)
		return decode_fragments(pixels, frame, out, why);
	const bool bits = pixels.numbers.bits_allocated == 1;
	if (!(bits ? read_bits(pixels, frame, out) : read_numbers(pixels, frame, out))) {
		why = "cannot be read again; was it moved or changed?";
		return GZ_ERR_IO;
	}
	return GZ_OK;
}

} // namespace

gz_result decode_frame(const pixels_of_file &pixels, uint32_t frame, std::vector<uint8_t> &out,
		       std::string &why)
{
	const gz_result result = decode_numbers(pixels, frame, out, why);
	/* Decoded colours are pixel by pixel, as the library was told. */
	if (result == GZ_OK && pixels.numbers.colours != colour_kind::none)
		out = colours_of(pixels, out, pixels.planar && !pixels.encapsulated);
	return result;
}

} // namespace gz_dicom
