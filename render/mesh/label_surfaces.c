#include "render/mesh/label_surfaces.h"

#include <inttypes.h>
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "render/mesh/label_net.h"

#define GZ_LOG_MODULE "labels"

/* Parts in which faces are sorted by labels, whatever the number of threads. */
enum { CHUNKS = 64 };

const struct gz_option gz_label_options[] = {
	{ "labels.smoothing", GZ_OPTION_INT, offsetof(struct gz_label_look, smoothing), 0,
	  GZ_LABEL_SMOOTHING_MAX, .preset = "12",
	  .help = "surfaces of labels: pairs of smoothing steps; 0 = stairs" },
	{ "labels.reach", GZ_OPTION_DOUBLE, offsetof(struct gz_label_look, reach), 0,
	  GZ_LABEL_REACH_MAX, .preset = "0.5",
	  .help = "surfaces of labels: how far smoothing moves them along an axis, voxels" },
	{ "labels.names", GZ_OPTION_STRING, offsetof(struct gz_label_look, names),
	  .max = GZ_PATH_SIZE, .preset = "",
	  .help = "file with names and colours of labels; without it the one beside the volume" },
};
const size_t gz_label_option_count = sizeof gz_label_options / sizeof gz_label_options[0];

bool gz_label_look_same(const struct gz_label_look *a, const struct gz_label_look *b)
{
	return a->smoothing == b->smoothing && a->reach == b->reach &&
	       strcmp(a->names, b->names) == 0;
}

/* ---- colours ---- */

void gz_label_colour(int32_t number, float out_rgb[3])
{
	static const double values[3] = { 0.95, 0.65, 1 }, saturations[3] = { 0.65, 0.75, 0.35 };
	const int kind = (int)(((int64_t)number % 3 + 3) % 3);
	const double turn = (double)number * 0.6180339887498949; /* the golden section */
	const double hue = 6 * (turn - floor(turn));
	for (int i = 0; i < 3; i++) {
		/* From HSV: red, green and blue are the same wave, a third of the circle apart. */
		const double at = fmod(hue + 6 - 2 * i, 6);
		const double wave = fmin(fmax(fabs(at - 3) - 1, 0), 1);
		out_rgb[i] = (float)(values[kind] * (1 - saturations[kind] * (1 - wave)));
	}
}

/* ---- faces by labels ---- */

/* One label's use of a face: its number, and which side the label is on. */
#define USE(face, side) ((uint32_t)(face) << 1 | (uint32_t)(side))
#define USED_FACE(use)  ((use) >> 1)
#define USED_SIDE(use)  ((use)&1)

/* What the threads share. */
struct splitting {
	const struct gz_label_index *index;
	const struct gz_label_net *net;
	const double *spacing;
	uint64_t elements_max;                /* of the request, as gz_mesh_count_limit() has it */
	const struct gz_label_names *names;   /* NULL: none */
	size_t (*offsets)[GZ_LABELS_MAX + 2]; /* of each chunk, by label */
	uint32_t *uses;                       /* of faces, by label */
	size_t *first;                        /* of each label in uses, and the end */
	uint32_t *local;                      /* of each worker, by vertex of the net */
	struct gz_label_surfaces *surfaces;
	enum gz_result *results; /* of each label */
};

static size_t chunk_begin(const struct splitting *splitting, size_t chunk)
{
	return splitting->net->face_count * chunk / CHUNKS;
}

static void count_chunk(void *user, size_t chunk, int worker)
{
	const struct splitting *splitting = user;
	size_t *counts = splitting->offsets[chunk];
	(void)worker;
	for (size_t i = chunk_begin(splitting, chunk); i < chunk_begin(splitting, chunk + 1); i++)
		for (int side = 0; side < 2; side++)
			counts[splitting->net->faces[i].labels[side]]++;
}

