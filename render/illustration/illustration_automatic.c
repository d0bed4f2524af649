#include "render/illustration/illustration_automatic.h"

#include <math.h>

#include "base/clock.h"

/* Parts of a change, in the order of its members. */
enum { PART_EDGES, PART_AMPLITUDE, PARTS = 5 };

/* Longest pause that counts, s. */
#define PAUSE_S 0.1

/* Time in which a setting would reach where it goes if it kept its speed, s. Chosen: it slows down
 * over the last stretch, so that what it changes in the measures does not make it swing. */
#define APPROACH_S 0.4

/* What a setting is still away from where it goes when it stays. Chosen: not seen. */
#define REST 0.004

/* Objects that cover less of the picture change nothing: there is too little to measure. */
#define COVERED_LEAST 0.005

static double *part_of(struct gz_illustration_change *change, int part)
{
	double *const all[PARTS] = { &change->edge_emphasis, &change->detail_amplitude,
				     &change->detail_frequency, &change->spatial_effect,
				     &change->foreground };
	return all[part];
}

static double read_part(const struct gz_illustration_change *change, int part)
{
	struct gz_illustration_change copy = *change;
	return *part_of(&copy, part);
}

/* The setting that a part changes. */
static double *setting_of(struct gz_illustration_settings *combined, int part)
{
	double *const all[PARTS] = { &combined->edge_emphasis, &combined->detail_amplitude,
				     &combined->detail_frequency, &combined->spatial_effect,
				     &combined->foreground };
	return all[part];
}

bool gz_illustration_change_same(const struct gz_illustration_change *a,
				 const struct gz_illustration_change *b)
{
	for (int part = 0; part < PARTS; part++)
		if (read_part(a, part) != read_part(b, part))
			return false;
	return true;
}

bool gz_illustration_change_valid(const struct gz_illustration_change *change)
{
	for (int part = 0; part < PARTS; part++)
		if (!(fabs(read_part(change, part)) <= GZ_AUTOMATIC_MOST))
			return false;
	return true;
}

bool gz_illustration_is_automatic(const struct gz_illustration_look *look)
{
	return look->automatic && look->source == GZ_ILLUSTRATION_COMBINED &&
	       look->show == GZ_SHOW_SHADING;
}

/* What is set, by the template where it says something. */
static struct gz_illustration_settings settings_of(const struct gz_illustration_look *look)
{
	struct gz_illustration_settings combined = look->combined;
	if (look->template_name[0])
		gz_shading_template_apply(&look->shading_template, &combined);
	return combined;
}

static double within(double value, double least, double most)
{
	return fmin(fmax(value, least), most);
}

/* From -1, where a measure is at @p low or below, over 0 at @p medium to 1 at @p high. */
static double grade(double measure, double low, double medium, double high)
{
	return measure < medium ? within((measure - medium) / (medium - low), -1, 0)
				: within((measure - medium) / (high - medium), 0, 1);
}

/* Where settings go, as far as a picture's measures tell. What counts as medium was chosen so that
 * a skull, a brain, a frog's organs and vessels stay near what is set. */
static struct gz_illustration_change wanted_change(const struct gz_illustration_settings *set,
						   const struct gz_shading_measures *measures)
{
	const double roughness = measures->tone_fine / fmax(measures->tone_wide, 1e-3);
	return (struct gz_illustration_change) {
		.edge_emphasis = -GZ_AUTOMATIC_MOST * grade(measures->edges, 4, 20, 80),
		.detail_amplitude = -GZ_AUTOMATIC_MOST * grade(measures->tone_spread, 0, 0.2, 1),
		.detail_frequency = -GZ_AUTOMATIC_MOST * grade(roughness, 0.1, 0.3, 0.7),
		.spatial_effect = GZ_AUTOMATIC_MOST * grade(measures->depth_spread, 0, 0.25, 0.5),
		.foreground = measures->depth_middle / GZ_HAZE_NEAR_OF_FOREGROUND - set->foreground,
	};
}

/* How near a setting may come to where a whole number changes. */
#define MARGIN 1e-6

/* Between which values of edge emphasis lines have the same width: gz_illustration_apply() has
 * ceil(0.5 + 3 e). */
static void bound_edges(double edges, double bounds[2])
{
	const double width = ceil(0.5 + 3 * edges);
	bounds[0] = (width - 1.5) / 3 + MARGIN;
	bounds[1] = (width - 0.5) / 3 - MARGIN;
}

/* Between which values of detail amplitude main light has the same smoothing: that of 0.5 + 4 (1 -
 * 2 a), rounded down, or none. */
static void bound_amplitude(double amplitude, double bounds[2])
{
	const double level = floor(4 * fmax(1 - 2 * amplitude, 0) + 0.5);
	bounds[0] = (1 - (level + 0.5) / 4) / 2 + MARGIN;
	bounds[1] = level > 0 ? (1 - (level - 0.5) / 4) / 2 - MARGIN : 1;
}

/* How far a part may go: within the setting's range, and where what it stands for changes by whole
 * steps, within one. Otherwise lines and forms would jump. */
static void bound_part(int part, double setting, double out_bounds[2])
{
	double bounds[2] = { 0, 1 };
	if (part == PART_EDGES)
		bound_edges(setting, bounds);
	if (part == PART_AMPLITUDE)
		bound_amplitude(setting, bounds);
	out_bounds[0] = within(bounds[0] - setting, -GZ_AUTOMATIC_MOST, 0);
	out_bounds[1] = within(bounds[1] - setting, 0, GZ_AUTOMATIC_MOST);
}

/* Move a part towards where it goes. @return whether it moves */
static bool move_part(double wanted, const double bounds[2], double passed_s, double *part)
{
	const double way = within(wanted, bounds[0], bounds[1]) - *part;
	const double step = GZ_AUTOMATIC_SPEED * passed_s;
	if (fabs(way) < REST)
		return false;
	*part += within(way * fmin(1, passed_s / APPROACH_S), -step, step);
	return true;
}

struct gz_illustration_automatic gz_illustration_automatic_step(
	struct gz_illustration_automatic state, const struct gz_illustration_look *look,
	const struct gz_shading_measures *measures, int64_t now_ns)
{
	if (!gz_illustration_is_automatic(look))
		return (struct gz_illustration_automatic) { 0 };
	const double passed_s =
		state.started ? within(gz_ns_to_s(now_ns - state.now_ns), 0, PAUSE_S) : 0;
	state.now_ns = state.started && now_ns < state.now_ns ? state.now_ns : now_ns;
	state.moving = !state.started && !measures;
	state.started = true;
	if (!measures || measures->covered < COVERED_LEAST)
		return state;
	struct gz_illustration_settings set = settings_of(look);
	const struct gz_illustration_change wanted = wanted_change(&set, measures);
	for (int part = 0; part < PARTS; part++) {
		double bounds[2];
		bound_part(part, *setting_of(&set, part), bounds);
		state.moving |= move_part(read_part(&wanted, part), bounds, passed_s,
					  part_of(&state.change, part));
	}
	return state;
}

void gz_illustration_adapt(const struct gz_illustration_change *change,
			   struct gz_illustration_look *look)
{
	if (!gz_illustration_is_automatic(look))
		return;
	look->combined = settings_of(look);
	look->template_name[0] = '\0';
	for (int part = 0; part < PARTS; part++) {
		double *setting = setting_of(&look->combined, part);
		*setting = within(*setting + read_part(change, part), 0, 1);
	}
}
