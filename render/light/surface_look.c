#include "render/light/surface_look.h"

static const char *const source_names[] = { "triangles", "voxels", NULL };
static const char *const material_names[] = { "matte", "glass", NULL };

#define AT(field) offsetof(struct gz_surface_look, field)

const struct gz_option gz_surface_look_options[] = {
	{ "isosurface.isovalue", GZ_OPTION_DOUBLE, AT(isovalue), -GZ_ISOVALUE_MAX, GZ_ISOVALUE_MAX,
	  .preset = "0", .help = "data value of a volume's surface, such as Hounsfield units" },
	{ "isosurface.source", GZ_OPTION_CHOICE, AT(source), .choices = source_names,
	  .preset = "triangles",
	  .help = "where rays find a volume's surface: triangles, or voxels (no mesh is made)" },
	{ "isosurface.colour", GZ_OPTION_DOUBLE, AT(colour), 0, 1, .count = 3,
	  .preset = "0.9 0.85 0.75", .help = "red, green and blue of surfaces" },
	{ "isosurface.material", GZ_OPTION_CHOICE, AT(material), .choices = material_names,
	  .preset = "matte", .help = "matte, or glass: reflects and refracts the surroundings" },
	{ "isosurface.refractive_index", GZ_OPTION_DOUBLE, AT(refractive_index), 1, 4,
	  .preset = "1.333", .help = "refractive index of glass; 1.333 is water" },
	{ "isosurface.bounces", GZ_OPTION_INT, AT(bounces), 1, 32, .preset = "4",
	  .help = "most surfaces of glass that a ray meets; backend gl: one" },
	{ "isosurface.shadows", GZ_OPTION_BOOL, AT(shadows), .preset = "no",
	  .help = "shadows on surfaces that are not glass" },
};
const size_t gz_surface_look_option_count =
	sizeof gz_surface_look_options / sizeof gz_surface_look_options[0];
