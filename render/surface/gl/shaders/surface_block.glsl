// What the shaders of surfaces know of a frame: struct gz_raster_block of raster_programs.h. Places and lengths are
// in mm.
layout(std140, binding = BLOCK) uniform Surface
{
	vec4 origin00, origin_dx, origin_dy; // of the rays of pixels
	vec4 direction00, direction_dx, direction_dy;
	vec4 view_rows[4]; // struct gz_raster_view
	vec4 clip_least, clip_greatest, clip_plane; // struct gz_clip_bounds of render/data/clip_region.h
	vec4 light_towards; // unit vector
	vec4 light_terms;   // ambient, diffuse, specular, shininess
	vec4 scale;         // world units of a mm; light.reflection
	vec4 glass;         // refractive index; share that is reflected along the normal
	vec4 shadow_rows[3];                // struct gz_raster_shadow
	vec4 shadow_texel;                  // edge in mm; as a share of the map's; the same length as depth
	ivec4 are;                          // whether there are glass, shadows
	Surroundings around;
};
