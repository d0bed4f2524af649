#include "render/raycast/gl/gl_textures.h"

#include <stdlib.h>
#include <string.h>

#include <GL/glew.h>

#include "render/raycast/gl/gl_cast.h"

const struct gz_gl_texel_format *gz_gl_texel_format(enum gz_gl_texels texels,
						    enum gz_voxel_type type)
{
	static const struct gz_gl_texel_format packed[GZ_VOXEL_TYPE_COUNT] = {
		[GZ_VOXEL_U8] = { GL_R32UI, GL_RED_INTEGER, GL_UNSIGNED_INT, 4 },
		[GZ_VOXEL_U16] = { GL_R32UI, GL_RED_INTEGER, GL_UNSIGNED_INT, 4 },
		[GZ_VOXEL_F32] = { GL_R32F, GL_RED, GL_FLOAT, 4 },
	};
	static const struct gz_gl_texel_format single[GZ_VOXEL_TYPE_COUNT] = {
		[GZ_VOXEL_U8] = { GL_R8UI, GL_RED_INTEGER, GL_UNSIGNED_BYTE, 1 },
		[GZ_VOXEL_U16] = { GL_R16UI, GL_RED_INTEGER, GL_UNSIGNED_SHORT, 2 },
		[GZ_VOXEL_F32] = { GL_R32F, GL_RED, GL_FLOAT, 4 },
	};
	return texels == GZ_GL_TEXELS_PACKED ? &packed[type] : &single[type];
}

/* Bytes given to the driver at a time, which may copy them first. Chosen: small beside a large
 * volume, large beside the cost of a call. */
#define UPLOAD_BYTES ((size_t)16 << 20)

/* Pack a row of 8-bit voxels, each with its neighbours along x, y and both. */
static void pack_row_u8(const uint8_t *row, const uint8_t *next_row, int count, uint32_t *out)
{
	for (int x = 0; x + 1 < count; x++)
		out[x] = (uint32_t)row[x] | (uint32_t)row[x + 1] << 8 |
			 (uint32_t)next_row[x] << 16 | (uint32_t)next_row[x + 1] << 24;
	const int last = count - 1;
	out[last] = row[last] * 0x101U | (next_row[last] * 0x101U) << 16;
}

/* Pack a row of 16-bit voxels, each with its neighbour along x. */
static void pack_row_u16(const uint16_t *row, int count, uint32_t *out)
{
	for (int x = 0; x + 1 < count; x++)
		out[x] = (uint32_t)row[x] | (uint32_t)row[x + 1] << 16;
	out[count - 1] = row[count - 1] * 0x10001U;
}

/* Pack one slice of texels. */
static void pack_slice(const struct gz_volume *volume, int z, uint32_t *out)
{
	const size_t columns = (size_t)volume->dims[0], rows = (size_t)volume->dims[1];
	for (size_t y = 0; y < rows; y++, out += columns) {
		const size_t row = ((size_t)z * rows + y) * columns;
		const size_t next_row = y + 1 < rows ? row + columns : row;
		if (volume->type == GZ_VOXEL_U8)
			pack_row_u8((const uint8_t *)volume->voxels + row,
				    (const uint8_t *)volume->voxels + next_row, volume->dims[0],
				    out);
		else if (volume->type == GZ_VOXEL_U16)
			pack_row_u16((const uint16_t *)volume->voxels + row, volume->dims[0], out);
		else
			memcpy(out, (const float *)volume->voxels + row, columns * sizeof *out);
	}
}

/* Upload packed texels to the bound texture, a few slices at a time. GZ_ERR_NO_MEM. */
static enum gz_result upload_packed(const struct gz_volume *volume)
{
	const struct gz_gl_texel_format *format =
		gz_gl_texel_format(GZ_GL_TEXELS_PACKED, volume->type);
	const int *dims = volume->dims;
	const size_t slice = (size_t)dims[0] * (size_t)dims[1];
	const size_t slice_bytes = slice * sizeof(uint32_t);
	const int slices = slice_bytes < UPLOAD_BYTES ? (int)(UPLOAD_BYTES / slice_bytes) : 1;
	uint32_t *texels = malloc(slice_bytes * (size_t)slices);
	if (!texels)
		return GZ_ERR_NO_MEM;
	for (int z = 0; z < dims[2]; z += slices) {
		const int count = z + slices < dims[2] ? slices : dims[2] - z;
		for (int i = 0; i < count; i++)
			pack_slice(volume, z + i, texels + (size_t)i * slice);
		glTexSubImage3D(GL_TEXTURE_3D, 0, 0, 0, z, dims[0], dims[1], count,
				format->external, format->type, texels);
	}
	free(texels);
	return GZ_OK;
}

