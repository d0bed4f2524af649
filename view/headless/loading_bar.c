#include "view/headless/loading_bar.h"

#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "base/clock.h"

#define GZ_LOG_MODULE "gazeview"

/* Chosen: loading of less than a third of a second needs no bar; ten updates a second suffice. */
#define BAR_AFTER_NS  (300 * GZ_NS_PER_MS)
#define BAR_EVERY_NS  (100 * GZ_NS_PER_MS)
#define LINE_AFTER_NS (1000 * GZ_NS_PER_MS)

enum { NAME_COLUMNS = 32, BAR_COLUMNS = 24, LINE_SIZE = 128 };

/* Set by the handler; the only state a signal can reach. */
static volatile sig_atomic_t signal_seen;

static void on_loading_signal(int number)
{
	signal_seen = number;
}

void gz_loading_bar_text(const char *what, double share, double spent_s, char *out, size_t size)
{
	static const char full[] = "########################";
	const size_t length = strlen(what);
	const bool cut = length > NAME_COLUMNS;
	const char *name = cut ? what + length - (NAME_COLUMNS - 3) : what;
	int filled = (int)(share * BAR_COLUMNS);
	filled = filled < 0 ? 0 : filled > BAR_COLUMNS ? BAR_COLUMNS : filled;
	char left[24] = "";
	if (share > 0.01 && share <= 1)
		snprintf(left, sizeof left, "%.0f s left", spent_s / share * (1 - share));
	snprintf(out, size, "%s%s [%.*s%*s] %3.0f %% %s", cut ? "..." : "", name, filled, full,
		 BAR_COLUMNS - filled, "", 100 * share, left);
}

static void draw_bar(struct gz_loading_bar *bar, int64_t now_ns, double share, const char *what)
{
	char text[LINE_SIZE];
	gz_loading_bar_text(what, share, gz_ns_to_s(now_ns - bar->begin_ns), text, sizeof text);
	if (bar->terminal)
		fprintf(stderr, "\r\033[K%s", text);
	else if (!bar->drawn)
		gz_info(bar->log, "loading %s", text);
	bar->drawn = true;
}

static bool report_loading(void *user, double share, const char *what)
{
	struct gz_loading_bar *bar = user;
	const int64_t now_ns = gz_clock_now_ns();
	if (signal_seen)
		return false;
	if (now_ns < bar->next_ns)
		return true;
	bar->next_ns = bar->terminal ? now_ns + BAR_EVERY_NS : INT64_MAX;
	draw_bar(bar, now_ns, share, what);
	return true;
}

void gz_loading_bar_begin(struct gz_loading_bar *bar, const struct gz_log *log)
{
	*bar = (struct gz_loading_bar) {
		.loading = { .report = report_loading, .user = bar },
		.log = log,
		.begin_ns = gz_clock_now_ns(),
		.terminal = isatty(STDERR_FILENO) == 1,
	};
	bar->next_ns = bar->begin_ns + (bar->terminal ? BAR_AFTER_NS : LINE_AFTER_NS);
	struct sigaction action = { .sa_handler = on_loading_signal,
				    .sa_flags = (int)SA_RESETHAND };
	sigemptyset(&action.sa_mask);
	signal_seen = 0;
	sigaction(SIGINT, &action, &bar->interrupt);
	sigaction(SIGTERM, &action, &bar->terminate);
}

void gz_loading_bar_end(struct gz_loading_bar *bar)
{
	if (bar->terminal && bar->drawn)
		fputs("\r\033[K", stderr);
	sigaction(SIGINT, &bar->interrupt, NULL);
	sigaction(SIGTERM, &bar->terminate, NULL);
	if (signal_seen)
		raise(signal_seen);
}