static void sort_chunk(void *user, size_t chunk, int worker)
{
	const struct splitting *splitting = user;
	size_t *offsets = splitting->offsets[chunk];
	(void)worker;
	for (size_t i = chunk_begin(splitting, chunk); i < chunk_begin(splitting, chunk + 1); i++)
		for (int side = 0; side < 2; side++) {
			const uint16_t label = splitting->net->faces[i].labels[side];
			if (label > 0)
				splitting->uses[offsets[label]++] = USE(i, side);
		}
}

/* Label by label, chunk by chunk. */
static void sum_chunks(struct splitting *splitting)
{
	size_t sum = 0;
	for (size_t label = 1; label <= splitting->index->count; label++) {
		splitting->first[label - 1] = sum;
		for (size_t chunk = 0; chunk < CHUNKS; chunk++) {
			const size_t more = splitting->offsets[chunk][label];
			splitting->offsets[chunk][label] = sum;
			sum += more;
		}
	}
	splitting->first[splitting->index->count] = sum;
}

/* ---- one label ---- */

/* Number the vertices that a label uses, in the order of its faces. */
static uint64_t number_vertices(const struct splitting *splitting, size_t label, uint32_t *local)
{
	uint32_t count = 0;
	for (size_t i = splitting->first[label]; i < splitting->first[label + 1]; i++) {
		const uint32_t *corners =
			splitting->net->faces[USED_FACE(splitting->uses[i])].corners;
		for (int c = 0; c < 4; c++)
			if (local[corners[c]] == GZ_LABEL_NO_VERTEX)
				local[corners[c]] = count++;
	}
	return count;
}

static void forget_vertices(const struct splitting *splitting, size_t label, uint32_t *local)
{
	for (size_t i = splitting->first[label]; i < splitting->first[label + 1]; i++) {
		const uint32_t *corners =
			splitting->net->faces[USED_FACE(splitting->uses[i])].corners;
		for (int c = 0; c < 4; c++)
			local[corners[c]] = GZ_LABEL_NO_VERTEX;
	}
}

static void place_mm(const struct splitting *splitting, uint32_t vertex, float out[3])
{
	for (int axis = 0; axis < 3; axis++)
		out[axis] = (float)(((double)splitting->net->places[vertex][axis] -
				     0.5 * splitting->index->dims[axis]) *
				    splitting->spacing[axis]);
}

static double squared_distance(const float a[3], const float b[3])
{
	double sum = 0;
	for (int axis = 0; axis < 3; axis++) {
		const double d = (double)a[axis] - (double)b[axis];
		sum += d * d;
	}
	return sum;
}

/* Two triangles of a face, cut by its shorter diagonal, which both labels find alike. */
static void write_face(const struct splitting *splitting, uint32_t use, const uint32_t *local,
		       struct gz_mesh *mesh, size_t triangle)
{
	const uint32_t *corners = splitting->net->faces[USED_FACE(use)].corners;
	float places[4][3];
	for (int c = 0; c < 4; c++) {
		place_mm(splitting, corners[c], places[c]);
		memcpy(mesh->positions[local[corners[c]]], places[c], sizeof places[c]);
	}
	const int first =
		squared_distance(places[1], places[3]) < squared_distance(places[0], places[2]) ? 1
												: 0;
	for (int t = 0; t < 2; t++) {
		uint32_t *to = mesh->triangles[triangle + (size_t)t];
		const uint32_t a = local[corners[first]];
		const uint32_t b = local[corners[(first + 1 + t) % 4]];
		const uint32_t c = local[corners[(first + 2 + t) % 4]];
		to[0] = a;
		to[1] = USED_SIDE(use) ? c : b;
		to[2] = USED_SIDE(use) ? b : c;
	}
}

/* Whether the face's other side is a label, too. */
static bool is_shared(const struct splitting *splitting, uint32_t use)
{
	return splitting->net->faces[USED_FACE(use)].labels[!USED_SIDE(use)] > 0;
}

