#include "view/window/context_loss.h"

#include <GL/glew.h>

#include <GLFW/glfw3.h>

/* How long a reset is waited for, and how often it is asked about, s. */
#define RESET_S    2.0
#define INTERVAL_S 0.05

void gz_context_loss_hint(void)
{
	glfwWindowHint(GLFW_CONTEXT_ROBUSTNESS, GLFW_LOSE_CONTEXT_ON_RESET);
}

bool gz_context_is_lost(void)
{
	if (!GLEW_ARB_robustness || !glGetGraphicsResetStatusARB)
		return false;
	/* The status may be told but once; a lost context has the error for ever. */
	return glGetGraphicsResetStatusARB() != GL_NO_ERROR || glGetError() == GL_CONTEXT_LOST;
}

void gz_context_await_reset(void)
{
	const double end = glfwGetTime() + RESET_S;
	if (!GLEW_ARB_robustness || !glGetGraphicsResetStatusARB)
		return;
	while (glGetGraphicsResetStatusARB() != GL_NO_ERROR && glfwGetTime() < end)
		glfwWaitEventsTimeout(INTERVAL_S);
}
