/* Which parts there are. A new one is a row here. */
#include "view/window/basics.h"
#include "view/window/camera.h"
#include "view/window/capture.h"
#include "view/window/compare.h"
#include "view/window/corner.h"
#include "view/window/displays.h"
#include "view/window/experiment.h"
#include "view/window/files.h"
#include "view/window/frame_times.h"
#include "view/window/gaze_settings.h"
#include "view/window/gaze_sources.h"
#include "view/window/keys.h"
#include "view/window/latency.h"
#include "view/window/loading.h"
#include "view/window/notices.h"
#include "view/window/overlay.h"
#include "view/window/part.h"
#include "view/window/replay_part.h"
#include "view/window/screenshots.h"
#include "view/window/session_part.h"
#include "view/window/status.h"
#include "view/window/trail.h"
#include "view/window/transfer.h"

/* clang-format off */
const struct gz_window_part *const gz_window_parts[] = {
	&gz_window_loading,
	&gz_window_keys,
	&gz_window_display_part,
	&gz_window_gaze_sources,
	&gz_window_status,
	&gz_window_compare_part,
	&gz_window_overlay_part,
	&gz_window_corner_part,
	&gz_window_trail_part,
	&gz_window_camera,
	&gz_window_frame_times_part,
	&gz_window_gaze_settings_part,
	&gz_window_latency_part,
	&gz_window_files,
	&gz_window_notices,
	&gz_window_transfer_part,
	&gz_window_replay,
	&gz_window_session,
	&gz_window_capture,
	&gz_window_screenshots,
	/* Behind those whose panels Escape closes: it quits where none is open. */
	&gz_window_basics,
	&gz_window_experiment_part,
	NULL,
};
/* clang-format on */
