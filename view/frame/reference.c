#include "view/frame/reference.h"

#include <math.h>
#include <pthread.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <unistd.h>

#include "protocol/display.h"
#include "render/frame/picture_maker.h"
#include "render/illustration/shading_template.h"
#include "render/plan/plan.h"

#define GZ_LOG_MODULE "reference"

/* Rows cast between two checks for a newer request. Chosen: some ms of casting; a graphics device
 * draws every triangle and every slice again for each strip. */
enum { STRIP_ROWS_CPU = 32, STRIP_ROWS_GL = 256 };
/* Priority below that of the frames. Chosen: half-way to the lowest. */
#define NICENESS 10

static const char cpu_name[] = "cpu";

/* Objects, with styles and templates of their own. */
struct object_list {
	struct gz_object *objects; /* NULL: there is no list */
	struct gz_object_style *styles;
	struct gz_shading_template *templates;
	size_t count;
};

struct gz_reference_worker {
	struct gz_reference_source source; /* its objects are not used */
	int strip_rows;
	pthread_t thread;
	pthread_mutex_t lock;
	pthread_cond_t wake;
	atomic_bool outdated; /* the picture being rendered is no longer wanted */
	atomic_int rows_done, rows_asked;
	/* protected by the lock */
	bool quit, wanted, any_asked, ready;
	uint64_t revision; /* of the transfer function */
	struct gz_reference_view asked;
	struct gz_transfer transfer;
	struct object_list newest;
	uint64_t newest_revision;
	struct gz_image finished;
	/* used by the thread only */
	struct object_list listed; /* a copy of the newest */
	uint64_t listed_revision;
	struct gz_picture_maker *pictures;
	struct gz_transfer shown;
	uint64_t shown_revision;
	struct gz_image cast, picture;
};

static int reference_threads(const struct gz_reference_source *source)
{
	long processors = source->threads > 0 ? source->threads : sysconf(_SC_NPROCESSORS_ONLN) / 2;
	return processors < 1 ? 1 : processors > 256 ? 256 : (int)processors;
}

/* Rows that are cast at once: all of them where a picture depends on all its pixels. */
static int rows_of_strip(const struct gz_reference_worker *worker, const struct gz_image *image)
{
	for (size_t i = 0; i < worker->listed.count; i++)
		if (worker->listed.objects[i].technique->whole_pictures)
			return image->height;
	return worker->strip_rows;
}

static enum gz_result cast_strip(struct gz_reference_worker *worker,
				 const struct gz_reference_view *view, struct gz_image *image,
				 int row)
{
	const struct gz_foveation foveation = gz_foveation_full();
	const int left = image->height - row;
	const int most = rows_of_strip(worker, image);
	const int rows = left < most ? left : most;
	const struct gz_display display = gz_display_default(image->width, rows);
	const struct gz_picture_request request = {
		.camera = &view->camera,
		.settings = &view->rays,
		.foveation = &foveation,
		.display = &display,
		.focus = gz_focus_at((struct gz_point) { 0.5F, 0.5F }),
		.width = image->width,
		.height = image->height,
		.strip = { row, rows },
	};
	struct gz_image *strip;
	const enum gz_result r = gz_picture_make(worker->pictures, &request, &strip, NULL);
	if (r != GZ_OK)
		return r;
	const size_t stride = 4 * (size_t)image->width;
	memcpy(image->pixels + stride * (size_t)row, strip->pixels, stride * (size_t)rows);
	return GZ_OK;
}

static enum gz_result cast_all(struct gz_reference_worker *worker,
			       const struct gz_reference_view *view, struct gz_image *image)
{
	enum gz_result r = GZ_OK;
	const int rows = rows_of_strip(worker, image);
	atomic_store(&worker->rows_asked, image->height);
	for (int row = 0; row < image->height && r == GZ_OK; row += rows) {
		if (atomic_load(&worker->outdated))
			return GZ_ERR_CANCELLED;
		r = cast_strip(worker, view, image, row);
		atomic_store(&worker->rows_done, row + rows);
	}
	return r;
}

