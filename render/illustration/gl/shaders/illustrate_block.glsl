// What the shaders of illustrations know of a frame: struct gz_illustrate_block of illustrate_programs.h. Places and
// lengths are in mm.
layout(std140, binding = BLOCK) uniform Illustration
{
	vec4 origin00, origin_dx, origin_dy; // of the rays of pixels
	vec4 direction00, direction_dx, direction_dy;
	vec4 view_rows[4]; // struct gz_raster_view
	vec4 clip_least, clip_greatest, clip_plane; // struct gz_clip_bounds of render/data/clip_region.h
	vec4 lamp; // unit vector towards the lamp of plain light
};
