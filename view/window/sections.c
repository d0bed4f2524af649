/* The part that shows axial, coronal and sagittal slices beside the picture, with a crosshair, and
 * measures distances in them. */
#include "view/window/sections.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include <GLFW/glfw3.h>

#include "render/picture/camera.h"
#include "render/section/section.h"
#include "view/draw/icon.h"
#include "view/window/displays.h"
#include "view/window/window_state.h"

#define GZ_LOG_MODULE "window"

/* Unscaled: rim around a slice for its letters, and height of the caption at the top of the window
 * that the upper slices leave free. */
#define RIM     18.0
#define CAPTION 24.0
/* A right drag over this way changes the grey window by all values (chosen: half a small window).
 */
#define WINDOW_DRAG 400.0
/* A right button that moved the mouse no farther opens the menu (as in input.c), unscaled. */
#define CLICK_NEAR 4.0
/* Half the gap of the crosshair around its middle, unscaled: the voxel stays visible. */
#define CROSS_GAP 6.0

/* Length of the mark on the clip plane's line, unscaled (chosen: as the crosshair's gap is wide).
 */
#define CLIP_TICK 12.0

enum { TEXT_SIZE = 160 };

enum section_drag { DRAG_CROSSHAIR, DRAG_WINDOW, DRAG_DISTANCE };

/* What a slice's texture was made of. */
struct section_made {
	const void *voxels;
	int time_point, width, height;
	double depth, level, grey_width;
	bool colours;
};

struct gz_window_sections {
	unsigned icon[GZ_SECTION_COUNT];
	struct section_made made[GZ_SECTION_COUNT];
	struct gz_transfer transfer; /* with which they were made */
	struct gz_image image;
	float top;      /* lower edge of the menu bar */
	bool measuring; /* a drag measures */
	enum section_drag drag;
	enum gz_section_plane dragged;
	bool line_begun;    /* the last distance follows the mouse */
	bool resting;       /* the gaze rests, and has moved the crosshair */
	double followed[2]; /* the mouse when it moved the crosshair last */
};

static const struct gz_paint cross_paint = { 255, 214, 64, 200 };
static const struct gz_paint line_paint = { 90, 220, 255, 255 };
static const struct gz_paint clip_paint = { 96, 220, 255, 200 }; /* as of its handles */
static const struct gz_paint black = { 0, 0, 0, 255 };
static const struct gz_paint ground = { 16, 16, 18, 255 };

/* A slice in the window, screen coordinates. */
struct section_frame {
	double corner[2], size[2]; /* of the quarter */
	double at[2], extent[2];   /* of the slice */
};

static const char *const plane_names[GZ_SECTION_COUNT] = { "Axial", "Coronal", "Sagittal" };

static const struct gz_volume *volume_of(const struct gz_window *window)
{
	return &gz_frame_maker_scene(window->maker)->volume;
}

/* Behind lengths that nobody vouches for. */
static const char *assumed_text(const struct gz_volume *volume)
{
	return volume->spacing_assumed ? " (spacing assumed)" : "";
}

static bool can_have_sections(const struct gz_window *window)
{
	return window->maker && !window->alone &&
	       gz_scene_has_volume(&gz_frame_maker_scene(window->maker)->settings) &&
	       gz_section_possible(volume_of(window));
}

bool gz_window_has_sections(const struct gz_window *window)
{
	return window->settings.view.layout == GZ_LAYOUT_SLICES && can_have_sections(window);
}

struct gz_place gz_window_place_of(const struct gz_window *window, struct gz_point point)
{
	double place[4];
	gz_window_picture_place(window, place);
	return (struct gz_place) { (float)(place[0] + (double)point.x * place[2]),
				   (float)(place[1] + (double)point.y * place[3]) };
}

bool gz_window_sections_lie_at(const struct gz_window *window, struct gz_point point)
{
	return gz_window_has_sections(window) && (point.x > 1 || point.y < 0);
}

/* ---- places ---- */

