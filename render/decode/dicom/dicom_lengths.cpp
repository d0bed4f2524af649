#include "render/decode/dicom/dicom_lengths.hpp"

#include <algorithm>
#include <cctype>
#include <cstring>
#include <string>

namespace gz_dicom
{

namespace
{

const uint32_t undefined_length = 0xffffffff;

/* Sequences within each other (chosen: files have a few). */
const int depth_max = 32;

const uint32_t pixel_data = 0x7fe00010, item = 0xfffee000, item_end = 0xfffee00d,
	       sequence_end = 0xfffee0dd, transfer_syntax = 0x00020010;

/* How the elements of a data set are written (PS3.5, 7.1). */
struct encoding {
	bool explicit_vr, big_endian;
};

struct element {
	uint32_t tag, length;
};

/* What walking through a data set found. */
enum class verdict { fits, too_long, unclear };

class walk
{
      public:
	walk(std::istream &of, uint64_t size) : file(of), file_size(size)
	{
	}
	verdict whole();

      private:
	uint32_t number(const unsigned char *bytes, int size, bool big_endian) const;
	bool read(unsigned char *bytes, size_t size);
	bool read_element(const encoding &as, element &out);
	verdict meta(std::string &out_syntax);
	verdict elements(const encoding &as, bool nested, int depth);
	verdict items(const encoding &as, int depth);
	verdict value(const encoding &as, const element &e, int depth);
	bool fits(uint32_t length);
	void skip(uint32_t length);

	std::istream &file;
	const uint64_t file_size;
};

bool walk::read(unsigned char *bytes, size_t size)
{
	return (bool)file.read((char *)bytes, (std::streamsize)size);
}

uint32_t walk::number(const unsigned char *bytes, int size, bool big_endian) const
{
	uint32_t value = 0;
	for (int i = 0; i < size; i++)
		value = value << 8 | bytes[big_endian ? i : size - 1 - i];
	return value;
}

bool walk::fits(uint32_t length)
{
	const std::streamoff at = file.tellg();
	return at >= 0 && length <= file_size - std::min(file_size, (uint64_t)at);
}

void walk::skip(uint32_t length)
{
	file.seekg((std::streamoff)length, std::ios::cur);
}

/* Tag and length of the next element; false at the end, or where there is none. */
bool walk::read_element(const encoding &as, element &out)
{
	unsigned char bytes[8], length[4];
	if (!read(bytes, sizeof bytes))
		return false;
	out.tag = number(bytes, 2, as.big_endian) << 16 | number(bytes + 2, 2, as.big_endian);
	out.length = number(bytes + 4, 4, as.big_endian);
	if (!as.explicit_vr || out.tag >> 16 == 0xfffe)
		return true;
	const char vr[3] = { (char)bytes[4], (char)bytes[5], 0 };
	if (!std::isupper(bytes[4]) || !std::isupper(bytes[5]))
		return false;
	static const char long_ones[] = "OB OD OF OL OV OW SQ SV UC UN UR UT UV";
	if (!std::strstr(long_ones, vr)) {
		out.length = number(bytes + 6, 2, as.big_endian);
		return true;
	}
	if (!read(length, sizeof length))
		return false;
	out.length = number(length, 4, as.big_endian);
	return true;
}

verdict walk::items(const encoding &as, int depth)
{
	for (element e {}; read_element(as, e);) {
		if (e.tag == sequence_end)
			return verdict::fits;
		if (e.tag != item || depth >= depth_max)
			return verdict::unclear;
		if (e.length != undefined_length) {
			if (!fits(e.length))
				return verdict::too_long;
			skip(e.length);
			continue;
		}
		const verdict inside = elements(as, true, depth + 1);
		if (inside != verdict::fits)
			return inside;
	}
	return verdict::unclear;
}

verdict walk::value(const encoding &as, const element &e, int depth)
{
	if (e.length != undefined_length) {
		if (!fits(e.length))
			return verdict::too_long;
		skip(e.length);
		return verdict::fits;
	}
	return items(as, depth);
}

verdict walk::elements(const encoding &as, bool nested, int depth)
{
	for (element e {}; read_element(as, e);) {
		if (nested && e.tag == item_end)
			return verdict::fits;
		if (!nested && e.tag >= pixel_data)
			return verdict::fits; /* where the pixels lie is checked later */
		const verdict inside = value(as, e, depth);
		if (inside != verdict::fits)
			return inside;
	}
	return verdict::unclear;
}

/* The meta header, always explicit and little-endian (PS3.10, 7.1): the transfer syntax in it. */
verdict walk::meta(std::string &out_syntax)
{
	const encoding as { true, false };
	for (;;) {
		const std::streamoff at = file.tellg();
		element e {};
		if (!read_element(as, e))
			return verdict::unclear;
		if (e.tag >> 16 != 2) {
			file.seekg(at);
			return verdict::fits;
		}
		if (!fits(e.length))
			return verdict::too_long;
		if (e.tag == transfer_syntax && e.length <= 64) {
			out_syntax.resize(e.length);
			if (!read((unsigned char *)&out_syntax[0], e.length))
				return verdict::unclear;
			out_syntax.resize(std::strlen(out_syntax.c_str()));
		} else {
			skip(e.length);
		}
	}
}

verdict walk::whole()
{
	unsigned char start[132];
	std::string syntax;
	encoding as { true, false };
	const bool preamble = read(start, sizeof start) && std::memcmp(start + 128, "DICM", 4) == 0;
	file.clear();
	file.seekg(preamble ? 132 : 0);
	const verdict head = preamble ? meta(syntax) : verdict::fits;
	if (head != verdict::fits)
		return head;
	if (!preamble)
		as.explicit_vr = std::isupper(start[4]) && std::isupper(start[5]);
	else if (syntax == "1.2.840.10008.1.2.1.99")
		return verdict::unclear; /* deflated */
	else
		as = { syntax != "1.2.840.10008.1.2" && syntax != "1.2.840.113619.5.2",
		       syntax == "1.2.840.10008.1.2.2" };
	return elements(as, false, 0);
}

} // namespace

bool lengths_fit(std::istream &file, uint64_t file_size)
{
	return walk(file, file_size).whole() != verdict::too_long;
}

} // namespace gz_dicom
