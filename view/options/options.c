#include "view/options/options.h"

#include <limits.h>
#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/file.h"
#include "render/data/time_steps.h"
#include "render/data/voxel_colour.h"
#include "render/picture/image.h"
#include "render/plan/method.h"
#include "render/scene/techniques.h"
#include "render/transfer/transfer_presets.h"

#define GZ_LOG_MODULE "gazeview"

#define AT(field) offsetof(struct gz_view_options, field)

static const char *const bricks_names[] = { "auto", "wait", "stream", NULL };
static const char *const endian_names[] = { "little", "big", NULL };

const struct gz_option gz_view_option_table[] = {
	{ "scene", GZ_OPTION_STRING, AT(scene), .max = GZ_PATH_SIZE,
	  .help = "what to show: a scene, a volume, a file of particles, or a picture saved by "
		  "gazeview; --scene may be left out" },
	{ "headless", GZ_OPTION_BOOL, AT(headless), .preset = "false",
	  .help = "render without a window" },
	{ "size", GZ_OPTION_SIZE, AT(size_px), 1, GZ_IMAGE_SIDE_MAX, .preset = "1280x720",
	  .help = "size of the picture, px" },
	{ "gaze", GZ_OPTION_STRING, AT(gaze_text), .max = GZ_PATH_SIZE,
	  .help = "gaze source: X,Y (0,0 top left to 1,1), centre, daemon, mouse, pointer (the "
		  "mouse through gazed --driver pointer), the endpoint of a latest channel, or "
		  "FILE.gzl; default: daemon, or centre if headless" },
	{ "fps", GZ_OPTION_DOUBLE, AT(fps), 0.01, 10000, .preset = "60",
	  .help = "frames per second of gaze time" },
	{ "method", GZ_OPTION_CHOICE, AT(method), .choices = gz_method_names,
	  .help = "foveation method; default: the scene's" },
	{ "technique", GZ_OPTION_CHOICE, AT(technique), .choices = gz_technique_choices,
	  .help = "short for --render.technique: how everything is drawn" },
	{ "backend", GZ_OPTION_STRING, AT(backend), .max = GZ_NAME_SIZE, .preset = "auto",
	  .help = "what draws: cpu, gl (OpenGL 4.3), or auto (gl if a GPU provides it; surfaces "
		  "and illustrations: cpu)" },
	{ "threads", GZ_OPTION_INT, AT(threads), 0, 256, .preset = "0",
	  .help = "threads of the cpu backend; 0: one per processor" },
	{ "simd", GZ_OPTION_STRING, AT(simd), .max = GZ_NAME_SIZE, .preset = "auto",
	  .help = "instruction set of the cpu backend: auto, portable, avx2, avx512" },
	{ "gl-memory", GZ_OPTION_INT, AT(gl_memory_mib), 0, 1 << 24, .preset = "0",
	  .help = "graphics memory that the gl backend uses for voxels, or for triangles, MiB; "
		  "0: all that is free; a volume that does not fit is shown in bricks" },
	{ "frames", GZ_OPTION_INT, AT(frames), 1, 100000000, .preset = "1",
	  .help = "number of pictures to render headless" },
	{ "out", GZ_OPTION_STRING, AT(out), .max = GZ_PATH_SIZE,
	  .help = "PNG file to write, headless; several frames need a pattern such as "
		  "frame-%04d.png" },
	{ "print", GZ_OPTION_STRING, AT(print), .max = GZ_PATH_SIZE,
	  .help = "file for print to write, headless, of the last picture's stipples or hatches, "
		  "with every pixel cast: .svg, or .png of up to 131072 px a side" },
	{ "print-mm", GZ_OPTION_DOUBLE, AT(print_mm), 1, 10000, .preset = "160",
	  .help = "width of --print on paper, mm" },
	{ "print-dpi", GZ_OPTION_DOUBLE, AT(print_dpi), 1, 20000, .preset = "600",
	  .help = "resolution of --print FILE.png, pixels per inch" },
	{ "video", GZ_OPTION_STRING, AT(video), .max = GZ_PATH_SIZE,
	  .help = "video file to write with ffmpeg, headless, at --fps: .mp4 or another ending "
		  "that ffmpeg knows" },
	{ "pictures", GZ_OPTION_STRING, AT(pictures), .max = GZ_PATH_SIZE, .preset = ".",
	  .help = "folder for the sessions, videos and screenshots written by F9, F10 and F12" },
	{ "record", GZ_OPTION_STRING, AT(record), .max = GZ_PATH_SIZE,
	  .help = "folder NAME.session to create: a recording of all inputs of each picture, for "
		  "--replay" },
	{ "replay", GZ_OPTION_STRING, AT(replay), .max = GZ_PATH_SIZE,
	  .help = "NAME.session to show again picture by picture, instead of a scene and a gaze" },
	{ "measure-window", GZ_OPTION_INT, AT(measure_window), 0, 100000, .preset = "0",
	  .help = "show this many frames each of a bare picture, the window, and the window with "
		  "panels; print the times and exit" },
	{ "stats", GZ_OPTION_STRING, AT(stats), .max = GZ_PATH_SIZE,
	  .help = "JSON file for the cost of each frame, headless" },
	{ "write-volume", GZ_OPTION_STRING, AT(write_volume), .max = GZ_PATH_SIZE,
	  .help = "write the scene's volume to this file and exit: .gzb (bricks, for volumes "
		  "larger than memory) or .nrrd" },
	{ "write-mesh", GZ_OPTION_STRING, AT(write_mesh), .max = GZ_PATH_SIZE,
	  .help = "write the scene's labels, or its volume's surface at --isovalue, to this file, "
		  "in mm, and exit: .ply, .obj or .stl" },
	{ "isovalue", GZ_OPTION_DOUBLE, AT(isovalue), -1e30, 1e30,
	  .help = "data value of the surface that --write-mesh writes or --technique isosurface "
		  "shows; short for --isosurface.isovalue" },
	{ "bricks", GZ_OPTION_CHOICE, AT(bricks), .choices = bricks_names, .preset = "auto",
	  .help = "pictures of a volume in bricks: wait for all visible bricks, or stream: coarse "
		  "first, sharper later; auto: wait if headless" },
	{ "time-point", GZ_OPTION_INT, AT(time_point), 1, GZ_TIME_POINTS_MAX,
	  .help = "which time point of a volume to show, from 1; default: the scene's" },
	{ "play", GZ_OPTION_DOUBLE, AT(play), 0, GZ_PLAYBACK_RATE_MAX, .preset = "0",
	  .help = "play the time points of a volume in turn, this many per second; without a "
		  "window, the picture at time t shows time point t x N" },
	{ "turn", GZ_OPTION_DOUBLE, AT(turn_deg), -360, 360, .preset = "0",
	  .help = "turn the camera by this angle each frame, degrees" },
	{ "cross", GZ_OPTION_BOOL, AT(cross), .preset = "false",
	  .help = "a cross at the gaze, as --view.gaze_cursor; saved scenes do not get it" },
	{ "letters", GZ_OPTION_BOOL, AT(letters), .preset = "false",
	  .help = "letters of sides, as --view.letters; saved scenes do not get them" },
	{ "fullscreen", GZ_OPTION_BOOL, AT(fullscreen), .preset = "false",
	  .help = "start with a full-screen window" },
	{ "menu", GZ_OPTION_BOOL, AT(menu), .preset = "true",
	  .help = "start with a menu bar; U shows and hides it" },
	{ "vsync", GZ_OPTION_BOOL, AT(vsync), .preset = "true",
	  .help = "as --view.vsync; saved scenes do not get it" },
	{ "interface-scale", GZ_OPTION_DOUBLE, AT(interface_scale), 0, 8, .preset = "0",
	  .help = "size of text and panels; 1 is small; 0: from the display" },
	{ "gaze-fills-window", GZ_OPTION_BOOL, AT(gaze_fills_window), .preset = "false",
	  .help = "map the daemon's gaze to the window instead of the monitor" },
	{ "tracker-display", GZ_OPTION_STRING, AT(tracker_display), .max = GZ_NAME_SIZE,
	  .help = "the tracker's monitor, by its name or its number from 1, as "
		  "--view.tracker_display; saved scenes do not get it" },
	{ "display-px", GZ_OPTION_SIZE, AT(display_px), 1, 32768,
	  .help = "size of the display, px; headless, the picture fills it" },
	{ "display-mm", GZ_OPTION_DOUBLE, AT(display_mm), 1, 100000, .count = 2,
	  .help = "width and height of the display, mm, such as \"565 318\"" },
	{ "distance-mm", GZ_OPTION_DOUBLE, AT(display_distance_mm), 1, 100000,
	  .help = "distance from the eye to the display, mm" },
	{ "volume.dims", GZ_OPTION_INT, AT(volume_dims), 1, GZ_VOLUME_DIM_MAX, .count = 3,
	  .help = "voxels along x, y, z of a raw file shown without a scene, such as \"256 256 "
		  "128\"; default: from its name and size" },
	{ "volume.type", GZ_OPTION_CHOICE, AT(volume_type), .choices = gz_raw_type_names,
	  .help = "type of the raw file's voxels" },
	{ "volume.endian", GZ_OPTION_CHOICE, AT(volume_endian), .choices = endian_names,
	  .help = "byte order of the raw file's voxels; default: little" },
	{ "volume.spacing", GZ_OPTION_DOUBLE, AT(volume_spacing), 1e-9, 1e9, .count = 3,
	  .help = "voxel spacing along x, y, z, mm; default: not known, 1 is assumed" },
	{ "volume.channels", GZ_OPTION_INT, AT(volume_channels), 1, 4,
	  .help = "numbers of a voxel of the raw file: 1, or 3 or 4 for a colour; default: 1" },
	{ "volume.opacity", GZ_OPTION_CHOICE, AT(volume_opacity),
	  .choices = gz_opacity_source_names,
	  .help = "what gives a coloured voxel its opacity, by the transfer function; replaces the "
		  "scene's" },
	{ "volume.series", GZ_OPTION_STRING, AT(volume_series), .max = GZ_SERIES_SIZE,
	  .help = "UID of the series of a DICOM folder to show; --list-series prints them" },
	{ "list-objects", GZ_OPTION_BOOL, AT(list_objects), .preset = "false",
	  .help = "print what the scene shows, each label of a label volume by its name, and "
		  "exit" },
	{ "list-series", GZ_OPTION_BOOL, AT(list_series), .preset = "false",
	  .help = "print the series of a DICOM folder or DICOMDIR with their UIDs, and exit" },
	{ "volume.resample", GZ_OPTION_CHOICE, AT(volume_resample), .choices = gz_resampling_names,
	  .help = "DICOM slices that are missing, lie unevenly or are shifted by a tilted gantry: "
		  "off refuses gaps and shows a tilt with a warning, linear interpolates, nearest "
		  "takes the nearest" },
	{ "resample", GZ_OPTION_BOOL, AT(resample), .preset = "false",
	  .help = "short for --volume.resample linear" },
	{ "transfer.file", GZ_OPTION_STRING, AT(transfer_file), .max = GZ_PATH_SIZE,
	  .help = "transfer function (.tf) to use instead of the scene's" },
	{ "transfer.preset", GZ_OPTION_CHOICE, AT(transfer_preset),
	  .choices = gz_transfer_preset_choices,
	  .help = "transfer function to make for a volume without one; auto: ct_tissue for "
		  "Hounsfield units, else tissue" },
	{ "formats", GZ_OPTION_BOOL, AT(formats), .preset = "false",
	  .help = "print the formats of volumes and particles that are read, and exit" },
	{ "help", GZ_OPTION_BOOL, AT(help), .preset = "false", .help = "print this and exit" },
	{ "version", GZ_OPTION_BOOL, AT(version), .preset = "false",
	  .help = "print the version and exit" },
};

