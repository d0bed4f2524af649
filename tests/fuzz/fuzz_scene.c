/* Scenes from anywhere, without the files that they name: whatever the bytes, settings that are
 * accepted make a valid camera and display. */
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "render/scene.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static void require(bool holds)
{
	if (!holds)
		abort();
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
	require((s.volume_file[0] != '\0') != (s.volume_procedural != 0));
	require(memchr(s.volume_file, '\0', sizeof s.volume_file) != NULL);
	require(s.volume_procedural >= 0 && s.volume_procedural <= GZ_PROCEDURAL_COUNT);
	require(s.rays.ray_sampling_rate > 0 && s.image_sampling_rate > 0);
	return 0;
}
