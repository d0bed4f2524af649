/* A fake liblsl of version LSL_STAND_IN_VERSION, with the functions that the daemon looks up. Its
 * types follow liblsl's headers, not ours, so that a wrong type in our header fails the tests. */
#include "lsl_stand_in.h"

#include <sched.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#define EXPORT __attribute__((visibility("default")))

/* Types as in the headers. */
typedef enum { cft_undefined = 0, cft_double64 = 2, cft_string = 3 } lsl_channel_format_t;
typedef enum { lsl_no_error = 0, lsl_internal_error = -4 } lsl_error_code_t;
typedef struct lsl_stand_in_info *lsl_streaminfo;
typedef struct lsl_stand_in_outlet *lsl_outlet;
typedef struct lsl_stand_in_info *lsl_xml_ptr; /* the innermost open element, see append_child */

/* Each is exported for dlsym() only. */
EXPORT struct lsl_stand_in *lsl_stand_in_control(void);
EXPORT lsl_streaminfo lsl_create_streaminfo(const char *name, const char *type,
					    int32_t channel_count, double nominal_srate,
					    lsl_channel_format_t channel_format,
					    const char *source_id);
EXPORT void lsl_destroy_streaminfo(lsl_streaminfo info);
EXPORT lsl_xml_ptr lsl_get_desc(lsl_streaminfo info);
EXPORT lsl_xml_ptr lsl_append_child(lsl_xml_ptr e, const char *name);
EXPORT lsl_xml_ptr lsl_append_child_value(lsl_xml_ptr e, const char *name, const char *value);
EXPORT lsl_outlet lsl_create_outlet(lsl_streaminfo info, int32_t chunk_size, int32_t max_buffered);
EXPORT void lsl_destroy_outlet(lsl_outlet out);
EXPORT int32_t lsl_have_consumers(lsl_outlet out);
EXPORT int32_t lsl_push_sample_dtp(lsl_outlet out, const double *data, double timestamp,
				   int32_t pushthrough);
EXPORT int32_t lsl_push_sample_strtp(lsl_outlet out, const char **data, double timestamp,
				     int32_t pushthrough);
EXPORT double lsl_local_clock(void);
EXPORT int32_t lsl_library_version(void);
#if LSL_STAND_IN_VERSION >= 115
EXPORT const char *lsl_last_error(void);
#endif

static struct lsl_stand_in control = { .mutex = PTHREAD_MUTEX_INITIALIZER };

struct lsl_stand_in *lsl_stand_in_control(void)
{
	return &control;
}

lsl_streaminfo lsl_create_streaminfo(const char *name, const char *type, int32_t channel_count,
				     double nominal_srate, lsl_channel_format_t channel_format,
				     const char *source_id)
{
	lsl_streaminfo info = calloc(1, sizeof *info);
	snprintf(info->name, sizeof info->name, "%s", name);
	snprintf(info->type, sizeof info->type, "%s", type);
	snprintf(info->source, sizeof info->source, "%s", source_id);
	info->channels = channel_count;
	info->format = (int32_t)channel_format;
	info->rate_hz = nominal_srate;
	atomic_fetch_add(&control.descriptions, 1);
	return info;
}

void lsl_destroy_streaminfo(lsl_streaminfo info)
{
	free(info);
	atomic_fetch_sub(&control.descriptions, 1);
}

/*
 * An element is a pointer into its parents' names. The daemon describes a stream from the top to
 * the bottom, so a new child of an outer element closes the inner ones.
 */

struct element {
	lsl_streaminfo info;
	int depth;
};

static struct element elements[512];
static int element_count;

static lsl_xml_ptr new_element(lsl_streaminfo info, int depth)
{
	struct element *element = &elements[element_count++ % 512];
	*element = (struct element) { info, depth };
	return (lsl_xml_ptr)(void *)element;
}

static void write_text(lsl_streaminfo info, const char *before, const char *text, const char *after)
{
	size_t used = strlen(info->description);
	snprintf(info->description + used, sizeof info->description - used, "%s%s%s", before, text,
		 after);
}

static int open_depth(const struct lsl_stand_in_info *info)
{
	int depth = 0;
	for (const char *c = info->open; *c; c++)
		depth += *c == ' ';
	return depth;
}