const size_t gz_view_option_count = sizeof gz_view_option_table / sizeof gz_view_option_table[0];

bool gz_view_option_given(const struct gz_view_options *options, const char *key)
{
	for (size_t i = 0; i < gz_view_option_count; i++)
		if (strcmp(gz_view_option_table[i].key, key) == 0)
			return options->given[i];
	return false;
}

/* Nothing else is shown together with targets. */
static enum gz_result check_targets(const struct gz_view_options *options, const struct gz_log *log)
{
	const char *other = options->scene[0]        ? "a scene"
			    : options->headless      ? "--headless"
			    : options->record[0]     ? "--record"
			    : options->replay[0]     ? "--replay"
			    : options->list_objects  ? "--list-objects"
			    : options->list_series   ? "--list-series"
			    : options->write_mesh[0] ? "--write-mesh"
						     : NULL;
	if (!other)
		return GZ_OK;
	gz_err(log, "--targets: %s cannot be combined with it; remove one of them", other);
	return GZ_ERR_INVAL;
}

/* The session holds what these options set. */
static enum gz_result check_replay(const struct gz_view_options *options, const struct gz_log *log)
{
	static const char *const others[] = {
		"scene",           "size",           "gaze",
		"frames",          "turn",           "display-px",
		"display-mm",      "distance-mm",    "write-volume",
		"record",          "transfer.file",  "volume.dims",
		"volume.type",     "volume.endian",  "volume.spacing",
		"volume.series",   "time-point",     "play",
		"volume.channels", "volume.opacity", "list-objects",
		"list-series",     "resample",       "volume.resample",
		"write-mesh",      "isovalue",       "technique",
		"transfer.preset",
	};
	const char *other = options->scene[0] ? "scene" : NULL;
	for (size_t k = 0; k < sizeof others / sizeof others[0] && !other; k++)
		if (gz_view_option_given(options, others[k]))
			other = others[k];
	if (!other)
		return GZ_OK;
	gz_err(log,
	       "--replay: --%s cannot be combined with it, as the session sets it; remove one of "
	       "them",
	       other);
	return GZ_ERR_INVAL;
}