/* Cast the rays; if their number differs from that of the pixels, resample. */
static enum gz_result make_reference(struct gz_reference_worker *worker,
				     const struct gz_reference_view *view)
{
	const int width = (int)lround(view->width * view->image_sampling_rate);
	const int height = (int)lround(view->height * view->image_sampling_rate);
	const bool direct = width == view->width && height == view->height;
	struct gz_image *target = direct ? &worker->picture : &worker->cast;
	enum gz_result r = gz_image_resize(target, width, height);
	if (r == GZ_OK)
		r = cast_all(worker, view, target);
	if (r == GZ_OK && !direct) {
		r = gz_image_resize(&worker->picture, view->width, view->height);
		if (r == GZ_OK)
			gz_image_resample(target, &worker->picture);
	}
	return r;
}

static void free_object_list(struct object_list *list)
{
	free(list->objects);
	free(list->styles);
	free(list->templates);
	*list = (struct object_list) { 0 };
}

static enum gz_result copy_objects(const struct gz_object *objects, size_t count,
				   struct object_list *out_list)
{
	struct object_list list = {
		.objects = calloc(count, sizeof *list.objects),
		.styles = calloc(count, sizeof *list.styles),
		.templates = calloc(count, sizeof *list.templates),
		.count = count,
	};
	if (!list.objects || !list.styles || !list.templates) {
		free_object_list(&list);
		return GZ_ERR_NO_MEM;
	}
	for (size_t i = 0; i < count; i++) {
		list.objects[i] = objects[i];
		if (objects[i].style) {
			list.styles[i] = *objects[i].style;
			list.objects[i].style = &list.styles[i];
		}
		if (objects[i].shading_template) {
			list.templates[i] = *objects[i].shading_template;
			list.objects[i].shading_template = &list.templates[i];
		}
	}
	*out_list = list;
	return GZ_OK;
}

static bool same_look(const struct gz_object *a, const struct gz_object *b)
{
	const struct gz_object_style *one = a->style ? a->style : &gz_object_style_plain;
	const struct gz_object_style *other = b->style ? b->style : &gz_object_style_plain;
	const struct gz_shading_template *of_a = a->shading_template;
	const struct gz_shading_template *of_b = b->shading_template;
	return one->importance == other->importance && one->transparency == other->transparency &&
	       one->drawing == other->drawing && one->hatch_direction == other->hatch_direction &&
	       !of_a == !of_b &&
	       (!of_a ||
		gz_options_same(gz_template_options, gz_template_option_count, of_a, of_b));
}

static bool same_objects(const struct object_list *list, const struct gz_object *objects,
			 size_t count)
{
	bool same = list->count == count;
	for (size_t i = 0; i < count && same; i++)
		same = list->objects[i].id == objects[i].id &&
		       list->objects[i].technique == objects[i].technique &&
		       same_look(&list->objects[i], &objects[i]);
	return same;
}

/* Show the newest objects with the newest transfer function. */
static enum gz_result show_newest(struct gz_reference_worker *worker)
{
	struct object_list before = { 0 }, now = { 0 };
	enum gz_result r = GZ_OK;
	pthread_mutex_lock(&worker->lock);
	worker->shown = worker->transfer;
	worker->shown_revision = worker->revision;
	if (worker->listed_revision != worker->newest_revision)
		r = copy_objects(worker->newest.objects, worker->newest.count, &now);
	if (r == GZ_OK && worker->listed_revision != worker->newest_revision) {
		before = worker->listed;
		worker->listed = now;
		worker->listed_revision = worker->newest_revision;
	}
	pthread_mutex_unlock(&worker->lock);
	for (size_t i = 0; i < worker->listed.count; i++) {
		worker->listed.objects[i].transfer = &worker->shown;
		worker->listed.objects[i].transfer_revision = worker->shown_revision;
	}
	if (r == GZ_OK)
		r = gz_picture_maker_show(worker->pictures, worker->listed.objects,
					  worker->listed.count);
	/* The renderer has let go of them, or fails with every list. */
	free_object_list(&before);
	return r;
}