static struct section_frame frame_of(const struct gz_window *window, enum gz_section_plane plane)
{
	double picture[4];
	struct section_frame frame;
	gz_window_picture_place(window, picture);
	const double unit = (double)gz_widgets_scale(), rim = RIM * unit;
	const double top = (double)window->sections->top + CAPTION * unit;
	const bool right = plane != GZ_SECTION_AXIAL, low = plane == GZ_SECTION_CORONAL;
	frame.corner[0] = right ? picture[2] : 0;
	frame.corner[1] = low ? picture[1] : 0;
	frame.size[0] = right ? (double)gz_widgets_room().x - picture[2] : picture[2];
	frame.size[1] = low ? picture[3] : picture[1];
	const double above = rim + (low ? 0 : top), below = low ? rim + CAPTION * unit : rim;
	const double room[2] = { fmax(1, frame.size[0] - 2 * rim),
				 fmax(1, frame.size[1] - above - below) };
	gz_section_fit(volume_of(window), plane, room, frame.extent);
	frame.at[0] = floor(frame.corner[0] + rim + (room[0] - frame.extent[0]) / 2);
	frame.at[1] = floor(frame.corner[1] + above + (room[1] - frame.extent[1]) / 2);
	return frame;
}

static bool is_in_frame(const struct section_frame *frame, const double at[2])
{
	return at[0] >= frame->corner[0] && at[0] < frame->corner[0] + frame->size[0] &&
	       at[1] >= frame->corner[1] && at[1] < frame->corner[1] + frame->size[1];
}

/* @return the slice at a place of the window; GZ_SECTION_COUNT: none */
static enum gz_section_plane plane_at(const struct gz_window *window, const double at[2])
{
	int plane = gz_window_has_sections(window) ? 0 : GZ_SECTION_COUNT;
	for (; plane < GZ_SECTION_COUNT; plane++) {
		const struct section_frame frame = frame_of(window, (enum gz_section_plane)plane);
		if (is_in_frame(&frame, at))
			break;
	}
	return (enum gz_section_plane)plane;
}

static struct gz_section_axes axes_of(const struct gz_window *window, enum gz_section_plane plane)
{
	return gz_section_axes_of(plane, volume_of(window)->oriented);
}

/* The place in the volume of a place of the window, on the plane through @p place. */
static void place_at(const struct gz_window *window, enum gz_section_plane plane,
		     const double at[2], double place[3])
{
	const struct section_frame frame = frame_of(window, plane);
	const double point[2] = { (at[0] - frame.at[0]) / frame.extent[0],
				  (at[1] - frame.at[1]) / frame.extent[1] };
	gz_section_place(axes_of(window, plane), point, place);
}

static struct gz_place window_place(const struct section_frame *frame, struct gz_section_axes axes,
				    const double place[3])
{
	double point[2];
	gz_section_point(axes, place, point);
	return (struct gz_place) { (float)(frame->at[0] + point[0] * frame->extent[0]),
				   (float)(frame->at[1] + point[1] * frame->extent[1]) };
}

static void move_crosshair(struct gz_window *window, enum gz_section_plane plane,
			   const double at[2])
{
	place_at(window, plane, at, window->settings.view.crosshair);
	gz_window_wake_panels(window);
}

/* ---- the grey window ---- */

/* Least and greatest value that is of interest: what the transfer function spans. */
static void value_range(const struct gz_window *window, double out_range[2])
{
	const struct gz_scene *scene = gz_frame_maker_scene(window->maker);
	const struct gz_volume *volume = &scene->volume;
	const double ends[2] = { volume->slope * volume->stored_min + volume->intercept,
				 volume->slope * volume->stored_max + volume->intercept };
	out_range[0] =
		scene->transfer.has_range ? scene->transfer.range[0] : fmin(ends[0], ends[1]);
	out_range[1] =
		scene->transfer.has_range ? scene->transfer.range[1] : fmax(ends[0], ends[1]);
	if (!(out_range[1] > out_range[0]))
		out_range[1] = out_range[0] + 1;
}

static void grey_window(const struct gz_window *window, double *out_level, double *out_width)
{
	const struct gz_view_settings *view = &window->settings.view;
	double range[2];
	value_range(window, range);
	*out_level = view->slice_width > 0 ? view->slice_level : (range[0] + range[1]) / 2;
	*out_width = view->slice_width > 0 ? view->slice_width : range[1] - range[0];
}

static double limited(double value, double least, double greatest)
{
	return fmin(greatest, fmax(least, value));
}

