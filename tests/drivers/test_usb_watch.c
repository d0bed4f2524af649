/* The USB watch with a fake libusb. */
#include "suite.h"

#include <libusb.h>
#include <poll.h>
#include <pthread.h>
#include <stdint.h>
#include <string.h>
#include <unistd.h>

#include "drivers/usb/usb_watch.h"

struct libusb_context {
	pthread_mutex_t lock;
	pthread_cond_t changed;
	int arrivals; /* not reported yet */
	int waits;
	bool interrupted;
};

static struct libusb_context bus = { PTHREAD_MUTEX_INITIALIZER, PTHREAD_COND_INITIALIZER, 0, 0,
				     false };
static libusb_hotplug_callback_fn callback;
static void *callback_user;
static int events_wanted, contexts;
static int has_hotplug = 1, init_error, register_error;

int libusb_has_capability(uint32_t capability)
{
	return capability == LIBUSB_CAP_HAS_HOTPLUG ? has_hotplug : 1;
}

int libusb_init(libusb_context **context)
{
	if (init_error)
		return init_error;
	contexts++;
	*context = &bus;
	return LIBUSB_SUCCESS;
}

void libusb_exit(libusb_context *context)
{
	assert_ptr_equal(context, &bus);
	contexts--;
}

int libusb_hotplug_register_callback(libusb_context *context, int events, int flags, int vendor_id,
				     int product_id, int dev_class,
				     libusb_hotplug_callback_fn function, void *user,
				     libusb_hotplug_callback_handle *handle)
{
	assert_ptr_equal(context, &bus);
	assert_int_equal(flags, 0);
	assert_int_equal(vendor_id & product_id & dev_class, LIBUSB_HOTPLUG_MATCH_ANY);
	assert_null(handle);
	events_wanted = events;
	callback = function;
	callback_user = user;
	return register_error;
}

int libusb_handle_events(libusb_context *context)
{
	pthread_mutex_lock(&context->lock);
	context->waits++;
	pthread_cond_broadcast(&context->changed);
	while (context->arrivals == 0 && !context->interrupted)
		pthread_cond_wait(&context->changed, &context->lock);
	bool arrived = context->arrivals > 0;
	context->arrivals -= arrived;
	context->interrupted = false;
	pthread_mutex_unlock(&context->lock);
	if (arrived)
		assert_int_equal(
			callback(context, NULL, LIBUSB_HOTPLUG_EVENT_DEVICE_ARRIVED, callback_user),
			0);
	return LIBUSB_SUCCESS;
}

void libusb_interrupt_event_handler(libusb_context *context)
{
	pthread_mutex_lock(&context->lock);
	context->interrupted = true;
	pthread_cond_broadcast(&context->changed);
	pthread_mutex_unlock(&context->lock);
}

const char *libusb_error_name(int error)
{
	(void)error;
	return "an error";
}

static void plug(int count)
{
	pthread_mutex_lock(&bus.lock);
	bus.arrivals += count;
	pthread_cond_broadcast(&bus.changed);
	pthread_mutex_unlock(&bus.lock);
}

/* Wait until libusb has been waited in @p waits times, so that all earlier events are reported. */
static void wait_told(int waits)
{
	pthread_mutex_lock(&bus.lock);
	while (bus.waits < waits)
		pthread_cond_wait(&bus.changed, &bus.lock);
	pthread_mutex_unlock(&bus.lock);
}

static bool is_readable(int fd, int timeout_ms)
{
	struct pollfd poll_fd = { .fd = fd, .events = POLLIN };
	return poll(&poll_fd, 1, timeout_ms) == 1;
}

static void watch_reports_arrivals_until_they_are_read(void **state)
{
	(void)state;
	struct gz_usb_watch *watch;
	uint64_t count;
	assert_int_equal(gz_usb_watch_create("/dev/null", NULL, &watch), GZ_OK);
	assert_int_equal(events_wanted, LIBUSB_HOTPLUG_EVENT_DEVICE_ARRIVED);
	int fd = gz_usb_watch_fd(watch);
	wait_told(1);
	assert_false(is_readable(fd, 0));
	plug(3);
	assert_true(is_readable(fd, 10000));
	wait_told(4);
	assert_int_equal(read(fd, &count, sizeof count), sizeof count);
	assert_int_equal(count, 3);
	assert_false(is_readable(fd, 0));
	plug(1);
	assert_true(is_readable(fd, 10000));
	gz_usb_watch_destroy(&watch);
	assert_null(watch);
	assert_int_equal(contexts, 0);
	gz_usb_watch_destroy(&watch);
	gz_usb_watch_destroy(NULL);
	assert_int_equal(gz_usb_watch_fd(NULL), -1);
}

static int lines;

static void count_line(void *user, enum gz_log_level level, const char *module, const char *message)
{
	(void)user;
	(void)level;
	(void)module;
	lines += strstr(message, "no udev here") != NULL;
}

static void watch_without_hot_plug_is_refused_with_one_line(void **state)
{
	(void)state;
	struct gz_log log;
	struct gz_usb_watch *watch = NULL;
	gz_log_init(&log, count_line, NULL, "*:info");
	assert_int_equal(gz_usb_watch_create("/nonexistent", &log, &watch), GZ_ERR_UNSUPPORTED);
	assert_int_equal(lines, 1);
	has_hotplug = 0;
	assert_int_equal(gz_usb_watch_create("/dev/null", &log, &watch), GZ_ERR_UNSUPPORTED);
	assert_int_equal(lines, 2);
	has_hotplug = 1;
	init_error = LIBUSB_ERROR_OTHER;
	assert_int_equal(gz_usb_watch_create("/dev/null", &log, &watch), GZ_ERR_IO);
	init_error = 0;
	register_error = LIBUSB_ERROR_NO_MEM;
	assert_int_equal(gz_usb_watch_create("/dev/null", &log, &watch), GZ_ERR_IO);
	register_error = 0;
	assert_null(watch);
	assert_int_equal(contexts, 0);
}

TEST_SUITE(usb_watch)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(watch_reports_arrivals_until_they_are_read),
		cmocka_unit_test(watch_without_hot_plug_is_refused_with_one_line),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