/* Wait for a request. @return false: the thread must end */
static bool wait_for_work(struct gz_reference_worker *worker, struct gz_reference_view *out_view)
{
	pthread_mutex_lock(&worker->lock);
	while (!worker->quit && !worker->wanted)
		pthread_cond_wait(&worker->wake, &worker->lock);
	const bool go_on = !worker->quit;
	*out_view = worker->asked;
	worker->wanted = false;
	atomic_store(&worker->outdated, worker->quit);
	atomic_store(&worker->rows_done, 0);
	pthread_mutex_unlock(&worker->lock);
	return go_on;
}

static void publish_reference(struct gz_reference_worker *worker, enum gz_result result)
{
	pthread_mutex_lock(&worker->lock);
	const bool is_current = !atomic_load(&worker->outdated);
	if (is_current && result == GZ_OK) {
		const struct gz_image room = worker->finished;
		worker->finished = worker->picture;
		worker->picture = room;
		worker->ready = true;
	}
	if (is_current || !worker->wanted) /* else the next one has begun to count */
		atomic_store(&worker->rows_done, -1);
	pthread_mutex_unlock(&worker->lock);
	if (result != GZ_OK && result != GZ_ERR_CANCELLED)
		gz_err(worker->source.log, "cannot render the standard picture for comparison: %s",
		       gz_result_text(result));
	if (is_current)
		worker->source.finished(worker->source.user);
}

static void *reference_thread(void *user)
{
	struct gz_reference_worker *worker = user;
	struct gz_reference_view view;
	/* On Linux this holds for this thread and those it starts. If it is refused, they run at
	 * the normal priority. */
	if (!worker->source.urgent)
		(void)setpriority(PRIO_PROCESS, 0, NICENESS);
	while (wait_for_work(worker, &view)) {
		enum gz_result r = show_newest(worker);
		if (r == GZ_OK)
			r = make_reference(worker, &view);
		publish_reference(worker, r);
	}
	gz_image_free(&worker->cast);
	gz_image_free(&worker->picture);
	/* Its OpenGL context, if it has one, must not become current on a thread with a window. */
	gz_picture_maker_destroy(&worker->pictures);
	return NULL;
}

enum gz_result gz_reference_worker_start(const struct gz_reference_source *source,
					 const struct gz_transfer *transfer,
					 struct gz_reference_worker **out_worker)
{
	if (source->object_count < 1)
		return GZ_ERR_INVAL;
	for (size_t i = 0; i < source->object_count; i++)
		if (source->objects[i].volume->bricks)
			return GZ_ERR_UNSUPPORTED;
	struct gz_reference_worker *worker = calloc(1, sizeof *worker);
	if (!worker)
		return GZ_ERR_NO_MEM;
	worker->source = *source;
	worker->newest_revision = 1;
	worker->transfer = *transfer;
	const struct gz_picture_maker_params params = {
		.backend = source->backend ? source->backend : cpu_name,
		.backend_params = { .threads = reference_threads(source),
				    .wait_for_bricks = true, /* and for marks */
				    .gl_memory_bytes = source->gl_memory_bytes },
	};
	worker->strip_rows = strcmp(params.backend, cpu_name) == 0 ? STRIP_ROWS_CPU : STRIP_ROWS_GL;
	if (copy_objects(source->objects, source->object_count, &worker->newest) != GZ_OK ||
	    gz_picture_maker_create(&params, source->log, &worker->pictures) != GZ_OK) {
		free_object_list(&worker->newest);
		free(worker);
		return GZ_ERR_NO_MEM;
	}
	atomic_store(&worker->rows_done, -1);
	pthread_mutex_init(&worker->lock, NULL);
	pthread_cond_init(&worker->wake, NULL);
	if (pthread_create(&worker->thread, NULL, reference_thread, worker) != 0) {
		pthread_cond_destroy(&worker->wake);
		pthread_mutex_destroy(&worker->lock);
		gz_picture_maker_destroy(&worker->pictures);
		free_object_list(&worker->newest);
		free(worker);
		return GZ_ERR_NO_MEM;
	}
	*out_worker = worker;
	return GZ_OK;
}

