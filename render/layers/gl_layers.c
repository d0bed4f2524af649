#include "render/layers/gl_layers.h"

#include <GL/glew.h>

#define GZ_LOG_MODULE "layers"

/* Shader text, embedded when the program is built. */
extern const char gz_glsl_layers_glsl[];
extern const char gz_glsl_join_comp[];
extern const char gz_glsl_pick_comp[];

/* Work-group edge of join.comp. */
enum { JOIN_EDGE = 8 };

/* Locations of the uniforms of layers.glsl and join.comp. The last three are arrays of
 * GZ_PLAN_LAYERS_MAX. Literal numbers, since they are pasted into the shader's text, as is
 * GZ_GL_STORAGE_POINTS. */
#define JOIN_PICTURE        0
#define JOIN_BACKGROUND     1
#define JOIN_LATTICES       2
#define JOIN_POINTS         8
#define JOIN_SOLIDS         14
#define JOIN_STORAGE_POINTS 1

#define TEXT_OF(number)      #number
#define DEFINE(name, number) "#define " name " " TEXT_OF(number) "\n"

static const char join_numbers[] =
	DEFINE("UNIT_LAYERS", GZ_GL_UNIT_LAYERS) DEFINE("STORAGE_POINTS", JOIN_STORAGE_POINTS)
		DEFINE("BACKGROUND", JOIN_BACKGROUND) DEFINE("LATTICES", JOIN_LATTICES)
			DEFINE("POINTS", JOIN_POINTS) DEFINE("SOLIDS", JOIN_SOLIDS);

_Static_assert(JOIN_STORAGE_POINTS == GZ_GL_STORAGE_POINTS, "the picture is bound there");
_Static_assert(JOIN_POINTS == JOIN_LATTICES + GZ_PLAN_LAYERS_MAX &&
		       JOIN_SOLIDS == JOIN_POINTS + GZ_PLAN_LAYERS_MAX,
	       "arrays lie one behind the other");

struct gz_gl_shader gz_gl_join_shader(void)
{
	return (struct gz_gl_shader) {
		.stage = GZ_GL_COMPUTE,
		.name = "join.comp",
		.parts = { gz_gl_plan_parts[0], join_numbers, gz_glsl_layers_glsl,
			   gz_glsl_join_comp },
	};
}

struct gz_gl_shader gz_gl_pick_shader(void)
{
	struct gz_gl_shader shader = gz_gl_join_shader();
	shader.name = "pick.comp";
	shader.parts[3] = gz_glsl_pick_comp;
	return shader;
}

enum gz_result gz_gl_layers_prepare(struct gz_gl_layers *layers, const struct gz_gl_device *device,
				    const struct gz_plan *plan, const char *remedy,
				    const struct gz_log *log)
{
	const struct gz_gl_shader join = gz_gl_join_shader(), pick = gz_gl_pick_shader();
	layers->count = gz_raster_layers_make(plan, layers->items);
	layers->width = plan->width;
	layers->height = plan->height;
	if (!layers->join)
		layers->join = gz_gl_program(&join, 1, remedy, log);
	if (!layers->pick)
		layers->pick = gz_gl_program(&pick, 1, remedy, log);
	if (!layers->join || !layers->pick)
		return GZ_ERR_UNSUPPORTED;
	const enum gz_result result = gz_gl_points_prepare(
		&layers->picture, device, (size_t)plan->width * (size_t)plan->height);
	if (result != GZ_OK)
		gz_err(log, "the graphics device has no room for a picture of %d x %d px",
		       plan->width, plan->height);
	return result;
}

/* Close the points that the layer does not draw. */
static void close_hidden(const struct gz_raster_layer *layer)
{
	static const GLfloat nearest = 0;
	const int width = layer->hidden[1][0] - layer->hidden[0][0];
	const int height = layer->hidden[1][1] - layer->hidden[0][1];
	if (width <= 0 || height <= 0)
		return;
	glEnable(GL_SCISSOR_TEST);
	glScissor(layer->hidden[0][0], layer->hidden[0][1], width, height);
	glClearBufferfv(GL_DEPTH, 0, &nearest);
	glDisable(GL_SCISSOR_TEST);
}

void gz_gl_layer_begin(const struct gz_raster_layer *layer)
{
	static const GLfloat farthest = 1;
	glViewport(0, 0, layer->points[0], layer->points[1]);
	glDepthMask(GL_TRUE);
	glClearBufferfv(GL_DEPTH, 0, &farthest);
	close_hidden(layer);
}

