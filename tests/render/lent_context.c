#include "lent_context.h"

#include "render/opengl/gl_device.h"
#include "suite.h"

static enum gz_result lent_make_current(struct gz_gl_context *base)
{
	struct lent_context *lent = (struct lent_context *)base;
	return lent->lost ? GZ_ERR_NO_DEVICE : lent->egl->ops->make_current(lent->egl);
}

static void lent_release(struct gz_gl_context *base)
{
	struct lent_context *lent = (struct lent_context *)base;
	lent->egl->ops->release(lent->egl);
}

struct lent_context lend_context(void)
{
	static const struct gz_gl_context_ops ops = { .make_current = lent_make_current,
						      .release = lent_release };
	struct lent_context lent = { .base = { .ops = &ops } };
	char reason[200];
	assert_int_equal(gz_gl_context_egl(false, &lent.egl, reason, sizeof reason), GZ_OK);
	return lent;
}
