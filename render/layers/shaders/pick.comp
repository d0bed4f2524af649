// Takes for each pixel the nearest point of the layer that it shows most: for numbers that must not be mixed.
layout(binding = UNIT_LAYERS) uniform usampler2D words[GZ_PLAN_LAYERS_MAX];

void main()
{
	ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
	if (pixel.x >= picture.y || pixel.y >= picture.z)
		return;
	uint word = 0U;
	for (int layer = 0; layer < picture.x; layer++) {
		int spacing = lattices[layer].z;
		ivec2 place = (pixel - lattices[layer].xy + spacing / 2) / spacing;
		if (share_of(layer, pixel) >= 0.5)
			word = texelFetch(words[layer], min(place, points[layer] - 1), 0).r;
	}
	pixels[pixel.y * picture.y + pixel.x] = word;
}
