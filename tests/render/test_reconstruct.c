/* The pyramid against its formulas (docs/foveation.md), written out point by point over whole
 * lattices. */
#include "suite.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "render/picture/image.h"
#include "render/raycast/cpu/cast.h"
#include "render/reconstruct/cpu/reconstruct.h"

enum { LEVELS_MAX = GZ_PLAN_LAYERS_MAX };

/* A plan and what its rays saw. */
struct scene {
	struct gz_plan plan;
	struct gz_lattices lattices;
	struct gz_image image;
};

static uint32_t random_point(uint32_t *state)
{
	*state = *state * 1664525 + 1013904223;
	return *state ^ *state >> 15;
}

/* Where ray i of a tile lies, px. */
static void ray_place(const struct gz_plan *plan, const struct gz_tile *tile, int i, int *x, int *y)
{
	*x = tile->x + gz_tile_columns[tile->pattern][i] * plan->layers[tile->layer].spacing;
	*y = tile->y + gz_tile_rows[i] * plan->layers[tile->layer].spacing;
}

/* Put a point on every lattice that has it, from its tile's layer on. */
static void put_on_lattices(struct gz_lattices *lattices, int layer, int x, int y, uint32_t colour)
{
	for (; layer < lattices->count; layer++) {
		struct gz_lattice *lattice = &lattices->layers[layer];
		const int column = x / lattice->spacing, row = y / lattice->spacing;
		if (x % lattice->spacing == 0 && y % lattice->spacing == 0 &&
		    column < lattice->columns && row < lattice->rows)
			lattice->points[(size_t)row * lattice->stride + (size_t)column] = colour;
	}
}

enum content {
	NOISE,        /* every cast point a colour of its own */
	ONE_COLOUR,   /* the seed */
	SPOTS_ON_FLAT /* a background with a few pixels in it */
};

static uint32_t colour_of(enum content content, uint32_t *seed)
{
	if (content == ONE_COLOUR)
		return *seed;
	const uint32_t colour = random_point(seed);
	const bool background = content == SPOTS_ON_FLAT && (colour >> 8) % 1000 > 0;
	return background ? 0xFF102030 : colour;
}

/* Every cast point gets a colour; whatever was not cast, another. */
static void cast_colours(struct scene *scene, uint32_t seed, enum content content)
{
	const struct gz_plan *plan = &scene->plan;
	for (int i = 0; i < plan->layer_count; i++) {
		const struct gz_lattice *lattice = &scene->lattices.layers[i];
		for (int k = 0; k < lattice->columns * lattice->rows; k++)
			lattice->points[k] = 0xDEADBEEF;
	}
	for (size_t t = 0; t < plan->tile_count; t++) {
		const struct gz_tile *tile = &plan->tiles[t];
		gz_lattices_mark(&scene->lattices, tile);
		for (int i = 0; i < GZ_TILE_EDGE * GZ_TILE_EDGE; i++) {
			int x, y;
			ray_place(plan, tile, i, &x, &y);
			put_on_lattices(&scene->lattices, tile->layer, x, y,
					colour_of(content, &seed));
		}
	}
}

static void make_scene(const struct gz_foveation *foveation, struct gz_point gaze, int width,
		       int height, uint32_t seed, enum content content, struct scene *scene)
{
	/* Small pixels: with a steep loss of acuity small pictures reach all spacings. */
	struct gz_display display = gz_display_default(width, height);
	display.mm[0] = 0.1 * width;
	display.mm[1] = 0.1 * height;
	display.distance_mm = 300;
	memset(scene, 0, sizeof *scene);
	assert_int_equal(gz_plan_make(foveation, &display, gaze, width, height, &scene->plan),
			 GZ_OK);
	assert_int_equal(gz_image_resize(&scene->image, width, height), GZ_OK);
	assert_int_equal(
		gz_lattices_prepare(&scene->lattices, &scene->plan, gz_image_words(&scene->image)),
		GZ_OK);
	cast_colours(scene, seed, content);
}

static void free_scene(struct scene *scene)
{
	gz_plan_free(&scene->plan);
	gz_lattices_free(&scene->lattices);
	gz_image_free(&scene->image);
}