/* Upload single voxels to the bound texture, a slice at a time. */
static enum gz_result upload_single(const struct gz_volume *volume)
{
	const struct gz_gl_texel_format *format =
		gz_gl_texel_format(GZ_GL_TEXELS_SINGLE, volume->type);
	const int *dims = volume->dims;
	const size_t slice_bytes = (size_t)dims[0] * (size_t)dims[1] * format->bytes;
	glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
	for (int z = 0; z < dims[2]; z++)
		glTexSubImage3D(GL_TEXTURE_3D, 0, 0, 0, z, dims[0], dims[1], 1, format->external,
				format->type,
				(const char *)volume->voxels + (size_t)z * slice_bytes);
	glPixelStorei(GL_UNPACK_ALIGNMENT, 4);
	return GZ_OK;
}

static bool fits_edges(const struct gz_gl_device *device, const struct gz_volume *volume)
{
	for (int axis = 0; axis < 3; axis++)
		if (volume->dims[axis] > device->volume_edge_max)
			return false;
	return true;
}

static enum gz_result load_texels(struct gz_gl_volume *gl, const struct gz_gl_device *device,
				  const struct gz_volume *volume, enum gz_gl_texels texels)
{
	const struct gz_gl_texel_format *format = gz_gl_texel_format(texels, volume->type);
	const size_t bytes = gz_volume_voxel_count(volume) * format->bytes;
	if (device->memory_known && bytes > (size_t)device->memory_max)
		return GZ_ERR_NO_MEM;
	gl->texels = texels;
	gl->voxels = gz_gl_texture(GL_TEXTURE_3D);
	glTexStorage3D(GL_TEXTURE_3D, 1, format->internal, volume->dims[0], volume->dims[1],
		       volume->dims[2]);
	enum gz_result result = gz_gl_device_errors(device);
	if (result == GZ_OK) {
		result = texels == GZ_GL_TEXELS_PACKED ? upload_packed(volume)
						       : upload_single(volume);
		const enum gz_result errors = gz_gl_device_errors(device);
		result = result == GZ_OK ? errors : result;
	}
	glBindTexture(GL_TEXTURE_3D, 0);
	if (result != GZ_OK)
		gz_gl_volume_free(gl);
	return result;
}

/* Upload the colours of a volume. On failure nothing of it is left. */
static enum gz_result load_colours(struct gz_gl_volume *gl, const struct gz_gl_device *device,
				   const struct gz_volume *volume)
{
	const int *dims = volume->dims;
	const size_t slice = (size_t)dims[0] * (size_t)dims[1];
	const size_t bytes = gz_volume_voxel_count(volume) * sizeof *volume->colours;
	if (device->memory_known && bytes > (size_t)device->memory_max)
		return GZ_ERR_NO_MEM;
	gl->colours = gz_gl_texture(GL_TEXTURE_3D);
	glTexStorage3D(GL_TEXTURE_3D, 1, GL_R32UI, dims[0], dims[1], dims[2]);
	enum gz_result result = gz_gl_device_errors(device);
	for (int z = 0; z < dims[2] && result == GZ_OK; z++)
		glTexSubImage3D(GL_TEXTURE_3D, 0, 0, 0, z, dims[0], dims[1], 1, GL_RED_INTEGER,
				GL_UNSIGNED_INT, volume->colours + (size_t)z * slice);
	if (result == GZ_OK)
		result = gz_gl_device_errors(device);
	glBindTexture(GL_TEXTURE_3D, 0);
	return result;
}

enum gz_result gz_gl_volume_load(struct gz_gl_volume *gl, const struct gz_gl_device *device,
				 const struct gz_volume *volume)
{
	gz_gl_volume_free(gl);
	if (!fits_edges(device, volume))
		return GZ_ERR_UNSUPPORTED;
	enum gz_result result = load_texels(gl, device, volume, GZ_GL_TEXELS_PACKED);
	if (result == GZ_ERR_NO_MEM && volume->type != GZ_VOXEL_F32)
		result = load_texels(gl, device, volume, GZ_GL_TEXELS_SINGLE);
	if (result == GZ_OK && volume->colours)
		result = load_colours(gl, device, volume);
	if (result != GZ_OK)
		gz_gl_volume_free(gl);
	return result;
}

void gz_gl_volume_lend(struct gz_gl_volume *gl, unsigned atlas)
{
	gz_gl_volume_free(gl);
	gl->texels = GZ_GL_TEXELS_BRICKS;
	gl->voxels = atlas;
}