static void drag_grey_window(struct gz_window *window, double right, double down)
{
	double range[2], level, width;
	const double unit = (double)gz_widgets_scale();
	if (window->grab_moved <= CLICK_NEAR * unit)
		return;
	value_range(window, range);
	grey_window(window, &level, &width);
	const double per_px = (range[1] - range[0]) / (WINDOW_DRAG * unit);
	window->settings.view.slice_width =
		limited(width + right * per_px, (range[1] - range[0]) / 1000, GZ_SLICE_VALUE_MAX);
	window->settings.view.slice_level =
		limited(level - down * per_px, -GZ_SLICE_VALUE_MAX, GZ_SLICE_VALUE_MAX);
}

/* ---- distances ---- */

static struct gz_distances distances_of(const struct gz_window *window)
{
	struct gz_distances distances = { 0 };
	/* The settings have been checked. */
	(void)gz_distances_parse(window->settings.view.distances, &distances);
	return distances;
}

static void keep_distances(struct gz_window *window, const struct gz_distances *distances)
{
	gz_distances_print(distances, window->settings.view.distances);
	gz_window_wake_panels(window);
}

/* The line lies in the slice, through the crosshair. @return false: there are too many */
static bool begin_distance(struct gz_window *window, enum gz_section_plane plane)
{
	struct gz_distances distances = distances_of(window);
	if (distances.count == GZ_DISTANCES_MAX) {
		gz_info(window->log, "%d distances are the most; remove one by Shift+D",
			GZ_DISTANCES_MAX);
		return false;
	}
	struct gz_distance *line = &distances.lines[distances.count++];
	memcpy(line->ends[0], window->settings.view.crosshair, sizeof line->ends[0]);
	place_at(window, plane, window->cursor, line->ends[0]);
	memcpy(line->ends[1], line->ends[0], sizeof line->ends[1]);
	keep_distances(window, &distances);
	return true;
}

static void drag_distance(struct gz_window *window)
{
	struct gz_distances distances = distances_of(window);
	if (distances.count == 0)
		return;
	place_at(window, window->sections->dragged, window->cursor,
		 distances.lines[distances.count - 1].ends[1]);
	keep_distances(window, &distances);
}

/* A click without a drag measures nothing. */
static void end_distance(struct gz_window *window)
{
	struct gz_distances distances = distances_of(window);
	window->sections->line_begun = false;
	if (distances.count > 0 &&
	    gz_distance_length(volume_of(window), &distances.lines[distances.count - 1]) == 0) {
		distances.count--;
		keep_distances(window, &distances);
	}
}

/* ---- mouse and gaze ---- */

static bool grab_section(struct gz_window *window, int button, int modifiers)
{
	struct gz_window_sections *self = window->sections;
	const enum gz_section_plane plane = plane_at(window, window->cursor);
	if (plane == GZ_SECTION_COUNT)
		return false;
	const bool measures = self->measuring || modifiers == GZ_KEY_SHIFT;
	self->dragged = plane;
	self->drag = button != GLFW_MOUSE_BUTTON_LEFT ? DRAG_WINDOW : DRAG_CROSSHAIR;
	if (button == GLFW_MOUSE_BUTTON_LEFT && measures) {
		self->drag = DRAG_DISTANCE;
		self->line_begun = begin_distance(window, plane);
	} else if (button == GLFW_MOUSE_BUTTON_LEFT) {
		move_crosshair(window, plane, window->cursor);
	}
	return true;
}

static void drag_section(struct gz_window *window, double right, double down)
{
	const struct gz_window_sections *self = window->sections;
	if (!gz_window_has_sections(window))
		return;
	if (self->drag == DRAG_WINDOW)
		drag_grey_window(window, right, down);
	else if (self->drag == DRAG_CROSSHAIR)
		move_crosshair(window, self->dragged, window->cursor);
	else if (self->line_begun)
		drag_distance(window);
	gz_window_wake_panels(window);
}

/* The wheel goes through slices, voxel by voxel. */
static bool step_section(struct gz_window *window, double up)
{
	const enum gz_section_plane plane = plane_at(window, window->cursor);
	if (plane == GZ_SECTION_COUNT)
		return false;
	gz_section_step(volume_of(window), axes_of(window, plane).normal, up > 0 ? 1 : -1,
			window->settings.view.crosshair);
	gz_window_wake_panels(window);
	return true;
}

