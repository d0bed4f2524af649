// A fixation target: a disc, a cross in the ground's colour over it, a dot in the middle.
uniform vec2 size;     // of the window, px
uniform vec2 centre;   // px from the top left
uniform float radius;  // of the disc, px; 0 for no target
uniform float dot_radius;
uniform float arm;     // half the width of the cross, px
in vec2 place;
out vec4 colour;

const vec3 GROUND = vec3(0.5);
const vec3 INK = vec3(0.0);

// Share of a pixel that lies inside an edge, @distance px outside of it.
float inside(float distance)
{
	return clamp(0.5 - distance, 0.0, 1.0);
}

void main()
{
	vec2 p = place * size - centre;
	float disc = inside(length(p) - radius);
	float cross = max(inside(abs(p.x) - arm), inside(abs(p.y) - arm));
	float dot_ = inside(length(p) - dot_radius);
	float ink = radius > 0.0 ? max(disc * (1.0 - cross), dot_) : 0.0;
	colour = vec4(mix(GROUND, INK, ink), 1.0);
}