/* Whether a mesh that is written needs an isovalue depends on the scene: gz_view_write_mesh(). */
static enum gz_result check_mesh(const struct gz_view_options *options, const struct gz_log *log)
{
	if (!options->write_mesh[0] || !options->write_volume[0])
		return GZ_OK;
	gz_err(log, "--write-mesh: --write-volume cannot be combined with it; remove one of them");
	return GZ_ERR_INVAL;
}

/* A layout needs dims and type; the rest has presets. */
static enum gz_result check_raw(const struct gz_view_options *options, const struct gz_log *log)
{
	const bool dims = options->volume_dims[0] > 0, type = options->volume_type >= 0;
	const bool more = options->volume_endian >= 0 || options->volume_spacing[0] > 0 ||
			  options->volume_channels > 0;
	if (dims == type && (dims || !more))
		return GZ_OK;
	gz_err(log, "--volume.%s: missing; a raw file needs both dims and type",
	       dims ? "type" : "dims");
	return GZ_ERR_INVAL;
}

/* Whether a scene key was given, other than those that concern the display. */
static bool any_scene_key(const struct gz_view_options *options)
{
	struct gz_scene_settings settings;
	struct gz_view_scene_tables tables;
	bool any = false;
	for (size_t i = 0; i < GZ_PARTICLE_GRID_OPTIONS; i++)
		any = any || options->particles_given[i];
	const bool *given = options->scene_given;
	gz_view_pick_scene_tables(&settings, &tables);
	for (size_t i = 0; i < GZ_VIEW_SCENE_TABLES; i++) {
		for (size_t k = 0; k < tables.bindings[i].count; k++) {
			const char *key = tables.bindings[i].options[k].key;
			const bool display = strcmp(key, "view.vsync") == 0 ||
					     strcmp(key, "view.tracker_display") == 0;
			any = (*given++ && !display) || any;
		}
	}
	return any;
}