static void follow_mouse(struct gz_window *window)
{
	struct gz_window_sections *self = window->sections;
	if (memcmp(self->followed, window->cursor, sizeof self->followed) == 0 ||
	    !window->cursor_inside ||
	    gz_widgets_lie_at((float)window->cursor[0], (float)window->cursor[1]))
		return;
	memcpy(self->followed, window->cursor, sizeof self->followed);
	const enum gz_section_plane plane = plane_at(window, window->cursor);
	if (plane != GZ_SECTION_COUNT)
		move_crosshair(window, plane, window->cursor);
}

static void turn_sections(struct gz_window *window)
{
	const struct gz_window_sections *self = window->sections;
	if (!gz_window_has_sections(window) || window->grabber)
		return;
	if (self->line_begun)
		end_distance(window);
	if (window->settings.view.crosshair_follows == GZ_FOLLOWS_MOUSE)
		follow_mouse(window);
}

/* Once in each fixation, so that the slices rest while they are looked at. */
static void follow_gaze(struct gz_window *window, struct gz_window_gaze *gaze)
{
	struct gz_window_sections *self = window->sections;
	const struct gz_gaze_reading *reading = &gaze->reading;
	const bool rests =
		reading->known && reading->has_event && reading->event == GZ_EVENT_FIXATION;
	if (rests && !self->resting && !window->grabber && gz_window_has_sections(window) &&
	    window->settings.view.crosshair_follows == GZ_FOLLOWS_GAZE) {
		const struct gz_place place = gz_window_place_of(window, reading->point);
		const double at[2] = { (double)place.x, (double)place.y };
		const enum gz_section_plane plane = plane_at(window, at);
		if (plane != GZ_SECTION_COUNT)
			move_crosshair(window, plane, at);
	}
	self->resting = rests;
}

/* What is seen at a click on the picture. */
static void pick_in_picture(struct gz_window *window)
{
	const struct gz_scene *scene = gz_frame_maker_scene(window->maker);
	struct gz_ray_frame rays;
	struct gz_point point;
	int width, height;
	gz_window_picture_size(window, &width, &height);
	if (!gz_window_has_sections(window) || !gz_window_mouse_point(window, &point) ||
	    gz_camera_rays(&window->settings.camera, width, height, &rays) != GZ_OK)
		return;
	const double x = (double)point.x * width - 0.5, y = (double)point.y * height - 0.5;
	double origin[3], direction[3];
	for (int i = 0; i < 3; i++) {
		origin[i] = rays.origin00[i] + x * rays.origin_dx[i] + y * rays.origin_dy[i];
		direction[i] =
			rays.direction00[i] + x * rays.direction_dx[i] + y * rays.direction_dy[i];
	}
	if (gz_section_hit(&scene->volume, &scene->transfer, origin, direction,
			   window->settings.view.crosshair))
		gz_window_wake_panels(window);
}

/* ---- drawing ---- */

static void forget_pictures(struct gz_window *window)
{
	for (int i = 0; i < GZ_SECTION_COUNT; i++)
		gz_icon_free(&window->sections->icon[i]);
}

/* The slice as a texture, made anew if anything has changed. */
static unsigned picture_of(struct gz_window *window, enum gz_section_plane plane,
			   const struct section_frame *frame)
{
	struct gz_window_sections *self = window->sections;
	const struct gz_scene *scene = gz_frame_maker_scene(window->maker);
	struct gz_section_request request = { .volume = &scene->volume, .plane = plane };
	struct section_made want;
	int framebuffer[2];
	gz_window_framebuffer(window, &framebuffer[0], &framebuffer[1]);
	const double density = framebuffer[0] / fmax(1, (double)gz_widgets_room().x);
	memcpy(request.place, window->settings.view.crosshair, sizeof request.place);
	grey_window(window, &request.level, &request.width);
	if (window->settings.view.slice_colours)
		request.transfer = &scene->transfer;
	memset(&want, 0, sizeof want);
	want.voxels = scene->volume.voxels;
	want.time_point = scene->volume.time_point;
	want.width = (int)fmax(1, lround(frame->extent[0] * density));
	want.height = (int)fmax(1, lround(frame->extent[1] * density));
	want.depth = request.place[axes_of(window, plane).normal];
	want.level = request.level;
	want.grey_width = request.width;
	want.colours = window->settings.view.slice_colours;
	if (self->icon[plane] && memcmp(&want, &self->made[plane], sizeof want) == 0)
		return self->icon[plane];
	gz_icon_free(&self->icon[plane]);
	if (gz_section_draw(&request, want.width, want.height, &self->image) == GZ_OK)
		self->icon[plane] =
			gz_icon_make_colour(self->image.pixels, want.width, want.height);
	self->made[plane] = want;
	return self->icon[plane];
}

