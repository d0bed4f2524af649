/* Files of bricks from anywhere. Whatever the bytes, opening ends and takes no more memory than the
 * file can fill; what is opened has a level for every place, and voxels that keep the promises of
 * volume.h. */
#include <math.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "render/data/brick_pool.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

/* For the least number of bricks of any type. */
#define ROOM_BYTES ((size_t)GZ_BRICK_POOL_LEAST * GZ_BRICK_VOXELS * sizeof(float))

static char path[64];

static void require(bool holds)
{
	if (!holds)
		abort();
}

static void remove_file(void)
{
	unlink(path);
}

static void make_file(const uint8_t *data, size_t size)
{
	if (!path[0]) {
		strcpy(path, "/dev/shm/gazecast-fuzz-XXXXXX");
		int fd = mkstemp(path);
		if (fd < 0) {
			strcpy(path, "/tmp/gazecast-fuzz-XXXXXX");
			fd = mkstemp(path);
		}
		require(fd >= 0);
		close(fd);
		atexit(remove_file);
	}
	FILE *file = fopen(path, "wb");
	require(file != NULL);
	require(fwrite(data, 1, size, file) == size);
	require(fclose(file) == 0);
}

static void check_voxels(const struct gz_brick_file *file, const void *voxels)
{
	volatile uint8_t sum = 0; /* so that every byte is read */
	for (size_t i = 0; i < GZ_BRICK_VOXELS * gz_voxel_size(file->header.type); i++)
		sum = (uint8_t)(sum + ((const uint8_t *)voxels)[i]);
	if (file->header.type == GZ_VOXEL_F32)
		for (size_t i = 0; i < GZ_BRICK_VOXELS; i++)
			require(isfinite(((const float *)voxels)[i]));
}

static void check_view(const struct gz_brick_pool *pool, const struct gz_brick_view *view)
{
	const struct gz_brick_file *file = gz_brick_pool_file(pool);
	const size_t bytes = GZ_BRICK_VOXELS * gz_voxel_size(file->header.type);
	require(view->coming == 0);
	for (size_t i = 0; i < file->layout.brick_count; i++) {
		int level, brick[3];
		gz_brick_place(&file->layout, i, &level, brick);
		const int32_t entry = view->table[i];
		require(entry >= 0);
		require((entry & ((1 << GZ_BRICK_LEVEL_BITS) - 1)) >= level);
		const size_t room = (size_t)entry >> GZ_BRICK_LEVEL_BITS;
		require(room < gz_brick_pool_rooms(pool));
		if (i < 64)
			check_voxels(file, (const uint8_t *)view->voxels + room * bytes);
	}
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	static struct gz_brick_want wants[4096];
	struct gz_brick_pool *pool = NULL;
	make_file(data, size);
	if (gz_brick_pool_open(path, ROOM_BYTES, NULL, &pool) != GZ_OK)
		return 0;
	const struct gz_brick_file *file = gz_brick_pool_file(pool);
	const size_t count = file->layout.brick_count < 4096 ? file->layout.brick_count : 4096;
	for (size_t i = 0; i < count; i++)
		wants[i] = (struct gz_brick_want) { .brick = (uint32_t)i, .weight = 1 };
	struct gz_brick_view view;
	gz_brick_pool_turn(pool, wants, count, true, &view);
	check_view(pool, &view);
	gz_brick_pool_destroy(&pool);
	return 0;
}