/* Faces of a label to the outside come first, those that it shares with neighbours last. */
static void write_label_faces(const struct splitting *splitting, size_t label,
			      const uint32_t *local, struct gz_mesh *mesh)
{
	size_t triangle = 0;
	for (int shared = 0; shared < 2; shared++) {
		mesh->shared_count = mesh->triangle_count - triangle;
		for (size_t i = splitting->first[label]; i < splitting->first[label + 1]; i++) {
			const uint32_t use = splitting->uses[i];
			if (is_shared(splitting, use) != (shared == 1))
				continue;
			write_face(splitting, use, local, mesh, triangle);
			triangle += 2;
		}
	}
}

static void cross_sides(const struct gz_mesh *mesh, const uint32_t corners[3], float out[3])
{
	const float *a = mesh->positions[corners[0]], *b = mesh->positions[corners[1]];
	const float *c = mesh->positions[corners[2]];
	for (int axis = 0; axis < 3; axis++) {
		const int u = (axis + 1) % 3, v = (axis + 2) % 3;
		out[axis] = (b[u] - a[u]) * (c[v] - a[v]) - (b[v] - a[v]) * (c[u] - a[u]);
	}
}

/* Normals are those of the triangles round a vertex, weighted by their areas. Where they cancel
 * each other, as on a spike, any will do. */
static void make_label_normals(struct gz_mesh *mesh)
{
	memset(mesh->normals, 0, mesh->vertex_count * sizeof *mesh->normals);
	for (size_t t = 0; t < mesh->triangle_count; t++) {
		float normal[3];
		cross_sides(mesh, mesh->triangles[t], normal);
		for (int c = 0; c < 3; c++)
			for (int axis = 0; axis < 3; axis++)
				mesh->normals[mesh->triangles[t][c]][axis] += normal[axis];
	}
	for (size_t v = 0; v < mesh->vertex_count; v++) {
		float *normal = mesh->normals[v];
		const double length = sqrt(squared_distance(normal, (const float[3]) { 0, 0, 0 }));
		for (int axis = 0; axis < 3; axis++)
			normal[axis] = length > 0 ? (float)((double)normal[axis] / length)
						  : (float)(axis == 2);
	}
}

/* What the label is called, and its colour. */
static void describe_label(const struct splitting *splitting, struct gz_label_surface *surface)
{
	const struct gz_label_name *known =
		splitting->names ? gz_label_names_find(splitting->names, surface->number) : NULL;
	gz_label_colour(surface->number, surface->colour);
	if (!known)
		return;
	memcpy(surface->name, known->name, sizeof surface->name);
	if (known->has_colour)
		memcpy(surface->colour, known->colour, sizeof surface->colour);
}

static uint64_t triangles_of(const struct splitting *splitting, size_t label)
{
	return 2 * (uint64_t)(splitting->first[label + 1] - splitting->first[label]);
}

static void split_label(void *user, size_t label, int worker)
{
	const struct splitting *splitting = user;
	uint32_t *local = splitting->local + (size_t)worker * splitting->net->vertex_count;
	struct gz_label_surface *surface = &splitting->surfaces->items[label];
	surface->number = splitting->index->numbers[label];
	surface->voxels = splitting->index->voxels[label];
	describe_label(splitting, surface);
	const uint64_t vertices = number_vertices(splitting, label, local);
	const uint64_t triangles = triangles_of(splitting, label);
	splitting->results[label] = triangles <= splitting->elements_max
					    ? gz_mesh_allocate(vertices, triangles, &surface->mesh)
					    : GZ_ERR_FULL;
	if (splitting->results[label] == GZ_OK) {
		write_label_faces(splitting, label, local, &surface->mesh);
		make_label_normals(&surface->mesh);
	}
	forget_vertices(splitting, label, local);
}

/* ---- all ---- */

static bool allocate_splitting(struct splitting *splitting, size_t threads)
{
	const size_t labels = splitting->index->count;
	const size_t locals = threads * splitting->net->vertex_count;
	splitting->offsets = calloc(CHUNKS, sizeof *splitting->offsets);
	splitting->first = calloc(labels + 1, sizeof *splitting->first);
	splitting->results = calloc(labels + 1, sizeof *splitting->results);
	splitting->uses = malloc((2 * splitting->net->face_count + 1) * sizeof *splitting->uses);
	splitting->local = malloc((locals + 1) * sizeof *splitting->local);
	splitting->surfaces->items = calloc(labels + 1, sizeof *splitting->surfaces->items);
	if (!splitting->local)
		return false;
	memset(splitting->local, 0xFF, locals * sizeof *splitting->local);
	return splitting->offsets && splitting->first && splitting->results && splitting->uses &&
	       splitting->surfaces->items;
}