/* The formulas. */

struct reference {
	int columns, rows;
	uint32_t *points;
	bool *known;
};

static int mirror(int i, int count)
{
	while (count > 1 && (i < 0 || i >= count))
		i = i < 0 ? -i : 2 * (count - 1) - i;
	return count > 1 ? i : 0;
}

static int channel(const struct reference *lattice, int x, int y, int c)
{
	x = mirror(x, lattice->columns);
	y = mirror(y, lattice->rows);
	return (int)(lattice->points[y * lattice->columns + x] >> (8 * c) & 255);
}

static int cubic(const int v[4])
{
	const int m = (v[1] + v[2] + 1) / 2, n = (v[0] + v[3] + 1) / 2;
	const int low = v[1] < v[2] ? v[1] : v[2], high = v[1] < v[2] ? v[2] : v[1];
	const int eighths = m - n + ((v[1] + v[2]) % 2 ? 0 : 4);
	const int value = m + (eighths + 256) / 8 - 32; /* rounded down, below 0 too */
	return value < low ? low : value > high ? high : value;
}

/* Along an axis, from points 1 and 3 away. */
static int along(const struct reference *lattice, int filter, int x, int y, int dx, int dy, int c)
{
	const int v[4] = { channel(lattice, x - 3 * dx, y - 3 * dy, c),
			   channel(lattice, x - dx, y - dy, c), channel(lattice, x + dx, y + dy, c),
			   channel(lattice, x + 3 * dx, y + 3 * dy, c) };
	return filter == GZ_FILTER_BILINEAR ? (v[1] + v[2] + 1) / 2 : cubic(v);
}

static int from_quincunx(const struct reference *lattice, int filter, int x, int y, int c)
{
	if (lattice->rows == 1)
		return along(lattice, filter, x, y, 1, 0, c);
	if (lattice->columns == 1)
		return along(lattice, filter, x, y, 0, 1, c);
	if (filter == GZ_FILTER_BILINEAR)
		return (channel(lattice, x - 1, y, c) + channel(lattice, x + 1, y, c) +
			channel(lattice, x, y - 1, c) + channel(lattice, x, y + 1, c) + 2) /
		       4;
	return (along(lattice, filter, x, y, 1, 0, c) + along(lattice, filter, x, y, 0, 1, c) +
		y % 2) /
	       2;
}

/* Halfway between rows j and j + 1 of the coarse lattice. */
static int between_rows(const struct reference *coarse, int i, int j, int c)
{
	return cubic((const int[]) { channel(coarse, i, j - 1, c), channel(coarse, i, j, c),
				     channel(coarse, i, j + 1, c), channel(coarse, i, j + 2, c) });
}

static int from_coarser(const struct reference *coarse, int filter, int x, int y, int c)
{
	const int i = x / 2, j = y / 2;
	if (filter == GZ_FILTER_BILINEAR && y % 2 == 0)
		return (channel(coarse, i, j, c) + channel(coarse, i + x % 2, j, c)) / 2;
	if (filter == GZ_FILTER_BILINEAR)
		return (channel(coarse, i, j, c) + channel(coarse, i + x % 2, j, c) +
			channel(coarse, i, j + y % 2, c) +
			channel(coarse, i + x % 2, j + y % 2, c) + 2) /
		       4;
	int v[4];
	for (int k = 0; k < 4; k++)
		v[k] = y % 2 ? between_rows(coarse, i - 1 + k, j, c)
			     : channel(coarse, i - 1 + k, j, c);
	return x % 2 ? cubic(v) : v[1];
}

/* Lattice level of a plan, from the next coarser. */
static void fill_reference(const struct scene *scene, struct reference *levels, int level)
{
	struct reference *fine = &levels[level];
	const int filter = (int)scene->plan.filter;
	for (int pass = 0; pass < 2; pass++)
		for (int k = 0; k < fine->columns * fine->rows; k++) {
			const int x = k % fine->columns, y = k / fine->columns;
			const int tile =
				gz_lattices_block(&scene->lattices, (x / GZ_BLOCK_EDGE) << level,
						  (y / GZ_BLOCK_EDGE) << level);
			const bool coarser = tile / 2 > level;
			if (fine->known[k] || coarser != (pass == 0))
				continue;
			uint32_t point = 0;
			for (int c = 0; c < 4; c++) {
				const int value =
					coarser ? from_coarser(&levels[level + 1], filter, x, y, c)
						: from_quincunx(fine, filter, x, y, c);
				point |= (uint32_t)value << (8 * c);
			}
			fine->points[k] = point;
		}
}

