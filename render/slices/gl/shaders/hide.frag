// Lets only the points pass that hardly any light comes through.
layout(binding = BLENDED) uniform sampler2D blended;

void main()
{
	if (1.0 - texelFetch(blended, ivec2(gl_FragCoord.xy), 0).a > GZ_TRANSMITTANCE_END)
		discard;
}