/* The first failure of a label; one that has too many triangles is told. */
static enum gz_result check_labels(const struct splitting *splitting, const struct gz_log *log)
{
	size_t i = 0;
	while (i < splitting->index->count && splitting->results[i] == GZ_OK)
		i++;
	if (i == splitting->index->count)
		return GZ_OK;
	if (splitting->results[i] == GZ_ERR_FULL)
		gz_err(log,
		       "the surface of label %" PRId32 " has %" PRIu64
		       " triangles, more than %" PRIu64 "; use a smaller volume",
		       splitting->index->numbers[i], triangles_of(splitting, i),
		       splitting->elements_max);
	return splitting->results[i];
}

static enum gz_result split_net(struct splitting *splitting, struct gz_workers *workers,
				const struct gz_log *log)
{
	const size_t threads = workers ? (size_t)gz_workers_count(workers) : 1;
	const size_t labels = splitting->index->count;
	enum gz_result result = allocate_splitting(splitting, threads) ? GZ_OK : GZ_ERR_NO_MEM;
	if (result == GZ_OK) {
		splitting->surfaces->count = labels;
		gz_label_run(workers, count_chunk, splitting, CHUNKS);
		sum_chunks(splitting);
		gz_label_run(workers, sort_chunk, splitting, CHUNKS);
		gz_label_run(workers, split_label, splitting, labels);
	}
	if (result == GZ_OK)
		result = check_labels(splitting, log);
	free(splitting->offsets);
	free(splitting->first);
	free(splitting->results);
	free(splitting->uses);
	free(splitting->local);
	return result;
}

static enum gz_result make_surfaces(const struct gz_label_request *request,
				    const struct gz_label_index *index, struct gz_workers *workers,
				    const struct gz_log *log, struct gz_label_surfaces *surfaces)
{
	struct gz_label_net net = { 0 };
	const uint64_t most = gz_mesh_count_limit(request->elements_max);
	enum gz_result result = gz_label_net_make(index, most, workers, log, &net);
	if (result == GZ_OK)
		result = gz_label_net_smooth(&net, index->dims, request->look, workers);
	if (result == GZ_OK) {
		struct splitting splitting = { .index = index,
					       .net = &net,
					       .spacing = request->volume->spacing,
					       .elements_max = most,
					       .names = request->names,
					       .surfaces = surfaces };
		result = split_net(&splitting, workers, log);
	}
	gz_label_net_free(&net);
	return result;
}

enum gz_result gz_label_surfaces_make(const struct gz_label_request *request,
				      struct gz_workers *workers, const struct gz_log *log,
				      struct gz_label_surfaces *out_surfaces)
{
	struct gz_label_surfaces surfaces = { 0 };
	struct gz_label_index index;
	enum gz_result result =
		gz_label_index_make(request->volume, request->name, workers, log, &index);
	if (result != GZ_OK)
		return result;
	result = make_surfaces(request, &index, workers, log, &surfaces);
	gz_label_index_free(&index);
	if (result == GZ_ERR_NO_MEM)
		gz_err(log, "%s: not enough memory for the surfaces of its labels", request->name);
	if (result == GZ_OK)
		*out_surfaces = surfaces;
	else
		gz_label_surfaces_free(&surfaces);
	return result;
}

void gz_label_surfaces_free(struct gz_label_surfaces *surfaces)
{
	for (size_t i = 0; i < surfaces->count; i++)
		gz_mesh_free(&surfaces->items[i].mesh);
	free(surfaces->items);
	*surfaces = (struct gz_label_surfaces) { 0 };
}
