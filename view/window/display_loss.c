#include "view/window/display_loss.h"

#include <pthread.h>
#include <setjmp.h>
#include <stdbool.h>
#include <stdlib.h>
#include <unistd.h>

#include <X11/Xlib.h>

#include "base/log.h"

/* Xlib hands nothing of ours to its handler. Set while gz_display_loss_guard() runs. */
static struct {
	bool set;
	pthread_t thread;
	jmp_buf way_out;
} guard;

/* Whoever returns from here is ended by Xlib. */
static int on_loss(Display *display)
{
	(void)display;
	if (guard.set && pthread_equal(guard.thread, pthread_self()))
		longjmp(guard.way_out, 1);
	gz_log_to_stderr(NULL, GZ_LOG_ERROR, "window",
			 "the display is gone: its X server has ended");
	_exit(EXIT_FAILURE);
}

enum gz_result gz_display_loss_guard(enum gz_result (*run)(void *user), void *user, bool *out_lost)
{
	guard.thread = pthread_self();
	if (setjmp(guard.way_out) != 0) {
		guard.set = false;
		*out_lost = true;
		return GZ_ERR_NO_DEVICE;
	}
	guard.set = true;
	XSetIOErrorHandler(on_loss);
	const enum gz_result r = run(user);
	guard.set = false;
	return r;
}
