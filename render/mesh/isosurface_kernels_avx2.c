/* The same loops for AVX2, with a bit counter: isosurface_kernels.h. */
#include "render/mesh/isosurface_kernels.h"

#include "render/mesh/isosurface_cubes.h"
#include "render/mesh/isosurface_vertices.h"

const struct gz_iso_kernels gz_iso_kernels_avx2 = { count_iso_row, write_iso_triangles,
						    write_iso_vertices };
