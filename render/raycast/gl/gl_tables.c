#include "render/raycast/gl/gl_tables.h"

#include <string.h>

#include <GL/glew.h>

#include "render/opengl/gl_device.h"
#include "render/raycast/gl/cast_block.h"

void gz_gl_tables_forget(struct gz_gl_tables *tables)
{
	memset(tables->sample_length, 0, sizeof tables->sample_length);
	memset(tables->segment_length, 0, sizeof tables->segment_length);
}

/* An entry is two 32-bit words, a float's bits and a colour. */
void gz_gl_tables_samples(struct gz_gl_tables *tables, const struct gz_transfer_table *table,
			  int row, double length)
{
	struct gz_transfer_entry entries[GZ_TRANSFER_TABLE_SIZE];
	if (tables->sample_length[row] == length)
		return;
	if (!tables->samples) {
		tables->samples = gz_gl_texture(GL_TEXTURE_2D);
		glTexStorage2D(GL_TEXTURE_2D, 1, GL_RG32UI, GZ_TRANSFER_TABLE_SIZE,
			       GZ_GL_TABLE_ROWS);
	}
	const struct gz_transfer_entry *source = table->entries;
	if (row < GZ_PLAN_STEPS_MAX) {
		gz_transfer_table_step(table, length, entries);
		source = entries;
	}
	glBindTexture(GL_TEXTURE_2D, tables->samples);
	glTexSubImage2D(GL_TEXTURE_2D, 0, 0, row, GZ_TRANSFER_TABLE_SIZE, 1, GL_RG_INTEGER,
			GL_UNSIGNED_INT, source);
	glBindTexture(GL_TEXTURE_2D, 0);
	tables->sample_length[row] = length;
}

void gz_gl_tables_segments(struct gz_gl_tables *tables, int layer, double length,
			   const struct gz_transfer_entry *entries)
{
	if (tables->segment_length[layer] == length)
		return;
	if (!tables->segments) {
		tables->segments = gz_gl_texture(GL_TEXTURE_2D_ARRAY);
		glTexStorage3D(GL_TEXTURE_2D_ARRAY, 1, GL_RG32UI, GZ_PREINTEGRATED_SIZE,
			       GZ_PREINTEGRATED_SIZE, GZ_GL_TABLE_ROWS);
	}
	glBindTexture(GL_TEXTURE_2D_ARRAY, tables->segments);
	glTexSubImage3D(GL_TEXTURE_2D_ARRAY, 0, 0, 0, layer, GZ_PREINTEGRATED_SIZE,
			GZ_PREINTEGRATED_SIZE, 1, GL_RG_INTEGER, GL_UNSIGNED_INT, entries);
	glBindTexture(GL_TEXTURE_2D_ARRAY, 0);
	tables->segment_length[layer] = length;
}

void gz_gl_tables_bind(const struct gz_gl_tables *tables)
{
	glBindImageTexture(GZ_GL_UNIT_TRANSFER, tables->samples, 0, GL_FALSE, 0, GL_READ_ONLY,
			   GL_RG32UI);
	glActiveTexture(GL_TEXTURE0 + GZ_GL_UNIT_TRANSFER);
	glBindTexture(GL_TEXTURE_2D, tables->samples);
	glBindImageTexture(GZ_GL_UNIT_SEGMENTS, tables->segments, 0, GL_TRUE, 0, GL_READ_ONLY,
			   GL_RG32UI);
	glActiveTexture(GL_TEXTURE0 + GZ_GL_UNIT_SEGMENTS);
	glBindTexture(GL_TEXTURE_2D_ARRAY, tables->segments);
	glActiveTexture(GL_TEXTURE0);
}

void gz_gl_tables_free(struct gz_gl_tables *tables)
{
	const GLuint textures[] = { tables->samples, tables->segments };
	if (tables->samples || tables->segments)
		glDeleteTextures(sizeof textures / sizeof textures[0], textures);
	*tables = (struct gz_gl_tables) { 0 };
}