/* What lies at the left, right, top and bottom of a slice. */
static void letters_of(const struct gz_volume *volume, struct gz_section_axes axes,
		       const char *out_letters[4])
{
	static const char *const least[] = { "L", "P", "I" }, *const greatest[] = { "R", "A", "S" };
	static const char *const names[] = { "x", "y", "z" };
	const bool known = volume->oriented;
	out_letters[0] = known ? greatest[axes.across] : "";
	out_letters[1] = known ? least[axes.across] : names[axes.across];
	out_letters[2] = known ? greatest[axes.upward] : names[axes.upward];
	out_letters[3] = known ? least[axes.upward] : "";
}

static void draw_side_letters(const struct section_frame *frame, const char *const letters[4])
{
	const double unit = (double)gz_widgets_scale(), gap = 3 * unit;
	for (int i = 0; i < 4; i++) {
		const struct gz_place room = gz_text_room(1, letters[i]);
		const double width = (double)room.x, height = (double)room.y;
		const double middle[2] = { frame->at[0] + (frame->extent[0] - width) / 2,
					   frame->at[1] + (frame->extent[1] - height) / 2 };
		const double at[4][2] = {
			{ frame->at[0] - width - gap, middle[1] },
			{ frame->at[0] + frame->extent[0] + gap, middle[1] },
			{ middle[0], frame->at[1] - height },
			{ middle[0], frame->at[1] + frame->extent[1] },
		};
		gz_draw_text(GZ_LAYER_PICTURE,
			     (struct gz_place) { (float)at[i][0], (float)at[i][1] }, 1,
			     gz_paint_plain, letters[i]);
	}
}

/* Two lines across the slice, open around the middle. */
static void draw_crosshair(const struct section_frame *frame, struct gz_place middle)
{
	const float gap = (float)CROSS_GAP * gz_widgets_scale();
	middle = (struct gz_place) { floorf(middle.x), floorf(middle.y) };
	const float left = (float)frame->at[0], right = left + (float)frame->extent[0];
	const float top = (float)frame->at[1], bottom = top + (float)frame->extent[1];
	const struct gz_place ends[4][2] = {
		{ { left, middle.y }, { fmaxf(left, middle.x - gap), middle.y } },
		{ { fminf(right, middle.x + gap), middle.y }, { right, middle.y } },
		{ { middle.x, top }, { middle.x, fmaxf(top, middle.y - gap) } },
		{ { middle.x, fminf(bottom, middle.y + gap) }, { middle.x, bottom } },
	};
	for (int i = 0; i < 4; i++)
		gz_draw_line(GZ_LAYER_PICTURE, ends[i][0], ends[i][1], cross_paint, 1);
}

/* A short line from the middle of the clip plane's to the side that is cut off. */
static void draw_clip_side(const struct gz_window *window, enum gz_section_plane plane,
			   struct gz_place from, struct gz_place to)
{
	static const double one[3] = { 1, 1, 1 }, none[3] = { 0, 0, 0 };
	const double across[2] = { (double)(from.y - to.y), (double)(to.x - from.x) };
	const double length = hypot(across[0], across[1]);
	const double tick = CLIP_TICK * (double)gz_widgets_scale();
	const double middle[2] = { (double)(from.x + to.x) / 2, (double)(from.y + to.y) / 2 };
	struct gz_clip_bounds bounds;
	double place[3];
	if (length < tick)
		return;
	memcpy(place, window->settings.view.crosshair, sizeof place);
	double step[2] = { across[0] / length * tick, across[1] / length * tick };
	const double beside[2] = { middle[0] + step[0], middle[1] + step[1] };
	place_at(window, plane, beside, place);
	gz_clip_region_place(&window->settings.rays.clip, volume_of(window), one, none, &bounds);
	const double side = gz_clip_beyond(&bounds, place) < 0 ? -1 : 1;
	gz_draw_line(GZ_LAYER_PICTURE, (struct gz_place) { (float)middle[0], (float)middle[1] },
		     (struct gz_place) { (float)(middle[0] + side * step[0]),
					 (float)(middle[1] + side * step[1]) },
		     clip_paint, 1);
}

