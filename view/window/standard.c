#include "view/window/standard.h"

#include <GLFW/glfw3.h>

#include "view/window/window_state.h"

/* Called on the worker's thread. */
static void wake_loop_for_standard(void *user)
{
	(void)user;
	glfwPostEmptyEvent();
}

enum gz_result gz_window_start_standard(const struct gz_window *window, bool urgent,
					struct gz_reference_worker **out_worker)
{
	const struct gz_scene *scene = gz_frame_maker_scene(window->maker);
	struct gz_object objects[GZ_SCENE_LISTED_MAX];
	const size_t count = gz_frame_list_objects(window->maker, objects);
	const struct gz_reference_source source = {
		.objects = objects,
		.object_count = count,
		.backend = gz_frame_standard_backend(window->maker),
		.gl_memory_bytes = (size_t)window->options->gl_memory_mib << 20,
		.threads = (window->options->threads + 1) / 2,
		.urgent = urgent,
		.finished = wake_loop_for_standard,
		.log = window->log,
	};
	return gz_reference_worker_start(&source, &scene->transfer, out_worker);
}

void gz_window_ask_for_standard(const struct gz_window *window, struct gz_reference_worker *worker,
				const struct gz_ray_params *rays, int width, int height)
{
	const struct gz_reference_view view = {
		.camera = window->made.camera,
		.rays = *rays,
		.image_sampling_rate = window->made.image_sampling_rate,
		.width = width,
		.height = height,
	};
	struct gz_object objects[GZ_SCENE_LISTED_MAX];
	const size_t count = gz_frame_list_objects(window->maker, objects);
	/* Without memory the picture shows them as they were. */
	(void)gz_reference_worker_set_objects(worker, objects, count);
	gz_reference_worker_set_transfer(worker, gz_frame_transfer(window->maker));
	gz_reference_worker_ask(worker, &view);
}