void gz_gl_volume_classify(struct gz_gl_volume *gl, const struct gz_macrocells *cells)
{
	if (!gl->reach) {
		gl->reach = gz_gl_texture(GL_TEXTURE_3D);
		glTexStorage3D(GL_TEXTURE_3D, 1, GL_R8UI, cells->dims[0], cells->dims[1],
			       cells->dims[2]);
	}
	glBindTexture(GL_TEXTURE_3D, gl->reach);
	glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
	glTexSubImage3D(GL_TEXTURE_3D, 0, 0, 0, 0, cells->dims[0], cells->dims[1], cells->dims[2],
			GL_RED_INTEGER, GL_UNSIGNED_BYTE, cells->reach);
	glPixelStorei(GL_UNPACK_ALIGNMENT, 4);
	glBindTexture(GL_TEXTURE_3D, 0);
}

void gz_gl_volume_bind(const struct gz_gl_volume *gl, enum gz_voxel_type type)
{
	glBindImageTexture(GZ_GL_UNIT_VOXELS, gl->voxels, 0, GL_TRUE, 0, GL_READ_ONLY,
			   gz_gl_texel_format(gl->texels, type)->internal);
	glBindImageTexture(GZ_GL_UNIT_REACH, gl->reach, 0, GL_TRUE, 0, GL_READ_ONLY, GL_R8UI);
	glActiveTexture(GL_TEXTURE0 + GZ_GL_UNIT_REACH);
	glBindTexture(GL_TEXTURE_3D, gl->reach);
	if (gl->colours) {
		glActiveTexture(GL_TEXTURE0 + GZ_GL_UNIT_COLOURS);
		glBindTexture(GL_TEXTURE_3D, gl->colours);
	}
	glActiveTexture(GL_TEXTURE0 + GZ_GL_UNIT_VOXELS);
	glBindTexture(GL_TEXTURE_3D, gl->voxels);
}

void gz_gl_volume_free(struct gz_gl_volume *gl)
{
	const bool lent = gl->texels == GZ_GL_TEXELS_BRICKS;
	const GLuint textures[] = { lent ? 0 : gl->voxels, gl->reach, gl->colours };
	/* GLEW has no functions before a context was opened, and then there is nothing to delete.
	 */
	if (gl->voxels || gl->reach)
		glDeleteTextures(sizeof textures / sizeof textures[0], textures);
	*gl = (struct gz_gl_volume) { 0 };
}

void gz_gl_tables_forget(struct gz_gl_tables *tables)
{
	memset(tables->sample_length, 0, sizeof tables->sample_length);
	memset(tables->segment_length, 0, sizeof tables->segment_length);
}

/* Make the texture of samples, or another one if the table has changed its size. */
static void prepare_samples(struct gz_gl_tables *tables, int rows)
{
	if (tables->samples && tables->sample_rows == rows)
		return;
	if (tables->samples)
		glDeleteTextures(1, &tables->samples);
	tables->samples = gz_gl_texture(GL_TEXTURE_2D);
	tables->sample_rows = rows;
	glTexStorage2D(GL_TEXTURE_2D, 1, GL_RG32UI, GZ_TRANSFER_TABLE_SIZE,
		       GZ_GL_SAMPLE_ROWS * rows);
	memset(tables->sample_length, 0, sizeof tables->sample_length);
}

/* In place of each entry's colour, the number of the first one from it on that shows something; the
 * table's length if there is none. */
static void number_next_visible(const struct gz_transfer_table *table,
				struct gz_transfer_entry *out_entries)
{
	uint32_t next = (uint32_t)table->count;
	for (int i = table->count - 1; i >= 0; i--) {
		if (table->visible_before[i + 1] > table->visible_before[i])
			next = (uint32_t)i;
		out_entries[i] = (struct gz_transfer_entry) { .opacity = 0, .colour = next };
	}
}

/* An entry is two words of 32 bits: a float and a colour. */
enum gz_result gz_gl_tables_samples(struct gz_gl_tables *tables,
				    const struct gz_transfer_table *table, int row, double length)
{
	const int rows = table->count / GZ_TRANSFER_TABLE_SIZE;
	prepare_samples(tables, rows);
	if (tables->sample_length[row] == length)
		return GZ_OK;
	const size_t count = (size_t)table->count;
	struct gz_transfer_entry *entries = malloc(count * sizeof *entries);
	if (!entries)
		return GZ_ERR_NO_MEM;
	if (row < GZ_PLAN_STEPS_MAX)
		gz_transfer_table_step(table, length, entries);
	else if (row == GZ_GL_NEXT_VISIBLE_ROW)
		number_next_visible(table, entries);
	else
		memcpy(entries, table->entries, count * sizeof *entries);
	glBindTexture(GL_TEXTURE_2D, tables->samples);
	glTexSubImage2D(GL_TEXTURE_2D, 0, 0, row * rows, GZ_TRANSFER_TABLE_SIZE, rows,
			GL_RG_INTEGER, GL_UNSIGNED_INT, entries);
	glBindTexture(GL_TEXTURE_2D, 0);
	free(entries);
	tables->sample_length[row] = length;
	return GZ_OK;
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
