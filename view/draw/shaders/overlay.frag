// The cells of a plan, whose pixels may lie elsewhere and closer together than the picture's.
uniform sampler2D cells;
uniform vec2 cells_per_picture;
uniform vec2 cells_before;
uniform float opacity;
in vec2 place;
out vec4 colour;

void main()
{
	ivec2 cell = ivec2(place * cells_per_picture + cells_before);
	colour = vec4(texelFetch(cells, min(cell, textureSize(cells, 0) - 1), 0).rgb, opacity);
}