/* The experiment alone determines what is shown. */
static enum gz_result check_experiment(const struct gz_view_options *options,
				       const struct gz_log *log)
{
	const char *other = options->target.targets[0]                  ? "--targets"
			    : options->scene[0]                         ? "a scene"
			    : options->method >= 0                      ? "--method"
			    : options->technique >= 0                   ? "--technique"
			    : options->turn_deg != 0                    ? "--turn"
			    : options->time_point > 0                   ? "--time-point"
			    : options->play > 0                         ? "--play"
			    : options->resample                         ? "--resample"
			    : options->volume_resample >= 0             ? "--volume.resample"
			    : options->write_volume[0]                  ? "--write-volume"
			    : options->write_mesh[0]                    ? "--write-mesh"
			    : gz_view_option_given(options, "isovalue") ? "--isovalue"
			    : options->list_objects                     ? "--list-objects"
			    : options->list_series                      ? "--list-series"
			    : options->out[0]                           ? "--out"
			    : options->video[0]                         ? "--video"
			    : options->transfer_file[0]                 ? "--transfer.file"
			    : options->transfer_preset >= 0             ? "--transfer.preset"
			    : options->record[0]                        ? "--record"
			    : options->replay[0]                        ? "--replay"
			    : options->stats[0]                         ? "--stats"
			    : options->cross                            ? "--cross"
			    : options->letters                          ? "--letters"
			    : any_scene_key(options)                    ? "a key of a scene"
									: NULL;
	if (!other && options->headless && !options->sitting.participant[0]) {
		gz_err(log, "--participant: missing; give letters and digits, as in "
			    "--participant 07");
		return GZ_ERR_INVAL;
	}
	if (!other)
		return gz_sitting_options_check(&options->sitting, log);
	gz_err(log,
	       "--experiment: %s cannot be combined with it, as the file sets what is shown; "
	       "remove one of them",
	       other);
	return GZ_ERR_INVAL;
}

/* A picture is a PNG, whatever its name. A name that promises another format is refused. */
static enum gz_result check_picture_ending(const char *path, const struct gz_log *log)
{
	static const char *const others[] = { ".jpg", ".jpeg", ".tif", ".tiff", ".bmp",
					      ".gif", ".webp", ".ppm", ".exr",  ".pdf" };
	for (size_t i = 0; i < sizeof others / sizeof others[0]; i++)
		if (gz_path_ends(path, others[i])) {
			gz_err(log, "--out %s: pictures are written as PNG; end the name in .png",
			       path);
			return GZ_ERR_INVAL;
		}
	return GZ_OK;
}

static enum gz_result check_options(const struct gz_view_options *options, const struct gz_log *log)
{
	if (options->sitting.file[0])
		return check_experiment(options, log);
	const enum gz_result r = gz_sitting_options_check(&options->sitting, log);
	if (r != GZ_OK)
		return r;
	if (options->target.targets[0])
		return check_targets(options, log);
	if (options->replay[0] && check_replay(options, log) != GZ_OK)
		return GZ_ERR_INVAL;
	if (!options->scene[0] && !options->replay[0] &&
	    (options->headless || options->write_volume[0] || options->write_mesh[0] ||
	     options->list_objects || options->list_series)) {
		gz_err(log, "no scene; name one, as in: gazeview --scene head.scene (see --help)");
		return GZ_ERR_INVAL;
	}
	bool by_mouse =
		options->gaze.kind == GZ_GAZE_MOUSE || options->gaze.kind == GZ_GAZE_POINTER;
	if (options->headless && by_mouse) {
		gz_err(log, "--gaze %s: needs a window; remove --headless or give X,Y",
		       options->gaze_text);
		return GZ_ERR_INVAL;
	}
	if (check_raw(options, log) != GZ_OK || check_mesh(options, log) != GZ_OK)
		return GZ_ERR_INVAL;
	if (options->play > 0 && options->record[0]) {
		gz_err(log, "--record: a session has one time point; remove --play");
		return GZ_ERR_INVAL;
	}
	if (options->play > 0 && options->play < GZ_PLAYBACK_RATE_MIN) {
		gz_err(log, "--play %g: the slowest rate is %g steps per second; 0 stands still",
		       options->play, GZ_PLAYBACK_RATE_MIN);
		return GZ_ERR_INVAL;
	}
	const char *file = options->out[0]     ? "out"
			   : options->video[0] ? "video"
			   : options->stats[0] ? "stats"
					       : NULL;
	if (!options->headless && file) {
		gz_err(log, "--%s: is written headless only; add --headless", file);
		return GZ_ERR_INVAL;
	}
	if (check_picture_ending(options->out, log) != GZ_OK)
		return GZ_ERR_INVAL;
	/* A session usually has several frames. */
	const int frames = options->replay[0] ? INT_MAX : options->frames;
	return options->out[0] ? gz_pattern_check(options->out, frames, log) : GZ_OK;
}

