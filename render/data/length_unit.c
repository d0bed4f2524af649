#include "render/data/length_unit.h"

#include <stddef.h>
#include <string.h>
#include <strings.h>

#define GZ_LOG_MODULE "volume"

#define BLANKS " \t\r\n"

/* Longest name that is looked at, bytes, with the NUL. Chosen: more than the known ones have. */
#define NAME_SIZE 32

bool gz_length_unit_mm(const char *name, double *out_mm)
{
	static const struct {
		const char *name;
		double mm;
	} units[] = {
		{ "mm", 1 },
		{ "millimeter", 1 },
		{ "millimetre", 1 },
		{ "millimeters", 1 },
		{ "millimetres", 1 },
		{ "m", 1000 },
		{ "meter", 1000 },
		{ "metre", 1000 },
		{ "meters", 1000 },
		{ "metres", 1000 },
		{ "cm", 10 },
		{ "centimeter", 10 },
		{ "centimetre", 10 },
		{ "centimeters", 10 },
		{ "centimetres", 10 },
		{ "um", 1e-3 },
		{ "\xc2\xb5m", 1e-3 }, /* the sign micro in UTF-8, */
		{ "\xce\xbcm", 1e-3 }, /* the Greek letter, */
		{ "\xb5m", 1e-3 },     /* the sign in Latin-1 */
		{ "micron", 1e-3 },
		{ "microns", 1e-3 },
		{ "micrometer", 1e-3 },
		{ "micrometre", 1e-3 },
		{ "micrometers", 1e-3 },
		{ "micrometres", 1e-3 },
		{ "nm", 1e-6 },
		{ "nanometer", 1e-6 },
		{ "nanometre", 1e-6 },
		{ "nanometers", 1e-6 },
		{ "nanometres", 1e-6 },
	};
	for (size_t i = 0; i < sizeof units / sizeof units[0]; i++) {
		if (strcasecmp(name, units[i].name) == 0) {
			*out_mm = units[i].mm;
			return true;
		}
	}
	return false;
}

double gz_length_unit_take(const char *name, const char *path, const struct gz_log *log)
{
	char unit[NAME_SIZE] = "";
	double mm = 1;
	name += strspn(name, BLANKS);
	size_t length = strlen(name);
	while (length > 0 && strchr(BLANKS, name[length - 1]))
		length--;
	memcpy(unit, name, length < sizeof unit ? length : sizeof unit - 1);
	if (!unit[0] || strcasecmp(unit, "none") == 0 || strcmp(unit, "???") == 0)
		return 1;
	if (!gz_length_unit_mm(unit, &mm))
		gz_warn(log, "%s: its unit of length \"%s\" is unknown; taken as mm", path, unit);
	else if (mm != 1)
		gz_info(log, "%s: its lengths are in %s; converted to mm", path, unit);
	return mm;
}
