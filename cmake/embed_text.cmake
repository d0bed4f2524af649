# Turns a text file into a C array of bytes with a final NUL: no escaping, no limit on its length.
#   cmake -DIN=quad.frag -DOUT=quad.frag.c -DNAME=gz_glsl_quad_frag -P embed_text.cmake
file(READ "${IN}" bytes HEX)
string(REGEX REPLACE "([0-9a-f][0-9a-f])" "0x\\1," bytes "${bytes}")
get_filename_component(file "${IN}" NAME)
file(WRITE "${OUT}" "/* Made from ${file}. */\n"
	"extern const char ${NAME}[];\nconst char ${NAME}[] = {${bytes}0};\n")