/* A parsed pattern. */
struct pattern {
	size_t start, end; /* of the conversion; equal: none */
	bool zeros;
	int width;
	int conversions;
};

static bool scan_pattern(const char *text, struct pattern *out_pattern)
{
	struct pattern pattern = { 0 };
	for (size_t i = 0; text[i]; i++) {
		if (text[i] != '%')
			continue;
		if (text[i + 1] == '%') {
			i++;
			continue;
		}
		size_t at = i + 1;
		pattern.start = i;
		pattern.zeros = text[at] == '0';
		at += pattern.zeros;
		pattern.width = 0;
		if (text[at] >= '1' && text[at] <= '9')
			pattern.width = text[at++] - '0';
		if (text[at] != 'd')
			return false;
		pattern.end = at + 1;
		pattern.conversions++;
		i = at;
	}
	*out_pattern = pattern;
	return true;
}

enum gz_result gz_pattern_check(const char *pattern, int frames, const struct gz_log *log)
{
	struct pattern scanned;
	if (!scan_pattern(pattern, &scanned)) {
		gz_err(log,
		       "--out %s: only %%d, %%4d or %%04d (width 1 to 9) may follow a percent "
		       "sign; write %%%% for the sign itself",
		       pattern);
		return GZ_ERR_INVAL;
	}
	if (scanned.conversions > 1) {
		gz_err(log, "--out %s: has %d frame numbers; keep one", pattern,
		       scanned.conversions);
		return GZ_ERR_INVAL;
	}
	if (frames > 1 && scanned.conversions == 0) {
		gz_err(log,
		       "--out %s: several frames need a number in the name, as in frame-%%04d.png",
		       pattern);
		return GZ_ERR_INVAL;
	}
	return GZ_OK;
}

enum gz_result gz_pattern_format(const char *pattern, int number, char *path, size_t size)
{
	struct pattern scanned;
	if (!scan_pattern(pattern, &scanned) || scanned.conversions > 1)
		return GZ_ERR_INVAL;
	size_t used = 0;
	for (size_t i = 0; pattern[i]; i++) {
		if (used + 1 >= size)
			return GZ_ERR_FULL;
		if (scanned.conversions == 1 && i == scanned.start) {
			int length =
				snprintf(path + used, size - used, scanned.zeros ? "%0*d" : "%*d",
					 scanned.width, number);
			if (length < 0 || (size_t)length >= size - used)
				return GZ_ERR_FULL;
			used += (size_t)length;
			i = scanned.end - 1;
			continue;
		}
		i += pattern[i] == '%'; /* "%%" */
		path[used++] = pattern[i];
	}
	path[used] = '\0';
	return GZ_OK;
}

/* Tables of the command line itself: its own, that of the targets and that of experiments. */
enum { OWN_BINDINGS = 4 };

static bool starts_with(const char *text, const char *start)
{
	return strncmp(text, start, strlen(start)) == 0;
}

static bool is_gaze_log(const char *text)
{
	const char *ending = strrchr(text, '.');
	return ending && strcmp(ending, ".gzl") == 0;
}

/* One finite number up to @p end; strtof() alone would also accept blanks, hex and "inf". */
static bool parse_number(const char *text, char end, float *out_value, const char **out_rest)
{
	size_t length = strspn(text, "+-.0123456789eE");
	if (length == 0 || text[length] != end)
		return false;
	char *stop;
	float value = strtof(text, &stop);
	if (stop != text + length || !isfinite(value))
		return false;
	*out_value = value;
	*out_rest = stop + (end != '\0');
	return true;
}

static bool parse_point(const char *text, struct gz_point *out_point)
{
	struct gz_point point;
	const char *rest;
	if (!parse_number(text, ',', &point.x, &rest) || !parse_number(rest, '\0', &point.y, &rest))
		return false;
	*out_point = point;
	return true;
}

/* Whoever gives a place farther away means pixels. Chosen: ten pictures to each side. */
static bool is_near_picture(struct gz_point point)
{
	return fabsf(point.x) <= 10 && fabsf(point.y) <= 10;
}

