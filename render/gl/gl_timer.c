#include "render/gl/gl_timer.h"

#include <GL/glew.h>

#include "base/clock.h"

void gz_gl_timer_mark(struct gz_gl_timer *timer, const struct gz_gl_device *device, int mark)
{
	if (device->software) {
		glFinish();
		timer->marks_ns[mark] = gz_clock_now_ns();
		return;
	}
	if (!timer->queries[0])
		glGenQueries(GZ_GL_MARKS_MAX, timer->queries);
	glQueryCounter(timer->queries[mark], GL_TIMESTAMP);
}

static int64_t mark_ns(const struct gz_gl_timer *timer, const struct gz_gl_device *device, int mark)
{
	GLint64 ns = 0;
	if (device->software)
		return timer->marks_ns[mark];
	glGetQueryObjecti64v(timer->queries[mark], GL_QUERY_RESULT, &ns);
	return ns;
}

double gz_gl_timer_ms(const struct gz_gl_timer *timer, const struct gz_gl_device *device, int from,
		      int to)
{
	return gz_ns_to_ms(mark_ns(timer, device, to) - mark_ns(timer, device, from));
}

void gz_gl_timer_free(struct gz_gl_timer *timer)
{
	if (timer->queries[0])
		glDeleteQueries(GZ_GL_MARKS_MAX, timer->queries);
	*timer = (struct gz_gl_timer) { 0 };
}