static struct reference *make_reference(const struct scene *scene)
{
	const struct gz_plan *plan = &scene->plan;
	struct reference *levels = calloc(LEVELS_MAX, sizeof *levels);
	for (int i = 0; i < plan->layer_count; i++) {
		const struct gz_lattice *lattice = &scene->lattices.layers[i];
		const size_t count = (size_t)lattice->columns * (size_t)lattice->rows;
		levels[i] = (struct reference) { lattice->columns, lattice->rows, malloc(count * 4),
						 calloc(count, 1) };
		assert_non_null(levels[i].points);
		assert_non_null(levels[i].known);
		memcpy(levels[i].points, lattice->points, count * 4);
	}
	for (size_t t = 0; t < plan->tile_count; t++)
		for (int i = 0; i < GZ_TILE_EDGE * GZ_TILE_EDGE; i++) {
			int x, y;
			ray_place(plan, &plan->tiles[t], i, &x, &y);
			for (int l = plan->tiles[t].layer; l < plan->layer_count && levels[l].known;
			     l++) {
				const int spacing = plan->layers[l].spacing;
				if (x % spacing == 0 && y % spacing == 0 &&
				    x / spacing < levels[l].columns && y / spacing < levels[l].rows)
					levels[l].known[y / spacing * levels[l].columns +
							x / spacing] = true;
			}
		}
	for (int level = plan->layer_count - 1; level >= 0; level--)
		fill_reference(scene, levels, level);
	return levels;
}

static void free_reference(struct reference *levels)
{
	for (int i = 0; i < LEVELS_MAX; i++) {
		free(levels[i].points);
		free(levels[i].known);
	}
	free(levels);
}

static void check_equal(const struct scene *scene, const struct reference *picture, const char *set)
{
	const uint32_t *pixels = (const uint32_t *)(const void *)scene->image.pixels;
	for (int k = 0; k < picture->columns * picture->rows; k++)
		if (pixels[k] != picture->points[k])
			fail_msg("%s %s %dx%d: pixel %d %d is %08x, not %08x", set,
				 gz_filter_names[scene->plan.filter], picture->columns,
				 picture->rows, k % picture->columns, k / picture->columns,
				 pixels[k], picture->points[k]);
}

/* One plan and its rays by all instruction sets of this processor. */
static void check_pyramid(const struct scene *scene, struct gz_workers *workers)
{
	static const char *const sets[] = { "portable", "avx2", "avx512" };
	struct reference *levels = make_reference(scene);
	struct gz_image image = scene->image;
	const size_t bytes = (size_t)image.width * (size_t)image.height * 4;
	uint8_t *cast = malloc(bytes);
	assert_non_null(cast);
	memcpy(cast, image.pixels, bytes);
	for (size_t k = 0; k < sizeof sets / sizeof sets[0]; k++) {
		if (!gz_cast_kernels_find(sets[k]))
			continue;
		memcpy(image.pixels, cast, bytes);
		gz_reconstruct(&scene->plan, &scene->lattices, gz_row_filters_find(sets[k]),
			       workers, gz_image_words(&image));
		check_equal(scene, &levels[0], sets[k]);
	}
	free(cast);
	free_reference(levels);
}