enum gz_result gz_gaze_choice_parse(const char *text, const struct gz_log *log,
				    struct gz_gaze_choice *out_choice)
{
	struct gz_gaze_choice choice = { .kind = GZ_GAZE_CENTRE };
	if (strlen(text) >= sizeof choice.text) {
		gz_err(log, "--gaze: too long; at most %zu bytes are allowed",
		       sizeof choice.text - 1);
		return GZ_ERR_INVAL;
	}
	if (strcmp(text, "mouse") == 0) {
		choice.kind = GZ_GAZE_MOUSE;
	} else if (strcmp(text, "pointer") == 0) {
		choice.kind = GZ_GAZE_POINTER;
	} else if (strcmp(text, "daemon") == 0) {
		choice.kind = GZ_GAZE_LATEST;
	} else if (starts_with(text, "ipc://") || starts_with(text, "tcp://")) {
		choice.kind = GZ_GAZE_LATEST;
		memcpy(choice.text, text, strlen(text) + 1);
	} else if (is_gaze_log(text)) {
		choice.kind = GZ_GAZE_LOG;
		memcpy(choice.text, text, strlen(text) + 1);
	} else if (parse_point(text, &choice.point)) {
		choice.kind = GZ_GAZE_FIXED;
		if (!is_near_picture(choice.point)) {
			gz_err(log,
			       "--gaze %s: far outside the picture; give shares of its width and "
			       "height instead of pixels, as in 0.5,0.5 for its middle",
			       text);
			return GZ_ERR_INVAL;
		}
	} else if (strcmp(text, "centre") != 0) {
		gz_err(log,
		       "--gaze %s: not a gaze source; give two finite numbers such as 0.5,0.5, or "
		       "centre, daemon, mouse, pointer, ipc://..., tcp://... or FILE.gzl",
		       text);
		return GZ_ERR_INVAL;
	}
	*out_choice = choice;
	return GZ_OK;
}

struct gz_display gz_view_display(const struct gz_view_options *options,
				  const struct gz_display *known, int width, int height)
{
	struct gz_display display = known ? *known : gz_display_default(width, height);
	if (options->display_px[0] > 0)
		memcpy(display.px, options->display_px, sizeof display.px);
	if (options->display_mm[0] > 0)
		memcpy(display.mm, options->display_mm, sizeof display.mm);
	if (options->display_distance_mm > 0)
		display.distance_mm = options->display_distance_mm;
	return display;
}

/* Scene files have "levels = yes", so users try "--render.levels yes". */
static bool is_switch_value(const char *argument)
{
	static const char *const values[] = { "yes", "no", "true", "false", "on", "off" };
	for (size_t i = 0; i < sizeof values / sizeof values[0]; i++)
		if (strcmp(argument, values[i]) == 0)
			return true;
	return false;
}

static enum gz_result take_positional(struct gz_view_options *options, const char *const *arguments,
				      int count, const struct gz_log *log)
{
	if (count == 0)
		return GZ_OK;
	if ((count > 1 || options->scene[0]) && is_switch_value(arguments[count - 1])) {
		gz_err(log, "%s: a switch takes its value after =, as in --render.levels=%s",
		       arguments[count - 1], arguments[count - 1]);
		return GZ_ERR_INVAL;
	}
	if (count > 1 || options->scene[0]) {
		gz_err(log, "%s: a second scene; remove one of them", arguments[count - 1]);
		return GZ_ERR_INVAL;
	}
	if (strlen(arguments[0]) >= sizeof options->scene) {
		gz_err(log, "scene: the path is longer than %zu bytes; move the file",
		       sizeof options->scene - 1);
		return GZ_ERR_INVAL;
	}
	memcpy(options->scene, arguments[0], strlen(arguments[0]) + 1);
	return GZ_OK;
}

/* Whether a key of the scene's tables is given. */
static bool scene_key_given(const struct gz_view_options *options,
			    const struct gz_view_scene_tables *tables, const char *key)
{
	const bool *given = options->scene_given;
	for (size_t i = 0; i < GZ_VIEW_SCENE_TABLES; i++)
		for (size_t k = 0; k < tables->bindings[i].count; k++)
			if (*given++ && strcmp(tables->bindings[i].options[k].key, key) == 0)
				return true;
	return false;
}

/* Options that are short for a scene's keys; both at once contradict each other. */
static enum gz_result check_given_once(const struct gz_view_options *options,
				       const struct gz_view_scene_tables *tables,
				       const struct gz_log *log)
{
	static const char *const pairs[][2] = {
		{ "method", "foveation.method" },
		{ "technique", "render.technique" },
		{ "isovalue", "isosurface.isovalue" },
	};
	for (size_t i = 0; i < sizeof pairs / sizeof pairs[0]; i++)
		if (gz_view_option_given(options, pairs[i][0]) &&
		    scene_key_given(options, tables, pairs[i][1])) {
			gz_err(log, "--%s: --%s sets the same; give one of them", pairs[i][0],
			       pairs[i][1]);
			return GZ_ERR_INVAL;
		}
	return GZ_OK;
}

