// Makes the planes of a picture from what was found on its lattices, as rays' planes are reconstructed
// (render/reconstruct/cpu/plane_filters.c): numbers mix where both are there, otherwise the nearer point counts;
// objects never mix.
layout(location = OWN) uniform int planes; // that are wanted: tone, depth, object and, if 4, distance

layout(binding = UNIT_LAYERS) uniform sampler2D layers[GZ_PLAN_LAYERS_MAX];

#define NOTHING   uintBitsToFloat(0x7F800000U) // infinity
#define SOMETHING 3e38                        // numbers below are something

vec4 point_at(int layer, ivec2 place)
{
	vec4 found = texelFetch(layers[layer], place, 0);
	return found.z == 0.0 ? vec4(NOTHING, NOTHING, 0.0, NOTHING)
			      : vec4(found.xy, found.z, found.w < SOMETHING ? found.w : NOTHING);
}

// b with a share, and a.
vec4 mixed(vec4 a, vec4 b, float share)
{
	vec4 nearer = share < 0.5 ? a : b;
	bvec4 are = lessThan(max(a, b), vec4(SOMETHING));
	are.z = false;
	return mix(nearer, mix(a, b, share), are);
}

// Between the four points around a pixel.
vec4 between(int layer, ivec2 pixel)
{
	ivec2 offset = pixel - lattices[layer].xy, place = offset / lattices[layer].z;
	vec2 along = vec2(offset - place * lattices[layer].z) / float(lattices[layer].z);
	if (along == vec2(0.0))
		return point_at(layer, place);
	ivec2 next = min(place + 1, points[layer] - 1);
	vec4 upper = mixed(point_at(layer, place), point_at(layer, ivec2(next.x, place.y)), along.x);
	vec4 lower = mixed(point_at(layer, ivec2(place.x, next.y)), point_at(layer, next), along.x);
	return mixed(upper, lower, along.y);
}

void main()
{
	ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
	if (pixel.x >= picture.y || pixel.y >= picture.z)
		return;
	int layer = picture.x - 1;
	while (layer > 0 && share_of(layer, pixel) < 1.0) // what lies behind a whole share is not seen
		layer--;
	vec4 sum = between(layer, pixel);
	for (layer++; layer < picture.x; layer++) {
		float share = share_of(layer, pixel);
		if (share > 0.0)
			sum = mixed(sum, between(layer, pixel), share);
	}
	int at = pixel.y * picture.y + pixel.x, count = picture.y * picture.z;
	pixels[at] = floatBitsToUint(sum.x);
	pixels[count + at] = floatBitsToUint(sum.y);
	pixels[2 * count + at] = uint(abs(sum.z));
	if (planes > 3)
		pixels[3 * count + at] = floatBitsToUint(sum.w);
}