/* Where the clip plane crosses the slice. */
static void draw_clip_line(const struct gz_window *window, enum gz_section_plane plane,
			   const struct section_frame *frame)
{
	const struct gz_clip_region *clip = &window->settings.rays.clip;
	const struct gz_section_axes axes = axes_of(window, plane);
	double ends[2][3];
	if (!clip->plane ||
	    !gz_clip_plane_trace(clip, volume_of(window), axes.normal,
				 window->settings.view.crosshair[axes.normal], ends))
		return;
	const struct gz_place from = window_place(frame, axes, ends[0]);
	const struct gz_place to = window_place(frame, axes, ends[1]);
	/* Wider than the crosshair, which may lie on it. */
	gz_draw_line(GZ_LAYER_PICTURE, from, to, clip_paint, 2);
	draw_clip_side(window, plane, from, to);
}

/* Distances whose ends lie in the slice shown, to half a voxel. */
static void draw_distances(const struct gz_window *window, enum gz_section_plane plane,
			   const struct section_frame *frame)
{
	const struct gz_distances distances = distances_of(window);
	const struct gz_volume *volume = volume_of(window);
	const struct gz_section_axes axes = axes_of(window, plane);
	const double depth = window->settings.view.crosshair[axes.normal];
	const double near = 0.5 / volume->dims[axes.normal] + 1e-6;
	for (int i = 0; i < distances.count; i++) {
		const struct gz_distance *line = &distances.lines[i];
		char text[TEXT_SIZE];
		if (fabs(line->ends[0][axes.normal] - depth) > near ||
		    fabs(line->ends[1][axes.normal] - depth) > near)
			continue;
		const struct gz_place from = window_place(frame, axes, line->ends[0]);
		const struct gz_place to = window_place(frame, axes, line->ends[1]);
		gz_draw_line(GZ_LAYER_PICTURE, from, to, black, 3);
		gz_draw_line(GZ_LAYER_PICTURE, from, to, line_paint, 1.5F);
		gz_draw_disc(GZ_LAYER_PICTURE, from, 2.5F, line_paint);
		gz_draw_disc(GZ_LAYER_PICTURE, to, 2.5F, line_paint);
		snprintf(text, sizeof text, "%.1f mm%s", gz_distance_length(volume, line),
			 assumed_text(volume));
		const struct gz_place end = from.x > to.x ? from : to;
		const float gap = 6 * gz_widgets_scale();
		gz_draw_caption(GZ_LAYER_PICTURE, (struct gz_place) { end.x + gap, end.y - gap },
				line_paint, text);
	}
}

static void draw_section(struct gz_window *window, enum gz_section_plane plane)
{
	const struct gz_volume *volume = volume_of(window);
	const struct section_frame frame = frame_of(window, plane);
	const struct gz_section_axes axes = axes_of(window, plane);
	const float unit = gz_widgets_scale();
	const char *letters[4];
	char text[TEXT_SIZE];
	int voxel[3];
	const struct gz_place corner = { (float)frame.corner[0], (float)frame.corner[1] };
	const struct gz_place low = { corner.x + (float)frame.size[0],
				      corner.y + (float)frame.size[1] };
	const struct gz_place at = { (float)frame.at[0], (float)frame.at[1] };
	gz_draw_rectangle(GZ_LAYER_PICTURE, corner, low, ground, 0);
	const unsigned icon = picture_of(window, plane, &frame);
	if (icon)
		gz_draw_icon(GZ_LAYER_PICTURE, at,
			     (struct gz_place) { at.x + (float)frame.extent[0],
						 at.y + (float)frame.extent[1] },
			     icon);
	draw_clip_line(window, plane, &frame);
	draw_crosshair(&frame, window_place(&frame, axes, window->settings.view.crosshair));
	letters_of(volume, axes, letters);
	draw_side_letters(&frame, letters);
	draw_distances(window, plane, &frame);
	gz_section_voxel(volume, window->settings.view.crosshair, voxel);
	snprintf(text, sizeof text, "%s %d/%d", plane_names[plane], voxel[axes.normal] + 1,
		 volume->dims[axes.normal]);
	gz_draw_text(GZ_LAYER_PICTURE,
		     (struct gz_place) { corner.x + 6 * unit,
					 low.y -
						 (plane == GZ_SECTION_CORONAL ? 3 : 1) *
							 gz_widgets_line_height() -
						 4 * unit },
		     1, cross_paint, text);
}

