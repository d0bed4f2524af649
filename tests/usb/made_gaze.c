#include "suite.h"

#include "made_gaze.h"

#include <signal.h>
#include <time.h>

/* Moves up and down between 0 and 1, with a period of @p period samples. */
static double wander(uint64_t number, uint64_t period)
{
	double phase = (double)(number % period) / (double)period;
	return phase < 0.5 ? 2 * phase : 2 - 2 * phase;
}

struct made_sample made_gaze(uint64_t number)
{
	return (struct made_sample) {
		.number = number,
		/* Exposures are never exactly on time. */
		.device_us = MADE_CLOCK_START_US + (int64_t)number * MADE_PERIOD_US +
			     (int64_t)(number * 37 % 101 * 15),
		.x = 0.25 + 0.5 * wander(number, 1700),
		.y = 0.3 + 0.4 * wander(number, 1100),
	};
}

struct made_sample made_gaze_at(int64_t device_ns)
{
	int64_t since_us = device_ns / 1000 - MADE_CLOCK_START_US;
	return made_gaze((uint64_t)((since_us + MADE_PERIOD_US / 2) / MADE_PERIOD_US));
}

static int64_t boottime_us(void)
{
	struct timespec now;
	clock_gettime(CLOCK_BOOTTIME, &now);
	return (int64_t)now.tv_sec * 1000000 + now.tv_nsec / 1000;
}

static void *run_stream(void *argument)
{
	struct made_stream *stream = argument;
	struct timespec pause = { .tv_nsec = 500000 };
	uint64_t next = 0;
	while (!stream->stop) {
		uint64_t number = (uint64_t)(boottime_us() - stream->start_us) / MADE_PERIOD_US;
		if (number < next) {
			nanosleep(&pause, NULL);
			continue;
		}
		next = number + 1;
		struct made_sample sample = made_gaze(number);
		stream->send(stream->tracker, &sample);
	}
	return NULL;
}

static void wake(int signal)
{
	(void)signal;
}

void made_stream_start(struct made_stream *stream)
{
	/* Without SA_RESTART the signal ends a blocking write(). */
	const struct sigaction action = { .sa_handler = wake };
	sigaction(SIGUSR1, &action, NULL);
	stream->stop = false;
	if (stream->start_us == 0)
		stream->start_us = boottime_us();
	assert_int_equal(pthread_create(&stream->thread, NULL, run_stream, stream), 0);
	stream->running = true;
}

void made_stream_stop(struct made_stream *stream)
{
	struct timespec deadline;
	if (!stream->running)
		return;
	stream->stop = true;
	/* The thread may wait for a host that no longer reads. */
	do {
		pthread_kill(stream->thread, SIGUSR1);
		clock_gettime(CLOCK_REALTIME, &deadline);
		deadline.tv_sec += deadline.tv_nsec / 980000000;
		deadline.tv_nsec = (deadline.tv_nsec + 20000000) % 1000000000;
	} while (pthread_timedjoin_np(stream->thread, NULL, &deadline) != 0);
	stream->running = false;
}