/* The caller holds the lock. */
static void request_reference(struct gz_reference_worker *worker)
{
	worker->wanted = true;
	worker->ready = false;
	atomic_store(&worker->outdated, true);
	atomic_store(&worker->rows_done, 0);
	pthread_cond_signal(&worker->wake);
}

void gz_reference_worker_set_transfer(struct gz_reference_worker *worker,
				      const struct gz_transfer *transfer)
{
	pthread_mutex_lock(&worker->lock);
	if (!gz_transfer_same(&worker->transfer, transfer)) {
		worker->transfer = *transfer;
		worker->revision++;
		if (worker->any_asked)
			request_reference(worker);
	}
	pthread_mutex_unlock(&worker->lock);
}

enum gz_result gz_reference_worker_set_objects(struct gz_reference_worker *worker,
					       const struct gz_object *objects, size_t count)
{
	struct object_list list;
	enum gz_result r = GZ_OK;
	pthread_mutex_lock(&worker->lock);
	if (count > 0 && !same_objects(&worker->newest, objects, count)) {
		r = copy_objects(objects, count, &list);
		if (r == GZ_OK) {
			free_object_list(&worker->newest);
			worker->newest = list;
			worker->newest_revision++;
			if (worker->any_asked)
				request_reference(worker);
		}
	}
	pthread_mutex_unlock(&worker->lock);
	return r;
}

static bool same_view(const struct gz_reference_view *a, const struct gz_reference_view *b)
{
	return gz_camera_same(&a->camera, &b->camera) && gz_ray_params_same(&a->rays, &b->rays) &&
	       a->image_sampling_rate == b->image_sampling_rate && a->width == b->width &&
	       a->height == b->height;
}

bool gz_reference_worker_ask(struct gz_reference_worker *worker,
			     const struct gz_reference_view *view)
{
	pthread_mutex_lock(&worker->lock);
	const bool another = !worker->any_asked || !same_view(&worker->asked, view);
	if (another) {
		worker->asked = *view;
		worker->any_asked = true;
		request_reference(worker);
	}
	pthread_mutex_unlock(&worker->lock);
	return another;
}

void gz_reference_worker_cancel(struct gz_reference_worker *worker)
{
	pthread_mutex_lock(&worker->lock);
	worker->wanted = worker->ready = worker->any_asked = false;
	atomic_store(&worker->outdated, true);
	pthread_mutex_unlock(&worker->lock);
}

bool gz_reference_worker_busy(struct gz_reference_worker *worker, double *out_share)
{
	const int done = atomic_load(&worker->rows_done);
	const int asked = atomic_load(&worker->rows_asked);
	*out_share = done < 0 ? 1 : asked > 0 ? fmin(1, (double)done / asked) : 0;
	return done >= 0;
}

bool gz_reference_worker_take(struct gz_reference_worker *worker, struct gz_image *image)
{
	pthread_mutex_lock(&worker->lock);
	const bool ready = worker->ready;
	if (ready) {
		const struct gz_image room = *image;
		*image = worker->finished;
		worker->finished = room;
		worker->ready = false;
	}
	pthread_mutex_unlock(&worker->lock);
	return ready;
}

void gz_reference_worker_stop(struct gz_reference_worker **worker)
{
	if (!worker || !*worker)
		return;
	pthread_mutex_lock(&(*worker)->lock);
	(*worker)->quit = true;
	atomic_store(&(*worker)->outdated, true);
	pthread_cond_signal(&(*worker)->wake);
	pthread_mutex_unlock(&(*worker)->lock);
	pthread_join((*worker)->thread, NULL);
	pthread_cond_destroy(&(*worker)->wake);
	pthread_mutex_destroy(&(*worker)->lock);
	gz_image_free(&(*worker)->finished);
	free_object_list(&(*worker)->newest);
	free_object_list(&(*worker)->listed);
	free(*worker);
	*worker = NULL;
}
