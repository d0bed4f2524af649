// Light on a point of a surface: struct gz_light of render/light/light.h has the formulas. All vectors are of
// length 1; terms are ambient, diffuse, specular and shininess. Returns the factor of the surface's colour, and
// the white to add to it.
vec2 shine(vec3 normal, vec3 to_eye, vec3 halfway, vec3 towards, vec4 terms)
{
	float side = clamp(dot(normal, to_eye) / GZ_LIGHT_FACING, -1.0, 1.0);
	float diffuse = max(side * dot(normal, towards), 0.0);
	float cosine = clamp(abs(dot(normal, halfway)), 1e-12, 1.0);
	float gloss = exp2(terms.w * log2(cosine)) * min(diffuse / GZ_LIGHT_FACING, 1.0);
	return vec2(fma(diffuse, terms.y, terms.x), gloss * terms.z);
}