/* Short names of keys in section view. */
static void apply_short_names(const struct gz_view_options *options, struct gz_view_settings *view)
{
	view->gaze_cursor = view->gaze_cursor || options->cross;
	view->letters = view->letters || options->letters;
	view->vsync = view->vsync && options->vsync;
	if (options->gaze_text[0])
		memcpy(view->gaze, options->gaze_text, sizeof view->gaze);
	if (options->tracker_display[0])
		memcpy(view->tracker_display, options->tracker_display,
		       sizeof view->tracker_display);
}

unsigned gz_view_options_run(const struct gz_view_options *options,
			     const struct gz_view_settings *view)
{
	unsigned which = 0;
	if (options->gaze_text[0] && strcmp(view->gaze, options->gaze_text) == 0)
		which |= GZ_VIEW_RUN_GAZE;
	if (options->tracker_display[0] &&
	    strcmp(view->tracker_display, options->tracker_display) == 0)
		which |= GZ_VIEW_RUN_TRACKER_DISPLAY;
	if (options->cross && view->gaze_cursor)
		which |= GZ_VIEW_RUN_CROSS;
	if (options->letters && view->letters)
		which |= GZ_VIEW_RUN_LETTERS;
	if (!options->vsync && !view->vsync)
		which |= GZ_VIEW_RUN_VSYNC;
	return which;
}

void gz_view_run_copy(unsigned which, const struct gz_view_settings *from,
		      struct gz_view_settings *to)
{
	if (which & GZ_VIEW_RUN_GAZE)
		memcpy(to->gaze, from->gaze, sizeof to->gaze);
	if (which & GZ_VIEW_RUN_TRACKER_DISPLAY)
		memcpy(to->tracker_display, from->tracker_display, sizeof to->tracker_display);
	if (which & GZ_VIEW_RUN_CROSS)
		to->gaze_cursor = from->gaze_cursor;
	if (which & GZ_VIEW_RUN_LETTERS)
		to->letters = from->letters;
	if (which & GZ_VIEW_RUN_VSYNC)
		to->vsync = from->vsync;
}

/* Whether the program prints something and ends. */
static bool only_prints(const struct gz_view_options *options)
{
	return options->help || options->version || options->formats;
}

static enum gz_result read_arguments(int argc, char *const *argv,
				     struct gz_view_scene_tables *tables, const struct gz_log *log,
				     struct gz_view_options *options)
{
	struct gz_option_binding bindings[OWN_BINDINGS + GZ_VIEW_SCENE_TABLES] = {
		{ gz_view_option_table, gz_view_option_count, options, options->given },
		{ gz_target_option_table, gz_target_option_count, &options->target, NULL },
		{ gz_sitting_option_table, gz_sitting_option_count, &options->sitting, NULL },
		{ gz_particle_grid_options, GZ_PARTICLE_GRID_OPTIONS, &options->particles,
		  options->particles_given },
	};
	bool *given = options->scene_given;
	for (size_t i = 0; i < GZ_VIEW_SCENE_TABLES; i++) {
		bindings[OWN_BINDINGS + i] = tables->bindings[i];
		bindings[OWN_BINDINGS + i].given = given;
		given += tables->bindings[i].count;
	}
	if (gz_view_scene_key_count(tables) > GZ_VIEW_SCENE_KEYS_MAX) {
		gz_err(log, "a scene has more keys than gazeview can store; report this as a bug");
		return GZ_ERR_FULL;
	}
	struct gz_operands operands = { .count = 0 };
	enum gz_result r = gz_options_preset(&bindings[0]);
	for (size_t i = 1; i < OWN_BINDINGS && r == GZ_OK; i++)
		r = gz_options_preset(&bindings[i]);
	if (r == GZ_OK)
		r = gz_options_read_arguments(bindings, OWN_BINDINGS + GZ_VIEW_SCENE_TABLES, argc,
					      argv, &operands, log);
	if (r == GZ_OK && !only_prints(options))
		r = take_positional(options, operands.items, operands.count, log);
	return r;
}

enum gz_result gz_view_options_read(int argc, char *const *argv, const struct gz_log *log,
				    struct gz_view_options *out_options)
{
	struct gz_view_scene_tables tables;
	memset(out_options, 0, sizeof *out_options);
	out_options->method = out_options->volume_type = out_options->volume_endian = -1;
	out_options->volume_opacity = out_options->technique = -1;
	out_options->volume_resample = -1;
	out_options->transfer_preset = -1;
	gz_view_pick_scene_tables(&out_options->scene_settings, &tables);
	enum gz_result r = read_arguments(argc, argv, &tables, log, out_options);
	if (r != GZ_OK || only_prints(out_options))
		return r;
	if (out_options->resample && out_options->volume_resample < 0)
		out_options->volume_resample = GZ_RESAMPLING_LINEAR;
	const char *gaze = out_options->gaze_text;
	if (!gaze[0])
		gaze = out_options->headless ? "centre" : "daemon";
	r = gz_gaze_choice_parse(gaze, log, &out_options->gaze);
	if (r == GZ_OK)
		r = check_given_once(out_options, &tables, log);
	return r == GZ_OK ? check_options(out_options, log) : r;
}

