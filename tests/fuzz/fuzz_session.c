/* Sessions from anywhere: whatever the bytes, frames that are read keep the header's promises. */
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#include "render/picture/image.h"
#include "render/plan/plan.h"
#include "view/session/session_reader.h"
#include "view/settings/scene_keys.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static void require(bool holds)
{
	if (!holds)
		abort();
}

static void require_frame(const struct gz_session_frame *frame, int64_t time_ns)
{
	require(frame->time_ns >= time_ns);
	require(frame->width >= 1 && frame->width <= GZ_IMAGE_SIDE_MAX);
	require(frame->height >= 1 && frame->height <= GZ_IMAGE_SIDE_MAX);
	require(gz_display_valid(&frame->display));
	require(frame->focus.scale >= 1 && frame->focus.widen >= 0 && frame->focus.widen <= 1);
	require(frame->focus.finer >= 1 && frame->focus.finer <= GZ_PLAN_FINER_MAX);
	require(!frame->reading.has_event || (unsigned)frame->reading.event < GZ_EVENT_COUNT);
}

/* Each value by itself is one that its table has. */
static void require_settings(struct gz_scene_settings *settings)
{
	struct gz_view_live_tables tables;
	gz_view_pick_live_tables(settings, &tables);
	for (size_t i = 0; i < tables.count; i++)
		for (size_t k = 0; k < tables.bindings[i].count; k++)
			require(gz_option_holds(&tables.bindings[i].options[k],
						tables.bindings[i].target));
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	static const char scene[] = "[volume]\nprocedural = shells\n[transfer]\nfile = a.tf\n";
	struct gz_session_reader *reader = NULL;
	struct gz_session_state state = { .transfer.count = 1 };
	struct gz_session_frame frame;
	int64_t time_ns = 0;
	bool has_display;
	require(gz_scene_parse("scene", scene, sizeof scene - 1, NULL, &state.settings,
			       &has_display) == GZ_OK);
	if (size == 0 ||
	    gz_session_open_memory("fuzz", (const char *)data, size, NULL, &reader) != GZ_OK)
		return 0;
	uint64_t frames = 0;
	while (gz_session_read(reader, &state, &frame) == GZ_OK) {
		require_frame(&frame, time_ns);
		time_ns = frame.time_ns;
		frames++;
	}
	require(frames == gz_session_frames_read(reader));
	require_settings(&state.settings);
	require(state.transfer.count >= 1 && state.transfer.count <= GZ_TRANSFER_POINTS_MAX);
	gz_session_close(&reader);
	return 0;
}
