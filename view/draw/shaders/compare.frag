// A picture beside, or less, another one of the same place.
uniform sampler2D picture;
uniform sampler2D standard;
uniform float gain; // of the difference; 0: the standard picture itself
in vec2 place;
out vec4 colour;

void main()
{
	vec3 other = texture(standard, place).rgb;
	vec3 difference = gain * abs(texture(picture, place).rgb - other);
	colour = vec4(gain > 0.0 ? difference : other, 1.0);
}