/* What is at the crosshair: below the coronal slice, to the right. */
static void draw_readout(const struct gz_window *window)
{
	const struct gz_volume *volume = volume_of(window);
	const double *place = window->settings.view.crosshair;
	const struct gz_place room = gz_widgets_room();
	const float unit = gz_widgets_scale();
	double level, width, mm[3];
	char text[TEXT_SIZE];
	int voxel[3];
	gz_section_voxel(volume, place, voxel);
	grey_window(window, &level, &width);
	for (int i = 0; i < 3; i++)
		mm[i] = (place[i] * volume->dims[i] - 0.5) * volume->spacing[i];
	snprintf(text, sizeof text,
		 "value %.6g   voxel %d %d %d\n%.1f %.1f %.1f mm%s   level %.4g width %.4g%s",
		 gz_section_value(volume, place), voxel[0], voxel[1], voxel[2], mm[0], mm[1], mm[2],
		 assumed_text(volume), level, width,
		 window->sections->measuring ? "   measuring" : "");
	const struct gz_place size = gz_text_room(1, text);
	gz_draw_text(GZ_LAYER_PICTURE,
		     (struct gz_place) { room.x - size.x - 6 * unit, room.y - size.y - 4 * unit },
		     1, gz_paint_plain, text);
}

static void draw_sections(struct gz_window *window, const struct gz_window_gaze *gaze)
{
	struct gz_window_sections *self = window->sections;
	(void)gaze;
	self->top = window->panels_top;
	if (!gz_window_has_sections(window)) {
		forget_pictures(window);
		return;
	}
	const struct gz_transfer *transfer = &gz_frame_maker_scene(window->maker)->transfer;
	if (!gz_transfer_same(transfer, &self->transfer)) {
		self->transfer = *transfer;
		forget_pictures(window);
	}
	for (int plane = 0; plane < GZ_SECTION_COUNT; plane++)
		draw_section(window, (enum gz_section_plane)plane);
	draw_readout(window);
}

/* ---- actions ---- */

static void tell_why_not(struct gz_window *window)
{
	const bool bricks = window->maker && volume_of(window)->bricks;
	gz_info(window->log, bricks ? "no slices: this volume is read in bricks where it is seen, "
				      "and slices need all voxels in memory"
				    : "no slices: they need a scene with a volume");
}

static void toggle_sections(struct gz_window *window, int number)
{
	int *layout = &window->settings.view.layout;
	(void)number;
	if (*layout == GZ_LAYOUT_PICTURE && !can_have_sections(window)) {
		tell_why_not(window);
		return;
	}
	*layout = *layout == GZ_LAYOUT_SLICES ? GZ_LAYOUT_PICTURE : GZ_LAYOUT_SLICES;
	window->cast_needed = true;
}

static bool is_sliced(const struct gz_window *window, int number)
{
	(void)number;
	return gz_window_has_sections(window);
}

static void toggle_measuring(struct gz_window *window, int number)
{
	(void)number;
	window->sections->measuring = !window->sections->measuring;
	window->present_needed = true;
}

static bool is_measuring(const struct gz_window *window, int number)
{
	(void)number;
	return window->sections->measuring;
}

static bool has_distance(const struct gz_window *window)
{
	return gz_window_has_sections(window) && window->settings.view.distances[0] != '\0';
}

/* number: how many; 0: all */
static void remove_distances(struct gz_window *window, int number)
{
	struct gz_distances distances = distances_of(window);
	distances.count = number > 0 && distances.count > number ? distances.count - number : 0;
	keep_distances(window, &distances);
}

static void toggle_colours(struct gz_window *window, int number)
{
	(void)number;
	window->settings.view.slice_colours = !window->settings.view.slice_colours;
	window->present_needed = true;
}

static bool are_colours_on(const struct gz_window *window, int number)
{
	(void)number;
	return window->settings.view.slice_colours;
}

static void reset_grey_window(struct gz_window *window, int number)
{
	(void)number;
	window->settings.view.slice_width = window->settings.view.slice_level = 0;
	window->present_needed = true;
}

