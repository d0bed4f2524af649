#include "render/technique/technique.h"

void gz_drawer_destroy(struct gz_drawer **drawer)
{
	if (*drawer)
		(*drawer)->ops->destroy(*drawer);
	*drawer = NULL;
}