static void close_to(lsl_streaminfo info, int depth)
{
	while (open_depth(info) > depth) {
		info->open[strlen(info->open) - 1] = '\0';
		char *last = strrchr(info->open, ' ');
		char *name = last ? last + 1 : info->open;
		write_text(info, "</", name, ">");
		*name = '\0';
	}
}

lsl_xml_ptr lsl_get_desc(lsl_streaminfo info)
{
	return new_element(info, 0);
}

lsl_xml_ptr lsl_append_child(lsl_xml_ptr e, const char *name)
{
	struct element parent = *(struct element *)(void *)e;
	close_to(parent.info, parent.depth);
	write_text(parent.info, "<", name, ">");
	size_t used = strlen(parent.info->open);
	snprintf(parent.info->open + used, sizeof parent.info->open - used, "%s ", name);
	return new_element(parent.info, parent.depth + 1);
}

lsl_xml_ptr lsl_append_child_value(lsl_xml_ptr e, const char *name, const char *value)
{
	struct element parent = *(struct element *)(void *)e;
	close_to(parent.info, parent.depth);
	write_text(parent.info, "<", name, ">");
	write_text(parent.info, "", value, "</");
	write_text(parent.info, "", name, ">");
	return e;
}

lsl_outlet lsl_create_outlet(lsl_streaminfo info, int32_t chunk_size, int32_t max_buffered)
{
	(void)chunk_size;
	if (control.refuse)
		return NULL;
	pthread_mutex_lock(&control.mutex);
	lsl_outlet outlet = &control.outlets[control.outlet_count++ % LSL_STAND_IN_OUTLETS];
	close_to(info, 0);
	outlet->info = *info;
	outlet->max_buffered = max_buffered;
	outlet->open = true;
	outlet->pushes = 0;
	if (!outlet->kept)
		outlet->kept = calloc(LSL_STAND_IN_KEPT, sizeof *outlet->kept);
	pthread_mutex_unlock(&control.mutex);
	return outlet;
}

/* Append a line to the file, if there is one. */
static void report(const char *text, int number)
{
	const char *path = getenv(LSL_STAND_IN_FILE);
	FILE *file = path ? fopen(path, "a") : NULL;
	if (!file)
		return;
	fprintf(file, "%s %d\n", text, number);
	fclose(file);
}

void lsl_destroy_outlet(lsl_outlet out)
{
	pthread_mutex_lock(&control.mutex);
	out->open = false;
	report(out->info.type, out->pushes);
	pthread_mutex_unlock(&control.mutex);
}

int32_t lsl_have_consumers(lsl_outlet out)
{
	(void)out;
	return atomic_load(&control.consumers);
}

static int32_t take_push(lsl_outlet out, const struct lsl_stand_in_push *push)
{
	atomic_fetch_add(&control.pushing, 1);
	while (atomic_load(&control.busy))
		sched_yield();
	if (atomic_load(&control.refuse_push)) {
		atomic_fetch_sub(&control.pushing, 1);
		return lsl_internal_error;
	}
	pthread_mutex_lock(&control.mutex);
	if (out->pushes < LSL_STAND_IN_KEPT)
		out->kept[out->pushes] = *push;
	out->pushes++;
	pthread_mutex_unlock(&control.mutex);
	atomic_fetch_sub(&control.pushing, 1);
	return lsl_no_error;
}

int32_t lsl_push_sample_dtp(lsl_outlet out, const double *data, double timestamp,
			    int32_t pushthrough)
{
	struct lsl_stand_in_push push = { .time_s = timestamp, .pushthrough = pushthrough };
	memcpy(push.values, data, (size_t)out->info.channels * sizeof *data);
	return take_push(out, &push);
}

int32_t lsl_push_sample_strtp(lsl_outlet out, const char **data, double timestamp,
			      int32_t pushthrough)
{
	struct lsl_stand_in_push push = { .time_s = timestamp, .pushthrough = pushthrough };
	snprintf(push.text, sizeof push.text, "%s", data[0]);
	report(push.text, 1);
	return take_push(out, &push);
}

double lsl_local_clock(void)
{
	struct timespec now;
	clock_gettime(CLOCK_MONOTONIC, &now);
	return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec + control.clock_s;
}

int32_t lsl_library_version(void)
{
	return LSL_STAND_IN_VERSION;
}

#if LSL_STAND_IN_VERSION >= 115
const char *lsl_last_error(void)
{
	return "the stand-in refuses";
}
#endif