bool gz_view_options_raw(const struct gz_view_options *options, struct gz_raw_layout *out_raw)
{
	struct gz_raw_layout raw = {
		.type = (enum gz_raw_type)options->volume_type,
		.big_endian = options->volume_endian == 1,
		.channels = options->volume_channels,
	};
	if (options->volume_dims[0] < 1 || options->volume_type < 0)
		return false;
	memcpy(raw.dims, options->volume_dims, sizeof raw.dims);
	memcpy(raw.spacing, options->volume_spacing, sizeof raw.spacing);
	*out_raw = raw;
	return true;
}

/* A file named on the command line is relative to the current folder, not to the scene. If it is
 * missing, whoever opens it reports that. */
static void apply_transfer(const struct gz_view_options *options,
			   struct gz_scene_settings *settings)
{
	if (options->transfer_preset >= 0)
		settings->transfer_preset = options->transfer_preset;
	if (!options->transfer_file[0])
		return;
	char *real = realpath(options->transfer_file, NULL);
	const bool fits = real && strlen(real) < sizeof settings->transfer_file;
	const char *path = fits ? real : options->transfer_file;
	memset(settings->transfer_file, 0, sizeof settings->transfer_file);
	memcpy(settings->transfer_file, path, strlen(path));
	free(real);
}

/* Copy the value of an option from one struct to another. */
static enum gz_result copy_option(const struct gz_option *option, const void *from, void *to)
{
	char text[GZ_PATH_SIZE];
	const enum gz_result r = gz_option_format(option, from, text, sizeof text);
	return r == GZ_OK ? gz_option_parse(option, text, to, NULL, 0) : r;
}

static enum gz_result apply_particles(const struct gz_view_options *options,
				      struct gz_particle_grid *particles)
{
	enum gz_result r = GZ_OK;
	for (size_t i = 0; i < GZ_PARTICLE_GRID_OPTIONS && r == GZ_OK; i++)
		if (options->particles_given[i])
			r = copy_option(&gz_particle_grid_options[i], &options->particles,
					particles);
	return r;
}

enum gz_result gz_view_options_apply(const struct gz_view_options *options,
				     struct gz_scene_settings *settings)
{
	if (options->volume_series[0])
		memcpy(settings->volume_series, options->volume_series,
		       sizeof settings->volume_series);
	if (options->volume_opacity >= 0)
		settings->opacity = options->volume_opacity;
	if (options->volume_resample >= 0)
		settings->resample = options->volume_resample;
	const enum gz_result r = apply_particles(options, &settings->particles);
	if (r != GZ_OK)
		return r;
	struct gz_scene_settings given = options->scene_settings;
	struct gz_view_scene_tables from, to;
	gz_view_pick_scene_tables(&given, &from);
	gz_view_pick_scene_tables(settings, &to);
	const bool *key_given = options->scene_given;
	for (size_t i = 0; i < GZ_VIEW_SCENE_TABLES; i++) {
		for (size_t k = 0; k < from.bindings[i].count; k++) {
			const struct gz_option *option = &from.bindings[i].options[k];
			if (!*key_given++)
				continue;
			const enum gz_result copied =
				copy_option(option, from.bindings[i].target, to.bindings[i].target);
			if (copied != GZ_OK)
				return copied;
		}
	}
	if (options->method >= 0)
		settings->foveation.method = options->method;
	if (options->technique >= 0)
		settings->technique = options->technique;
	if (gz_view_option_given(options, "isovalue"))
		settings->rays.surface.isovalue = options->isovalue;
	if (options->time_point > 0)
		settings->time_point = options->time_point;
	apply_short_names(options, &settings->view);
	apply_transfer(options, settings);
	return GZ_OK;
}

void gz_view_options_print_help(FILE *out)
{
	const struct gz_option_binding own[OWN_BINDINGS] = {
		{ gz_view_option_table, gz_view_option_count, NULL, NULL },
		{ gz_target_option_table, gz_target_option_count, NULL, NULL },
		{ gz_sitting_option_table, gz_sitting_option_count, NULL, NULL },
		{ gz_particle_grid_options, GZ_PARTICLE_GRID_OPTIONS, NULL, NULL },
	};
	struct gz_scene_settings settings;
	struct gz_view_scene_tables tables;
	gz_view_pick_scene_tables(&settings, &tables);
	fputs("gazeview - show a volume, sharp where someone looks\n\n"
	      "  gazeview SCENE\n"
	      "  gazeview VOLUME\n"
	      "  gazeview --headless --scene SCENE --out frame.png\n"
	      "  gazeview --list-series FOLDER\n"
	      "  gazeview --targets 9\n"
	      "  gazeview --replay NAME.session\n"
	      "  gazeview --experiment FILE --participant 07\n\n",
	      out);
	gz_options_print_help(own, OWN_BINDINGS, out);
	fputs("\nScene keys; given here they replace the scene's own values:\n\n", out);
	gz_options_print_help(tables.bindings, GZ_VIEW_SCENE_TABLES, out);
}
