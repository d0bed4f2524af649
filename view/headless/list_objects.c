/* gazeview --list-objects. */
#include <inttypes.h>
#include <math.h>
#include <stdio.h>

#include "view/headless/headless.h"

/* A colour as a web page writes it. */
static void print_colour(const float colour[3])
{
	printf(" colour #");
	for (int i = 0; i < 3; i++)
		printf("%02lx", lround(255 * (double)colour[i]));
}

/* One line: what it is, its numbers, and its name, which may have blanks. */
static void print_object(const struct gz_scene *scene, const struct gz_object *object)
{
	const struct gz_label_surface *label = gz_scene_label_of(scene, object->id);
	if (label)
		printf("label %" PRId32 " voxels %" PRIu64, label->number, label->voxels);
	else if (object->mesh)
		printf("mesh triangles %zu", object->mesh->triangle_count);
	else
		printf("volume %d x %d x %d", object->volume->dims[0], object->volume->dims[1],
		       object->volume->dims[2]);
	printf(" technique %s", object->technique->name);
	if (object->colour)
		print_colour(object->colour);
	printf("%s%s\n", object->name ? " " : "", object->name ? object->name : "");
}

enum gz_result gz_view_list_objects(const struct gz_view_options *options, const struct gz_log *log)
{
	struct gz_object objects[GZ_SCENE_LISTED_MAX];
	struct gz_scene scene;
	const enum gz_result r = gz_view_load_scene(options, log, &scene);
	if (r != GZ_OK)
		return r;
	const size_t count =
		gz_scene_list_objects(&scene, objects, sizeof objects / sizeof objects[0]);
	for (size_t i = 0; i < count; i++)
		print_object(&scene, &objects[i]);
	gz_scene_free(&scene);
	return GZ_OK;
}
