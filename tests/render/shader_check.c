#include "suite.h"

#include "shader_check.h"

#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

void shader_check_needs_validator(void)
{
	if (system("glslangValidator --version >/dev/null 2>&1") != 0)
		skip();
}

void shader_check(const struct gz_gl_shader *shader)
{
	static const char *const stages[] = { "vert", "frag", "comp" };
	char path[] = "/tmp/gazecast-shader-XXXXXX", command[128];
	const char *pieces[GZ_GL_PIECES_MAX];
	const int count = gz_gl_shader_source(shader, pieces);
	FILE *out = fdopen(mkstemp(path), "w");
	assert_non_null(out);
	for (int i = 0; i < count; i++)
		fputs(pieces[i], out);
	assert_int_equal(fclose(out), 0);
	snprintf(command, sizeof command, "glslangValidator -S %s %s", stages[shader->stage], path);
	const int status = system(command);
	unlink(path);
	assert_int_equal(status, 0);
}
