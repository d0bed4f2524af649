// The layers of a picture (struct gz_raster_layer), coarsest first, and the picture that is written.
layout(local_size_x = 8, local_size_y = 8) in;

layout(location = 0) uniform ivec3 picture; // layers, width, height
layout(location = LATTICES) uniform ivec4 lattices[GZ_PLAN_LAYERS_MAX]; // from, spacing, band
layout(location = POINTS) uniform ivec2 points[GZ_PLAN_LAYERS_MAX];     // columns, rows
layout(location = SOLIDS) uniform ivec4 solids[GZ_PLAN_LAYERS_MAX];     // from, to

layout(std430, binding = STORAGE_POINTS) writeonly buffer Picture
{
	uint pixels[];
};

// 1 in the solid rectangle, 0 beyond the band around it.
float share_of(int layer, ivec2 pixel)
{
	ivec2 outside = max(max(solids[layer].xy - pixel, pixel - solids[layer].zw + 1), ivec2(0));
	float band = float(lattices[layer].w);
	return layer == 0 ? 1.0 : 1.0 - smoothstep(0.0, band + 1.0, float(max(outside.x, outside.y)));
}
