// What the casting shaders know of the frame: struct gz_gl_cast_block of gl_cast.h.
layout(std140, binding = 1) uniform Cast
{
	vec4 origin00, origin_dx, origin_dy;
	vec4 direction00, direction_dx, direction_dy;
	vec4 world_per_voxel; // last: depth at which rays begin
	vec4 dims; // voxels
	vec4 box;  // far corner: dims, or less for a coarser level of odd size
	vec4 clip_least, clip_greatest;
	vec4 clip_plane; // struct gz_clip_bounds of render/data/clip_region.h
	vec4 cell_counts;
	vec4 transfer_map; // scale and bias from stored value to share of the table; share of light at which a ray ends
	vec4 light_towards; // unit vector in world directions; greatest share of the ambient light that is blocked
	vec4 light_terms;   // ambient, diffuse, specular, shininess
	vec4 gradient_scale; // last: light.reflection
	vec4 occlusion_scale, occlusion_bias, occlusion_last; // to places among the cells; greatest index
	vec4 arriving_scale, arriving_bias, arriving_last;    // the same for the grid of shadows
	uvec4 jitter; // seed, 0 = none; first pixel of the picture in the plan
	vec4 steps[GZ_PLAN_STEPS_MAX];
	vec4 depths; // scale and bias from world units along a ray to a share of the depths that are told
	uvec4 brick_table; // number of the level's first brick; bricks from one to the next along y, z
	vec4 brick_last;   // greatest number of a brick
	vec4 brick_scales[BRICK_LEVELS]; // by level: its voxels per voxel of this level
	Surroundings around;
};

vec3 world_place(vec3 at)
{
	return (at - 0.5 * box.xyz) * world_per_voxel.xyz;
}

// What the ray of a pixel sees behind the volume.
vec3 see_behind(vec2 pixel)
{
	if (around.kind.x == 0)
		return around.horizon.rgb;
	vec3 origin = fma(vec3(pixel.y), origin_dy.xyz, fma(vec3(pixel.x), origin_dx.xyz, origin00.xyz));
	vec3 direction =
		fma(vec3(pixel.y), direction_dy.xyz, fma(vec3(pixel.x), direction_dx.xyz, direction00.xyz));
	origin -= world_per_voxel.w * direction;
	return see_surroundings(around, world_place(origin), normalize(direction * world_per_voxel.xyz));
}
