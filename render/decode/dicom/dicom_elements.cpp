#include "render/decode/dicom/dicom_elements.hpp"

#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <cstring>

namespace gz_dicom
{

const gdcm::ByteValue *value_of(const gdcm::DataSet &data, const gdcm::Tag &tag)
{
	return data.FindDataElement(tag) ? data.GetDataElement(tag).GetByteValue() : nullptr;
}

std::string text_of(const gdcm::DataSet &data, const gdcm::Tag &tag)
{
	const gdcm::ByteValue *value = value_of(data, tag);
	std::string text = value ? std::string(value->GetPointer(), value->GetLength()) : "";
	const size_t end = text.find_last_not_of(std::string(" \0", 2));
	text.resize(end == std::string::npos ? 0 : end + 1);
	return text;
}

bool numbers_in(const std::string &text, double *out, int count)
{
	const char *at = text.c_str();
	for (int i = 0; i < count; i++) {
		char *end = nullptr;
		const double value = std::strtod(at, &end);
		if (end == at || !std::isfinite(value))
			return false;
		out[i] = value;
		end += std::strspn(end, " ");
		if (i + 1 < count && *end != '\\')
			return false;
		at = end + (*end == '\\');
	}
	return true;
}

bool numbers_of(const gdcm::DataSet &data, const gdcm::Tag &tag, double *out, int count)
{
	return numbers_in(text_of(data, tag), out, count);
}

int short_of(const gdcm::DataSet &data, const gdcm::Tag &tag, int otherwise)
{
	const gdcm::ByteValue *value = value_of(data, tag);
	uint16_t number;
	if (!value || value->GetLength() < sizeof number)
		return otherwise;
	std::memcpy(&number, value->GetPointer(), sizeof number);
	return number;
}

int decimal_of(const gdcm::DataSet &data, const gdcm::Tag &tag, int otherwise)
{
	double number;
	return numbers_of(data, tag, &number, 1) && std::fabs(number) < 2147483648.0 ? (int)number
										     : otherwise;
}

items sequence_of(const gdcm::DataSet &data, const gdcm::Tag &tag)
{
	return data.FindDataElement(tag) ? data.GetDataElement(tag).GetValueAsSQ() : items();
}

const gdcm::DataSet *item_of(const items &sequence, size_t index)
{
	if (!sequence || index >= sequence->GetNumberOfItems())
		return nullptr;
	return &sequence->GetItem(index + 1).GetNestedDataSet(); /* counted from 1 */
}

} // namespace gz_dicom
