#include "render/decode/dicom/dicom_dose.hpp"

#include <cmath>

#include "render/decode/dicom/dicom_elements.hpp"

namespace gz_dicom
{

namespace
{

const gdcm::Tag frame_offsets(0x3004, 0x000c), grid_scaling(0x3004, 0x000e);

/* Offsets differ from the position by no more than this if they are positions, mm (chosen: numbers
 * of 16 characters are rounded far below it). */
const double same_place = 1e-3;

/* Whether the offsets are places along the patient's axis and not distances from the first frame:
 * C.8.8.3.2, which allows that for transverse frames whose first offset is their position's z. */
bool are_places(const std::vector<double> &offsets, const slice &first, const vector3 &normal)
{
	return offsets[0] != 0 && std::fabs(normal.x[2]) > 0.999 &&
	       std::fabs(offsets[0] - first.position.x[2]) < same_place;
}

void move_frames(const std::vector<double> &offsets, std::vector<slice> &slices)
{
	const slice first = slices[0];
	const vector3 normal = cross(first.row, first.column);
	const bool places = are_places(offsets, first, normal);
	for (size_t k = 0; k < slices.size(); k++) {
		if (places)
			slices[k].position.x[2] = offsets[k];
		for (int i = 0; !places && i < 3; i++)
			slices[k].position.x[i] += offsets[k] * normal.x[i];
	}
}

} // namespace

void place_dose(const gdcm::DataSet &data, head &image)
{
	double scaling;
	std::vector<slice> &slices = image.slices;
	if (!data.FindDataElement(grid_scaling) || slices.empty())
		return;
	if (numbers_of(data, grid_scaling, &scaling, 1) && scaling != 0)
		for (slice &s : slices)
			s.slope = scaling;
	std::vector<double> offsets(slices.size());
	if (slices.size() < 2 || !slices[0].placed)
		return;
	if (numbers_of(data, frame_offsets, offsets.data(), (int)offsets.size()))
		move_frames(offsets, slices);
	else
		for (slice &s : slices)
			s.placed = false;
}

} // namespace gz_dicom