static void pyramid_of_any_size_and_gaze_follows_its_formulas(void **state)
{
	(void)state;
	static const int sizes[][2] = { { 1, 1 },   { 1, 300 },   { 300, 1 },   { 2, 190 },
					{ 190, 3 }, { 129, 127 }, { 257, 300 }, { 601, 402 } };
	static const struct gz_point gazes[] = {
		{ 0.5F, 0.5F }, { 0, 0 }, { 1.4F, 0.3F }, { 0.3F, 0.9F }, { -0.2F, -0.5F }
	};
	struct gz_workers *workers;
	assert_int_equal(gz_workers_create(3, &workers), GZ_OK);
	int tiles[GZ_PLAN_LAYERS_MAX][GZ_TILE_PATTERN_COUNT] = { 0 };
	for (size_t s = 0; s < sizeof sizes / sizeof sizes[0]; s++)
		for (size_t g = 0; g < 4 * sizeof gazes / sizeof gazes[0]; g++) {
			struct gz_foveation foveation = gz_foveation_default();
			foveation.filter = g % 2 ? GZ_FILTER_BILINEAR : GZ_FILTER_CATMULL_ROM;
			foveation.acuity_slope = g % 8 < 4 ? 0.4 : 0.12;
			foveation.acuity_full_deg = 0; /* more coarse tiles */
			struct scene scene;
			make_scene(&foveation, gazes[g / 4], sizes[s][0], sizes[s][1],
				   (uint32_t)(s + g), g % 4 < 2 ? NOISE : SPOTS_ON_FLAT, &scene);
			for (size_t t = 0; t < scene.plan.tile_count; t++)
				tiles[scene.plan.tiles[t].layer][scene.plan.tiles[t].pattern]++;
			check_pyramid(&scene, workers);
			free_scene(&scene);
		}
	for (int layer = 0; layer < 4; layer++)
		for (int pattern = 0; pattern < GZ_TILE_PATTERN_COUNT; pattern++)
			if (tiles[layer][pattern] < 10)
				fail_msg("only %d tiles of layer %d, pattern %d",
					 tiles[layer][pattern], layer, pattern);
	gz_workers_destroy(&workers);
}

/* Beyond 4 MiB rows are written past the caches; where rows are not aligned by another way. */
static void large_pictures_follow_the_formulas_too(void **state)
{
	(void)state;
	static const int sizes[][2] = { { 1088, 1000 }, { 1043, 1029 } };
	struct gz_workers *workers;
	assert_int_equal(gz_workers_create(2, &workers), GZ_OK);
	for (size_t i = 0; i < 4; i++) {
		struct gz_foveation foveation = gz_foveation_default();
		foveation.filter = i % 2 ? GZ_FILTER_BILINEAR : GZ_FILTER_CATMULL_ROM;
		struct scene scene;
		make_scene(&foveation, (struct gz_point) { 0.3F, 0.2F }, sizes[i / 2][0],
			   sizes[i / 2][1], (uint32_t)i, SPOTS_ON_FLAT, &scene);
		check_pyramid(&scene, workers);
		free_scene(&scene);
	}
	gz_workers_destroy(&workers);
}

/* What is read beside a row that is made, and what must be left alone behind it. */
enum { ROW_ROOM = GZ_ROW_STREAMED + 4 * GZ_ROW_POINTS, GUARD = 0x12345678 };

static void check_rows(const struct gz_row_filters *filters, const uint32_t *coarse, int shift,
		       int count)
{
	static const bool streams[] = { false, true };
	uint32_t made[2][2][ROW_ROOM];
	for (int i = 0; i < 2; i++)
		for (int k = 0; k < ROW_ROOM; k++)
			made[i][0][k] = made[i][1][k] = GUARD;
	for (int i = 0; i < 2; i++) {
		filters->double_cubic(coarse, ROW_ROOM, made[i][0] + shift, made[i][1] + shift,
				      count, streams[i]);
		filters->settle();
		for (int row = 0; row < 2; row++)
			for (int k = 0; k < ROW_ROOM; k++)
				if ((k < shift || k >= shift + count) && made[i][row][k] != GUARD)
					fail_msg("%s: %d points from %d on wrote point %d",
						 filters->name, count, shift, k);
	}
	assert_memory_equal(made[0], made[1], sizeof made[0]);
}

