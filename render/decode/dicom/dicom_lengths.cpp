#include "render/decode/dicom/dicom_lengths.hpp"

#include <algorithm>
#include <cctype>
#include <cstring>
#include <string>

namespace gz_dicom
{

namespace
{

/* Sequences within each other (chosen: files have a few). */
const int depth_max = 128;

const uint32_t tag_of_pixels = 0x7fe00010, tag_of_item = 0xfffee000, tag_of_item_end = 0xfffee00d,
	       tag_of_sequence_end = 0xfffee0dd, tag_of_transfer_syntax = 0x00020010;

/* Bytes of the head of an item. */
const uint32_t item_head = 8;

/* How the elements of a data set are written (PS3.5, 7.1). */
struct encoding {
	bool explicit_vr, big_endian;
};

struct element {
	uint32_t tag, length;
	bool sequence;   /* of items, which are data sets; not of fragments of pixels */
	bool maybe;      /* of an unknown kind, which may be a sequence */
	encoding inside; /* of the items */
};

/* What walking through a data set found. */
enum class verdict { fits, too_long, too_deep, unclear };

/* What one data set or sequence may take up: places in the file. */
struct room {
	uint64_t end;   /* where it ends, if it says so itself, else where what encloses it ends */
	uint64_t limit; /* what no length within may exceed */
	bool of_own_size; /* it says itself where it ends, and no delimiter does */
};

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
	verdict elements(const encoding &as, const room &within, int depth);
	verdict items(const element &sequence, const room &within, int depth);
	verdict item_inside(const element &e, const element &sequence, const room &within,
			    int depth);
	verdict value(const element &e, const room &within, int depth);
	verdict beyond(verdict inside, uint64_t end);
	uint64_t place();
	bool fits(uint32_t length, uint64_t limit);
	bool item_follows(const encoding &as);
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

/* Where the next byte lies; the end of the file if that cannot be told. */
uint64_t walk::place()
{
	const std::streamoff at = file.tellg();
	return at >= 0 ? std::min(file_size, (uint64_t)at) : file_size;
}

bool walk::fits(uint32_t length, uint64_t limit)
{
	const uint64_t at = place();
	return at <= limit && length <= limit - at;
}

/* Whether an item begins here. The place stays. */
bool walk::item_follows(const encoding &as)
{
	unsigned char bytes[4];
	const std::streamoff at = file.tellg();
	const bool found = read(bytes, sizeof bytes) &&
			   number(bytes, 2, as.big_endian) == tag_of_item >> 16 &&
			   number(bytes + 2, 2, as.big_endian) == (tag_of_item & 0xffff);
	file.clear();
	file.seekg(at);
	return found;
}

void walk::skip(uint32_t length)
{
	file.seekg((std::streamoff)length, std::ios::cur);
}

/* Tag and length of the next element; false at the end, or where there is none. A value of unknown
 * kind may be a sequence, and is one if its length is unknown, too; it is written implicitly
 * (PS3.5, 6.2.2). */
bool walk::read_element(const encoding &as, element &out)
{
	unsigned char bytes[8], length[4];
	if (!read(bytes, sizeof bytes))
		return false;
	out.tag = number(bytes, 2, as.big_endian) << 16 | number(bytes + 2, 2, as.big_endian);
	out.length = number(bytes + 4, 4, as.big_endian);
	out.inside = as;
	out.sequence = out.length == undefined_length && out.tag != tag_of_pixels;
	out.maybe = !as.explicit_vr;
	if (!as.explicit_vr || out.tag >> 16 == 0xfffe)
		return true;
	const char vr[3] = { (char)bytes[4], (char)bytes[5], 0 };
	if (!std::isupper(bytes[4]) || !std::isupper(bytes[5]))
		return false;
	static const char long_ones[] = "OB OD OF OL OV OW SQ SV UC UN UR UT UV";
	out.sequence = std::strcmp(vr, "SQ") == 0;
	if (!std::strstr(long_ones, vr)) {
		out.length = number(bytes + 6, 2, as.big_endian);
		return true;
	}
	if (!read(length, sizeof length))
		return false;
	out.length = number(length, 4, as.big_endian);
	if (std::strcmp(vr, "UN") == 0) {
		out.sequence = out.length == undefined_length;
		out.maybe = true;
		out.inside.explicit_vr = false;
	}
	return true;
}

/* What is unclear within something that says where it ends is left out. */
verdict walk::beyond(verdict inside, uint64_t end)
{
	if (inside != verdict::unclear)
		return inside;
	file.clear();
	file.seekg((std::streamoff)end);
	return verdict::fits;
}

/* What lies in an item of a sequence. An item that says its size may be wrong in it, as those of
 * some makers are: the library knows them. Its elements must fit into the sequence. */
verdict walk::item_inside(const element &e, const element &sequence, const room &within, int depth)
{
	if (depth >= depth_max)
		return verdict::too_deep;
	if (e.length == undefined_length)
		return elements(sequence.inside, { within.end, within.limit, false }, depth + 1);
	const uint64_t end = place() + e.length;
	const verdict inside = elements(sequence.inside, { end, within.limit, true }, depth + 1);
	return beyond(inside, end);
}

verdict walk::items(const element &sequence, const room &within, int depth)
{
	while (!within.of_own_size || place() < within.end) {
		element e {};
		if (!read_element(sequence.inside, e))
			return verdict::unclear;
		if (e.tag == tag_of_sequence_end && !within.of_own_size)
			return verdict::fits;
		if (e.tag != tag_of_item)
			return verdict::unclear;
		if (e.length != undefined_length && !fits(e.length, within.limit))
			return verdict::too_long;
		if (!sequence.sequence) { /* fragments of pixels */
			if (e.length == undefined_length)
				return verdict::unclear;
			skip(e.length);
			continue;
		}
		const verdict inside = item_inside(e, sequence, within, depth);
		if (inside != verdict::fits)
			return inside;
	}
	return verdict::fits;
}

verdict walk::value(const element &e, const room &within, int depth)
{
	if (e.length == undefined_length)
		return items(e, { within.end, within.limit, false }, depth);
	if (!fits(e.length, within.limit))
		return verdict::too_long;
	element sequence = e;
	/* Nobody asks for the sequences of makers, which are of odd groups. */
	sequence.sequence = e.sequence || (e.maybe && e.length >= item_head &&
					   (e.tag >> 16) % 2 == 0 && item_follows(e.inside));
	if (!sequence.sequence) {
		skip(e.length);
		return verdict::fits;
	}
	const uint64_t end = place() + e.length;
	const verdict inside = items(sequence, { end, end, true }, depth);
	return beyond(inside, end);
}

verdict walk::elements(const encoding &as, const room &within, int depth)
{
	while (!within.of_own_size || place() < within.end) {
		element e {};
		if (!read_element(as, e))
			return verdict::unclear;
		if (depth > 0 && !within.of_own_size && e.tag == tag_of_item_end)
			return verdict::fits;
		if (depth == 0 && e.tag >= tag_of_pixels)
			return verdict::fits; /* where the pixels lie is checked later */
		const verdict inside = value(e, within, depth);
		if (inside != verdict::fits)
			return inside;
	}
	return within.end == place() ? verdict::fits : verdict::unclear;
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
		if (!fits(e.length, file_size))
			return verdict::too_long;
		if (e.tag == tag_of_transfer_syntax && e.length <= 64) {
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
	return elements(as, { file_size, file_size, false }, 0);
}

} // namespace

bool lengths_fit(std::istream &file, uint64_t file_size)
{
	const verdict found = walk(file, file_size).whole();
	return found != verdict::too_long && found != verdict::too_deep;
}

} // namespace gz_dicom
