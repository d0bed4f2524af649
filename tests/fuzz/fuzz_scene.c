/* Scenes from untrusted bytes, without the files that they name: settings that are
 * accepted make a valid camera and display, and are written as a scene with the same values. */
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "render/scene/scene_write.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static void require(bool holds)
{
	if (!holds)
		abort();
}

/* A line holds 199 bytes, and is written with two blanks that it may not have had. */
static bool has_long_line(const struct gz_text *text)
{
	size_t length = 0;
	for (size_t i = 0; i < text->length; i++) {
		length = text->bytes[i] == '\n' ? 0 : length + 1;
		if (length > 199)
			return true;
	}
	return false;
}

static void check_written(const struct gz_scene_settings *settings, bool has_display)
{
	const struct gz_scene_saved saved = { settings, has_display, "" };
	struct gz_text once = { 0 }, again = { 0 };
	struct gz_scene_settings read;
	bool display = false;
	require(gz_scene_print(&saved, NULL, &once) == GZ_OK);
	if (!has_long_line(&once)) {
		require(gz_scene_parse("written", once.bytes, once.length, NULL, &read, &display) ==
			GZ_OK);
		const struct gz_scene_saved back = { &read, display, "" };
		require(gz_scene_print(&back, NULL, &again) == GZ_OK);
		require(display == has_display && once.length == again.length &&
			memcmp(once.bytes, again.bytes, once.length) == 0);
	}
	gz_text_free(&once);
	gz_text_free(&again);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	struct gz_scene_settings s;
	struct gz_ray_frame rays;
	bool has_display = false;
	if (gz_scene_parse("fuzz", (const char *)data, size, NULL, &s, &has_display) != GZ_OK)
		return 0;
	require(gz_camera_rays(&s.camera, 640, 480, &rays) == GZ_OK);
	require(!has_display || gz_display_valid(&s.display));
	require(s.objects.count > 0 || (s.volume_file[0] != '\0') != (s.volume_procedural != 0));
	require(memchr(s.volume_file, '\0', sizeof s.volume_file) != NULL);
	require(s.volume_procedural >= 0 && s.volume_procedural <= GZ_PROCEDURAL_COUNT);
	require(s.rays.ray_sampling_rate > 0 && s.image_sampling_rate > 0);
	check_written(&s, has_display);
	return 0;
}
