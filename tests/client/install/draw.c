/* A program of a user: a volume of its own, drawn once. */
#include <stdio.h>
#include <stdlib.h>

#include <render.h>

static int fail(struct gz_renderer *renderer)
{
	fprintf(stderr, "%s\n", gz_renderer_message(renderer));
	gz_renderer_close(&renderer);
	return EXIT_FAILURE;
}

int main(void)
{
	static unsigned char voxels[8 * 8 * 8], picture[48 * 64 * 4];
	const int dims[3] = { 8, 8, 8 };
	const double gaze[2] = { 0.5, 0.5 };
	struct gz_renderer *renderer;
	for (int i = 0; i < 8 * 8 * 8; i++)
		voxels[i] = (unsigned char)(i % 256);
	if (gz_renderer_open("cpu", 1, &renderer) != GZ_OK)
		return EXIT_FAILURE;
	if (gz_renderer_set(renderer, "foveation.method", "standard") != GZ_OK ||
	    gz_renderer_set_volume(renderer, "uint8", dims, NULL, voxels, sizeof voxels) != GZ_OK ||
	    gz_renderer_draw(renderer, 64, 48, gaze, picture, sizeof picture) != GZ_OK)
		return fail(renderer);
	printf("64 x 48, %g rays\n", gz_renderer_cost(renderer, 5));
	gz_renderer_close(&renderer);
	return EXIT_SUCCESS;
}