static void set_layer_uniforms(const struct gz_gl_layers *layers)
{
	glUniform3i(JOIN_PICTURE, layers->count, layers->width, layers->height);
	for (int i = 0; i < layers->count; i++) {
		const struct gz_raster_layer *layer = &layers->items[i];
		glUniform4i(JOIN_LATTICES + i, layer->from[0], layer->from[1], layer->spacing,
			    layer->band);
		glUniform2i(JOIN_POINTS + i, layer->points[0], layer->points[1]);
		glUniform4i(JOIN_SOLIDS + i, layer->solid[0][0], layer->solid[0][1],
			    layer->solid[1][0], layer->solid[1][1]);
	}
}

/* Run the program in use over the pixels. */
static void run_over_pixels(const struct gz_gl_layers *layers,
			    const unsigned textures[GZ_PLAN_RECTANGLES_MAX])
{
	for (int i = 0; i < layers->count; i++) {
		glActiveTexture((GLenum)(GL_TEXTURE0 + GZ_GL_UNIT_LAYERS + i));
		glBindTexture(GL_TEXTURE_2D, textures[i]);
	}
	glActiveTexture(GL_TEXTURE0);
	set_layer_uniforms(layers);
	gz_gl_points_bind(&layers->picture);
	glDispatchCompute((GLuint)((layers->width + JOIN_EDGE - 1) / JOIN_EDGE),
			  (GLuint)((layers->height + JOIN_EDGE - 1) / JOIN_EDGE), 1);
	glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT | GL_PIXEL_BUFFER_BARRIER_BIT);
	glUseProgram(0);
}

void gz_gl_layers_join(const struct gz_gl_layers *layers,
		       const unsigned textures[GZ_PLAN_RECTANGLES_MAX], const double background[3])
{
	glUseProgram(layers->join);
	glUniform3f(JOIN_BACKGROUND, (float)background[0], (float)background[1],
		    (float)background[2]);
	run_over_pixels(layers, textures);
}

enum gz_result gz_gl_layers_pick(struct gz_gl_layers *layers, const struct gz_gl_device *device,
				 const unsigned textures[GZ_PLAN_RECTANGLES_MAX],
				 uint32_t *out_words)
{
	glUseProgram(layers->pick);
	run_over_pixels(layers, textures);
	return gz_gl_points_read(&layers->picture, device, 0,
				 (size_t)layers->width * (size_t)layers->height, out_words);
}

enum gz_result gz_gl_layers_deliver(struct gz_gl_layers *layers, const struct gz_gl_device *device,
				    struct gz_image *image, const struct gz_log *log)
{
	enum gz_result result = GZ_OK;
	if (image)
		result = gz_gl_points_read(&layers->picture, device, 0,
					   (size_t)layers->width * (size_t)layers->height,
					   gz_image_words(image));
	else
		gz_gl_points_to_texture(&layers->picture, layers->width, layers->height);
	if (result == GZ_OK)
		result = gz_gl_device_errors(device);
	if (result != GZ_OK)
		gz_err(log, "%s failed a frame: %s", device->description,
		       result == GZ_ERR_NO_DEVICE ? "the context is lost" : gz_result_text(result));
	return result;
}

uint64_t gz_gl_layers_drawn(const struct gz_gl_layers *layers)
{
	uint64_t sum = 0;
	for (int i = 0; i < layers->count; i++)
		sum += gz_raster_layer_drawn(&layers->items[i]);
	return sum;
}

void gz_gl_layers_free(struct gz_gl_layers *layers)
{
	/* Without an object GLEW may have no functions yet. */
	if (layers->join)
		glDeleteProgram(layers->join);
	if (layers->pick)
		glDeleteProgram(layers->pick);
	gz_gl_points_free(&layers->picture);
	*layers = (struct gz_gl_layers) { 0 };
}

struct gz_gl_outer_state gz_gl_outer_state_leave(void)
{
	struct gz_gl_outer_state outer;
	glGetIntegerv(GL_DRAW_FRAMEBUFFER_BINDING, &outer.framebuffer);
	glGetIntegerv(GL_VIEWPORT, outer.viewport);
	return outer;
}

void gz_gl_outer_state_return(const struct gz_gl_outer_state *outer)
{
	glDisable(GL_BLEND);
	glDisable(GL_DEPTH_TEST);
	glDepthMask(GL_TRUE);
	glBindVertexArray(0);
	glBindFramebuffer(GL_FRAMEBUFFER, (GLuint)outer->framebuffer);
	glViewport(outer->viewport[0], outer->viewport[1], outer->viewport[2], outer->viewport[3]);
}
