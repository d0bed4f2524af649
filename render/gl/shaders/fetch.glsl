// From a place in voxel coordinates to the value there and its entry in the transfer function. Weights are
// full floats: a sampler's own have 8 bits, which would show against the cpu backend.
#ifdef VOXELS_FLOAT
layout(binding = 0) uniform sampler3D voxels;
#else
layout(binding = 0) uniform usampler3D voxels;
#endif

layout(binding = 2) uniform usampler2D transfer; // opacity or extinction as bits, colour; a row a step

float voxel(ivec3 at)
{
	return float(texelFetch(voxels, at, 0).r);
}

#ifdef NEAREST
float sample_at(vec3 at)
{
	return voxel(ivec3(clamp(floor(at), vec3(0.0), dims.xyz - 1.0)));
}
#else
float sample_at(vec3 at)
{
	vec3 place = clamp(at - 0.5, vec3(0.0), dims.xyz - 1.0);
	ivec3 low = min(ivec3(place), last_voxel.xyz);
	ivec3 high = min(low + 1, ivec3(dims.xyz) - 1);
	vec3 share = place - vec3(low);
	vec4 left = vec4(voxel(low), voxel(ivec3(low.x, high.y, low.z)), voxel(ivec3(low.xy, high.z)),
		voxel(ivec3(low.x, high.yz)));
	vec4 right = vec4(voxel(ivec3(high.x, low.yz)), voxel(ivec3(high.xy, low.z)),
		voxel(ivec3(high.x, low.y, high.z)), voxel(high));
	vec4 rows = fma(vec4(share.x), right - left, left);
	vec2 planes = fma(vec2(share.y), rows.yw - rows.xz, rows.xz);
	return fma(share.z, planes.y - planes.x, planes.x);
}
#endif

// The transfer function's entry for a stored value.
int entry_of(float stored)
{
	float entry = fma(stored, transfer_map.x, transfer_map.y);
	return int(clamp(entry, 0.0, float(GZ_TRANSFER_TABLE_SIZE - 1)) + 0.5);
}

vec3 unpack_colour(uint colour)
{
	return vec3(float(colour >> 21), float(colour >> 10 & 2047U), float(colour & 1023U));
}
