#include "render/mesh/distance/mesh_distance.h"

#define GZ_LOG_MODULE "mesh"

enum gz_result gz_mesh_distances(const struct gz_mesh *target, const float (*places)[3],
				 size_t count, struct gz_workers *workers, const struct gz_log *log,
				 float *out_distances_mm)
{
	(void)target;
	(void)places;
	(void)count;
	(void)workers;
	(void)out_distances_mm;
	gz_err(log, "distances from a surface need Embree, which this build lacks; install "
		    "libembree-dev and build again");
	return GZ_ERR_UNSUPPORTED;
}
