#include "render/gl/gl_context.h"

#include <stddef.h>

void gz_gl_context_destroy(struct gz_gl_context **context)
{
	if (!*context)
		return;
	if ((*context)->ops->destroy)
		(*context)->ops->destroy(*context);
	*context = NULL;
}
