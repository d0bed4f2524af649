/*
 * Drops files on a window, as a file manager does: the source's side of XDND 5
 * (https://freedesktop.org/wiki/Specifications/XDND). For tests of windows.
 *
 *   drop_files WINDOW PATH...    exit status 0 once the window says that it has taken them
 */
#include <ctype.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <X11/Xatom.h>
#include <X11/Xlib.h>

/* A window that does not answer has failed the test. */
enum { PATIENCE_S = 20, VERSION = 5, LIST_SIZE = 65536 };

struct source {
	Display *display;
	Window window, target;
	char list[LIST_SIZE]; /* of URIs, one a line */
};

static Atom atom(const struct source *source, const char *name)
{
	return XInternAtom(source->display, name, False);
}

/* RFC 3986: what is not unreserved, nor a slash, is written %XX. RFC 2483, section 5: lines end
 * with CR LF. */
static bool add_uri(struct source *source, const char *path)
{
	size_t used = strlen(source->list);
	if (path[0] != '/' || used + 3 * strlen(path) + 16 > sizeof source->list)
		return false;
	used += (size_t)sprintf(source->list + used, "file://");
	for (const unsigned char *at = (const unsigned char *)path; *at; at++)
		used += (size_t)sprintf(source->list + used,
					isalnum(*at) || strchr("-._~/", *at) ? "%c" : "%%%02X",
					*at);
	sprintf(source->list + used, "\r\n");
	return true;
}

static void tell(const struct source *source, const char *what, const long data[4])
{
	XEvent event = { .xclient = {
				 .type = ClientMessage,
				 .window = source->target,
				 .message_type = atom(source, what),
				 .format = 32,
			 } };
	event.xclient.data.l[0] = (long)source->window;
	memcpy(event.xclient.data.l + 1, data, 4 * sizeof data[0]);
	XSendEvent(source->display, source->target, False, NoEventMask, &event);
	XFlush(source->display);
}

static bool is_aware(const struct source *source)
{
	Atom type;
	int format;
	unsigned long count = 0, left;
	unsigned char *bytes = NULL;
	XGetWindowProperty(source->display, source->target, atom(source, "XdndAware"), 0, 1, False,
			   XA_ATOM, &type, &format, &count, &left, &bytes);
	if (bytes)
		XFree(bytes);
	return count == 1;
}

/* The target asks for the list of files. */
static void hand_over(const struct source *source, const XSelectionRequestEvent *request)
{
	XEvent event = { .xselection = {
				 .type = SelectionNotify,
				 .requestor = request->requestor,
				 .selection = request->selection,
				 .target = request->target,
				 .property = request->property,
				 .time = request->time,
			 } };
	XChangeProperty(source->display, request->requestor, request->property, request->target, 8,
			PropModeReplace, (const unsigned char *)source->list,
			(int)strlen(source->list));
	XSendEvent(source->display, request->requestor, False, NoEventMask, &event);
	XFlush(source->display);
}

/* The next message of that name; serves the selection meanwhile. @return its second number */
static long await(const struct source *source, const char *what)
{
	for (;;) {
		XEvent event;
		XNextEvent(source->display, &event);
		if (event.type == SelectionRequest)
			hand_over(source, &event.xselectionrequest);
		if (event.type == ClientMessage && event.xclient.message_type == atom(source, what))
			return event.xclient.data.l[1];
	}
}

static bool drop(struct source *source)
{
	Window child;
	int x, y;
	const long list = (long)atom(source, "text/uri-list");
	XTranslateCoordinates(source->display, source->target, DefaultRootWindow(source->display),
			      50, 50, &x, &y, &child);
	XSetSelectionOwner(source->display, atom(source, "XdndSelection"), source->window,
			   CurrentTime);
	tell(source, "XdndEnter", (const long[]) { (long)VERSION << 24, list, 0, 0 });
	tell(source, "XdndPosition",
	     (const long[]) { 0, (long)x << 16 | y, CurrentTime,
			      (long)atom(source, "XdndActionCopy") });
	if (!(await(source, "XdndStatus") & 1)) {
		fprintf(stderr, "drop_files: the window does not want them\n");
		return false;
	}
	tell(source, "XdndDrop", (const long[]) { 0, CurrentTime, 0, 0 });
	/* By the protocol bit 0 tells; GLFW 3.3 sends how many bytes it has read. */
	return await(source, "XdndFinished") != 0;
}

int main(int argc, char **argv)
{
	static struct source source;
	source.display = XOpenDisplay(NULL);
	if (!source.display || argc < 3) {
		fprintf(stderr, "usage: drop_files WINDOW /PATH... with DISPLAY set\n");
		return EXIT_FAILURE;
	}
	source.target = strtoul(argv[1], NULL, 0);
	for (int i = 2; i < argc; i++)
		if (!add_uri(&source, argv[i])) {
			fprintf(stderr, "drop_files: %s: not an absolute path, or too long\n",
				argv[i]);
			return EXIT_FAILURE;
		}
	alarm(PATIENCE_S);
	source.window = XCreateSimpleWindow(source.display, DefaultRootWindow(source.display), 0, 0,
					    1, 1, 0, 0, 0);
	if (!is_aware(&source)) {
		fprintf(stderr, "drop_files: %s takes no files\n", argv[1]);
		return EXIT_FAILURE;
	}
	return drop(&source) ? EXIT_SUCCESS : EXIT_FAILURE;
}
