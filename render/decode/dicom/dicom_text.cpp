#include "render/decode/dicom/dicom_text.hpp"

#include <cerrno>
#include <cstring>
#include <iconv.h>
#include <vector>

#include "base/utf8.h"

namespace gz_dicom
{

namespace
{

/* How the C library names the codes, in the order of enum code. */
enum code {
	ASCII_OR_UTF8,
	LATIN_1,
	LATIN_2,
	LATIN_3,
	LATIN_4,
	CYRILLIC,
	ARABIC,
	GREEK,
	HEBREW,
	LATIN_5,
	LATIN_9,
	THAI,
	KATAKANA,
	KANJI,
	KOREAN,
	CHINESE,
	GB18030,
	CODES
};
const char *const iconv_names[CODES] = { "UTF-8",      "ISO-8859-1", "ISO-8859-2",  "ISO-8859-3",
					 "ISO-8859-4", "ISO-8859-5", "ISO-8859-6",  "ISO-8859-7",
					 "ISO-8859-8", "ISO-8859-9", "ISO-8859-15", "TIS-620",
					 "SHIFT_JIS",  "EUC-JP",     "EUC-KR",      "GB2312",
					 "GB18030" };

/* Defined terms of Specific Character Set end in these (PS3.3, C.12.1.1.2), and escape sequences
 * switch to them (PS3.3, tables C.12-3 and C.12-4). JIS X 0201 is what Shift-JIS writes in single
 * bytes. */
struct term {
	const char *ending;
	code first;
	const char *escape;
};
const term terms[] = {
	{ "IR 6", ASCII_OR_UTF8, "(B" }, { "IR 100", LATIN_1, "-A" },
	{ "IR 101", LATIN_2, "-B" },     { "IR 109", LATIN_3, "-C" },
	{ "IR 110", LATIN_4, "-D" },     { "IR 144", CYRILLIC, "-L" },
	{ "IR 127", ARABIC, "-G" },      { "IR 126", GREEK, "-F" },
	{ "IR 138", HEBREW, "-H" },      { "IR 148", LATIN_5, "-M" },
	{ "IR 203", LATIN_9, "-b" },     { "IR 166", THAI, "-T" },
	{ "IR 13", KATAKANA, ")I" },     { "IR 14", KATAKANA, "(J" },
	{ "IR 87", KANJI, "$B" },        { "IR 149", KOREAN, "$)C" },
	{ "IR 58", CHINESE, "$)A" },     { "IR 192", ASCII_OR_UTF8, "%G" },
	{ "GB18030", GB18030, nullptr }, { "GBK", GB18030, nullptr },
};

iconv_t converters[CODES];
bool prepared = false;

bool ends_in(const std::string &text, const char *ending)
{
	const size_t length = std::strlen(ending);
	return text.size() >= length && text.compare(text.size() - length, length, ending) == 0;
}

/* The code that texts begin in: that of the first value, which may be empty. */
code first_code(const std::string &charset)
{
	std::string value = charset.substr(0, charset.find('\\'));
	value.resize(value.find_last_not_of(' ') + 1);
	for (const term &t : terms)
		if (!value.empty() && ends_in(value, t.ending) && t.first != KANJI)
			return t.first;
	return ASCII_OR_UTF8; /* also before an escape sequence switches to kanji */
}

/* Add bytes of one code. Kanji are two bytes below 128, which EUC has above. */
void convert(code from, std::string bytes, std::string &out)
{
	if (from == KANJI)
		for (char &byte : bytes)
			byte = (char)(byte | '\x80');
	iconv_t converter = converters[from];
	char *in = &bytes[0];
	size_t left = bytes.size();
	if (converter == (iconv_t)-1) {
		for (const char byte : bytes)
			out += (unsigned char)byte < 0x80 ? byte : '?';
		return;
	}
	(void)iconv(converter, nullptr, nullptr, nullptr, nullptr);
	while (left > 0) {
		char part[256], *to = part;
		size_t room = sizeof part;
		const bool stuck =
			iconv(converter, &in, &left, &to, &room) == (size_t)-1 && errno != E2BIG;
		out.append(part, (size_t)(to - part));
		if (stuck && left > 0) {
			out += '?';
			in++;
			left--;
		}
	}
}

/* Whether a byte ends what an escape sequence has switched to (PS3.5, 6.1.2.5.3). */
bool ends_switch(char byte, text_kind kind)
{
	const char *ends = kind == text_kind::name ? "\\\n\r\f\t^=" : "\\\n\r\f\t";
	return byte != 0 && std::strchr(ends, byte);
}

/* The code that the sequence after an ESC switches to, and its length; 0: an unknown one. */
size_t read_escape(const char *at, code &out_code)
{
	for (const term &t : terms)
		if (t.escape && std::strncmp(at, t.escape, std::strlen(t.escape)) == 0) {
			out_code = t.first;
			return std::strlen(t.escape);
		}
	return 0;
}

} // namespace

void prepare_texts()
{
	if (prepared)
		return;
	for (int i = 0; i < CODES; i++)
		converters[i] = iconv_open("UTF-8", iconv_names[i]);
	prepared = true;
}

std::string utf8_of(const std::string &text, const std::string &charset, text_kind kind)
{
	prepare_texts();
	const code first = first_code(charset);
	const bool switches = charset.find("2022") != std::string::npos;
	code now = first;
	std::string run, out;
	for (size_t i = 0; i < text.size(); i++) {
		code next = now;
		size_t skipped = 0;
		if (switches && text[i] == '\x1b')
			skipped = 1 + read_escape(&text.c_str()[i + 1], next);
		else if (switches && ends_switch(text[i], kind))
			next = first;
		if (next != now) {
			convert(now, run, out);
			run.clear();
			now = next;
		}
		if (skipped == 0)
			run += text[i];
		else
			i += skipped - 1;
	}
	convert(now, run, out);
	out.resize(std::strlen(out.c_str()));
	gz_utf8_clean(&out[0]);
	return out;
}

std::string cut_utf8(const std::string &text, size_t size)
{
	size_t length = text.size() < size ? text.size() : size;
	while (length < text.size() && length > 0 && ((unsigned char)text[length] & 0xc0) == 0x80)
		length--;
	return text.substr(0, length);
}

} // namespace gz_dicom