static void switch_following(struct gz_window *window, int number)
{
	int *follows = &window->settings.view.crosshair_follows;
	*follows = *follows == number ? GZ_FOLLOWS_NONE : number;
	window->present_needed = true;
}

static bool is_following(const struct gz_window *window, int number)
{
	return window->settings.view.crosshair_follows == number;
}

static const struct gz_window_action section_actions[] = {
	{ .letter = 's',
	  .modifiers = GZ_KEY_SHIFT,
	  .keys = "Shift+S",
	  .help = "axial, coronal and sagittal slice",
	  .name = "Slices",
	  .menu = GZ_MENU_VIEW,
	  .section = 1,
	  .on_picture = true,
	  .words = "slice slices mpr axial coronal sagittal orthogonal planes crosshair medical",
	  .is_on = is_sliced,
	  .run = toggle_sections },
	{ .letter = 'm',
	  .modifiers = GZ_KEY_SHIFT,
	  .keys = "Shift+M",
	  .help = "drags in slices measure; or Shift+drag",
	  .name = "Measure distances",
	  .menu = GZ_MENU_VIEW,
	  .section = 1,
	  .submenu = "In slices",
	  .words = "measure distance ruler length millimetres mm",
	  .is_on = is_measuring,
	  .applies = gz_window_has_sections,
	  .run = toggle_measuring },
	{ .letter = 'd',
	  .modifiers = GZ_KEY_SHIFT,
	  .number = 1,
	  .keys = "Shift+D",
	  .help = "remove the distance measured last",
	  .name = "Remove the last distance",
	  .menu = GZ_MENU_VIEW,
	  .section = 1,
	  .submenu = "In slices",
	  .words = "measure delete",
	  .applies = has_distance,
	  .run = remove_distances },
	{ .help = "remove all distances",
	  .name = "Remove all distances",
	  .menu = GZ_MENU_VIEW,
	  .section = 1,
	  .submenu = "In slices",
	  .words = "measure delete clear",
	  .applies = has_distance,
	  .run = remove_distances },
	{ .help = "transfer function's colours over grey",
	  .name = "Colours",
	  .menu = GZ_MENU_VIEW,
	  .section = 1,
	  .submenu = "In slices",
	  .words = "slices colour transfer",
	  .is_on = are_colours_on,
	  .applies = gz_window_has_sections,
	  .run = toggle_colours },
	{ .help = "grey level and width from the volume",
	  .name = "Reset level and width",
	  .menu = GZ_MENU_VIEW,
	  .section = 1,
	  .submenu = "In slices",
	  .words = "window level brightness contrast",
	  .applies = gz_window_has_sections,
	  .run = reset_grey_window },
	{ .number = GZ_FOLLOWS_MOUSE,
	  .help = "crosshair follows the mouse over slices",
	  .name = "Crosshair follows mouse",
	  .menu = GZ_MENU_VIEW,
	  .section = 1,
	  .submenu = "In slices",
	  .is_on = is_following,
	  .applies = gz_window_has_sections,
	  .run = switch_following },
	{ .number = GZ_FOLLOWS_GAZE,
	  .help = "crosshair goes where the gaze rests",
	  .name = "Crosshair follows gaze",
	  .menu = GZ_MENU_VIEW,
	  .section = 1,
	  .submenu = "In slices",
	  .is_on = is_following,
	  .applies = gz_window_has_sections,
	  .run = switch_following },
};

static void show_first_slices(struct gz_window *window)
{
	forget_pictures(window);
	if (window->settings.view.layout == GZ_LAYOUT_SLICES && !window->alone &&
	    !can_have_sections(window))
		tell_why_not(window);
}

static void close_sections(struct gz_window *window)
{
	gz_image_free(&window->sections->image);
}

const struct gz_window_part gz_window_sections_part = {
	.name = "slices",
	.title = "picture",
	GZ_PART_ACTIONS(section_actions),
	GZ_PART_STATE(sections),
	.scene_shown = show_first_slices,
	.scene_leaving = forget_pictures,
	.turn = turn_sections,
	.gaze = follow_gaze,
	.grab = grab_section,
	.drag = drag_section,
	.click = pick_in_picture,
	.wheel = step_section,
	.panels = draw_sections,
	.gl_close = forget_pictures,
	.close = close_sections,
};