static void rows_end_where_they_are_told_to(void **state)
{
	(void)state;
	static const char *const sets[] = { "portable", "avx2", "avx512" };
	static uint32_t coarse[5][ROW_ROOM];
	uint32_t seed = 7;
	for (int y = 0; y < 5; y++)
		for (int x = 0; x < ROW_ROOM; x++)
			coarse[y][x] = random_point(&seed);
	for (size_t set = 0; set < sizeof sets / sizeof sets[0]; set++) {
		if (!gz_cast_kernels_find(sets[set]))
			continue;
		for (int shift = 0; shift < 18; shift++)
			for (int count = 1; count <= 72; count++)
				check_rows(gz_row_filters_find(sets[set]), &coarse[1][1], shift,
					   count);
		check_rows(gz_row_filters_find(sets[set]), &coarse[1][1], 3, GZ_ROW_STREAMED);
	}
}

static void one_other_point_anywhere_is_not_flat(void **state)
{
	(void)state;
	static const char *const sets[] = { "portable", "avx2", "avx512" };
	enum { STRIDE = 48, ROWS = 3 };
	uint32_t points[STRIDE * ROWS];
	for (size_t set = 0; set < sizeof sets / sizeof sets[0]; set++) {
		if (!gz_cast_kernels_find(sets[set]))
			continue;
		const struct gz_row_filters *filters = gz_row_filters_find(sets[set]);
		for (int columns = 1; columns <= 40; columns++)
			for (int odd = -1; odd < STRIDE * ROWS; odd++) {
				for (int i = 0; i < STRIDE * ROWS; i++)
					points[i] = i == odd ? 0xFF000001 : 0xFF000000;
				const bool inside = odd >= 0 && odd % STRIDE < columns;
				const bool flat =
					filters->all_are(points, STRIDE, columns, ROWS, 0xFF000000);
				if (flat == inside)
					fail_msg("%s: %d columns, point %d differs, flat %d",
						 sets[set], columns, odd, flat);
			}
	}
}

static void picture_of_one_colour_stays_it(void **state)
{
	(void)state;
	static const uint32_t colours[] = { 0xFF000000, 0xFFFFFFFF, 0xFF010101, 0xFF7F80FE };
	struct gz_workers *workers;
	assert_int_equal(gz_workers_create(2, &workers), GZ_OK);
	for (size_t i = 0; i < sizeof colours / sizeof colours[0]; i++)
		for (int filter = 0; filter < 2; filter++) {
			struct gz_foveation foveation = gz_foveation_default();
			foveation.filter = filter;
			struct scene scene;
			make_scene(&foveation, (struct gz_point) { 0.4F, 0.4F }, 301, 207,
				   colours[i], ONE_COLOUR, &scene);
			gz_reconstruct(&scene.plan, &scene.lattices,
				       gz_row_filters_find("portable"), workers,
				       gz_image_words(&scene.image));
			const uint32_t *pixels = (const uint32_t *)(const void *)scene.image.pixels;
			for (int k = 0; k < 301 * 207; k++)
				assert_int_equal(pixels[k], colours[i]);
			free_scene(&scene);
		}
	gz_workers_destroy(&workers);
}

static void edge_never_rings(void **state)
{
	(void)state;
	const struct gz_row_filters *filters = gz_row_filters_find("portable");
	uint32_t row[ROW_ROOM], even[16], odd[16];
	for (int i = 0; i < ROW_ROOM; i++)
		row[i] = i < 8 ? 0xFF000000 : 0xFFFFFFFF;
	filters->double_cubic(row + 1, 0, even, odd, 16, false); /* the same row above and below */
	for (int i = 0; i < 16; i++)
		if (i < 13)
			assert_int_equal(even[i], 0xFF000000); /* background stays black */
		else if (i > 13)
			assert_int_equal(even[i], 0xFFFFFFFF);
		else
			assert_int_equal(even[i], 0xFF808080);
	assert_memory_equal(even, odd, sizeof even);
}

TEST_SUITE(reconstruct)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(pyramid_of_any_size_and_gaze_follows_its_formulas),
		cmocka_unit_test(large_pictures_follow_the_formulas_too),
		cmocka_unit_test(rows_end_where_they_are_told_to),
		cmocka_unit_test(one_other_point_anywhere_is_not_flat),
		cmocka_unit_test(picture_of_one_colour_stays_it),
		cmocka_unit_test(edge_never_rings),
	};
	return cmocka_run_group_tests_name("reconstruct", tests, NULL, NULL);
}
