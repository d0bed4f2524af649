/* In place of the caster where Embree was not found when the project was built. */
#include "render/illustration/cpu/illustrate_caster.h"

#define GZ_LOG_MODULE "illustration"

bool gz_illustrate_caster_present(void)
{
	return false;
}

enum gz_result gz_illustrate_caster_check(const struct gz_backend_params *params,
					  const struct gz_log *log)
{
	(void)params;
	gz_err(log, "illustrations by rays are not in this build, because it was made without "
		    "Embree; install it (libembree-dev) and build again, or take --backend gl");
	return GZ_ERR_UNSUPPORTED;
}

enum gz_result gz_illustrate_caster_create(const struct gz_backend_params *params,
					   const struct gz_log *log,
					   struct gz_illustrate_caster **out_caster)
{
	(void)out_caster;
	return gz_illustrate_caster_check(params, log);
}

enum gz_result gz_illustrate_caster_show(struct gz_illustrate_caster *caster,
					 const struct gz_object *objects, size_t count)
{
	(void)caster;
	(void)objects;
	(void)count;
	return GZ_ERR_UNSUPPORTED;
}

enum gz_result gz_illustrate_caster_draw(struct gz_illustrate_caster *caster,
					 const struct gz_illustrate_shot *shot,
					 struct gz_image *image,
					 const struct gz_illustrate_planes *planes,
					 struct gz_frame_stats *out_stats)
{
	(void)caster;
	(void)shot;
	(void)image;
	(void)planes;
	(void)out_stats;
	return GZ_ERR_UNSUPPORTED;
}

enum gz_result gz_illustrate_caster_pick(struct gz_illustrate_caster *caster,
					 const struct gz_illustrate_shot *shot,
					 const struct gz_pick_request *request,
					 struct gz_pick *out_pick)
{
	(void)caster;
	(void)shot;
	(void)request;
	(void)out_pick;
	return GZ_ERR_UNSUPPORTED;
}

enum gz_result gz_illustrate_caster_print(const struct gz_illustrate_caster *caster,
					  const struct gz_print *print)
{
	(void)caster;
	(void)print;
	return GZ_ERR_UNSUPPORTED;
}

size_t gz_illustrate_caster_triangles(const struct gz_illustrate_caster *caster)
{
	(void)caster;
	return 0;
}

const char *gz_illustrate_caster_describe(const struct gz_illustrate_caster *caster)
{
	(void)caster;
	return "absent";
}

void gz_illustrate_caster_destroy(struct gz_illustrate_caster **caster)
{
	*caster = NULL;
}
