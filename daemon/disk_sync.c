#include "daemon/disk_sync.h"

#include <errno.h>
#include <fcntl.h>
#include <pthread.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/sizes.h"

#define GZ_LOG_MODULE "recorder"

struct gz_disk_sync {
	const struct gz_log *log;
	pthread_t thread;
	pthread_mutex_t mutex; /* guards what follows */
	pthread_cond_t changed;
	bool has_request; /* until it is done */
	bool quit;
	int error; /* errno of the last sync, 0 if it succeeded */
	int fd;
	char directory[GZ_PATH_SIZE]; /* empty: none */
};

/* Make the file's name survive a power failure too. */
static void sync_directory_of_names(const struct gz_disk_sync *sync)
{
	int fd = open(sync->directory, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
	if (fd < 0)
		return;
	if (fsync(fd) != 0)
		gz_debug(sync->log, "%s: cannot be synced: %s", sync->directory, strerror(errno));
	close(fd);
}

static int sync_data_of_file(int fd)
{
	/* A pipe or /dev/null cannot be synced. */
	return fdatasync(fd) == 0 || errno == EINVAL || errno == EROFS ? 0 : errno;
}

static void *run_disk_sync(void *user)
{
	struct gz_disk_sync *sync = user;
	pthread_mutex_lock(&sync->mutex);
	for (;;) {
		while (!sync->has_request && !sync->quit)
			pthread_cond_wait(&sync->changed, &sync->mutex);
		if (!sync->has_request)
			break;
		/* The request stays as it is while has_request is set. */
		pthread_mutex_unlock(&sync->mutex);
		if (sync->directory[0])
			sync_directory_of_names(sync);
		const int error = sync_data_of_file(sync->fd);
		pthread_mutex_lock(&sync->mutex);
		sync->error = error;
		sync->has_request = false;
		pthread_cond_broadcast(&sync->changed);
	}
	pthread_mutex_unlock(&sync->mutex);
	return NULL;
}

enum gz_result gz_disk_sync_create(const struct gz_log *log, struct gz_disk_sync **out_sync)
{
	struct gz_disk_sync *sync = calloc(1, sizeof *sync);
	if (!sync)
		return GZ_ERR_NO_MEM;
	sync->log = log;
	pthread_mutex_init(&sync->mutex, NULL);
	pthread_cond_init(&sync->changed, NULL);
	if (pthread_create(&sync->thread, NULL, run_disk_sync, sync) != 0) {
		pthread_cond_destroy(&sync->changed);
		pthread_mutex_destroy(&sync->mutex);
		free(sync);
		return GZ_ERR_NO_MEM;
	}
	*out_sync = sync;
	return GZ_OK;
}

enum gz_result gz_disk_sync_request(struct gz_disk_sync *sync, int fd, const char *directory)
{
	pthread_mutex_lock(&sync->mutex);
	enum gz_result result = sync->has_request ? GZ_ERR_BUSY : sync->error ? GZ_ERR_IO : GZ_OK;
	const int error = sync->error;
	if (result == GZ_OK) {
		sync->fd = fd;
		snprintf(sync->directory, sizeof sync->directory, "%s", directory ? directory : "");
		sync->has_request = true;
		pthread_cond_broadcast(&sync->changed);
	}
	pthread_mutex_unlock(&sync->mutex);
	if (result == GZ_ERR_IO)
		errno = error;
	return result;
}

enum gz_result gz_disk_sync_wait(struct gz_disk_sync *sync)
{
	pthread_mutex_lock(&sync->mutex);
	while (sync->has_request)
		pthread_cond_wait(&sync->changed, &sync->mutex);
	const int error = sync->error;
	sync->error = 0;
	pthread_mutex_unlock(&sync->mutex);
	if (!error)
		return GZ_OK;
	errno = error;
	return GZ_ERR_IO;
}

void gz_disk_sync_destroy(struct gz_disk_sync **sync)
{
	if (!sync || !*sync)
		return;
	struct gz_disk_sync *s = *sync;
	pthread_mutex_lock(&s->mutex);
	s->quit = true;
	pthread_cond_broadcast(&s->changed);
	pthread_mutex_unlock(&s->mutex);
	pthread_join(s->thread, NULL);
	pthread_cond_destroy(&s->changed);
	pthread_mutex_destroy(&s->mutex);
	free(s);
	*sync = NULL;
}
