#include "view/experiment/answer_keys.h"

#include <stddef.h>
#include <string.h>

int gz_answer_key_of(const char *name)
{
	static const struct {
		const char *name;
		int key;
	} named[] = {
		{ "left", GZ_KEY_LEFT }, { "right", GZ_KEY_RIGHT }, { "up", GZ_KEY_UP },
		{ "down", GZ_KEY_DOWN }, { "space", GZ_KEY_SPACE }, { "return", GZ_KEY_RETURN },
	};
	for (size_t i = 0; i < sizeof named / sizeof named[0]; i++)
		if (strcmp(name, named[i].name) == 0)
			return named[i].key;
	char key = name[0];
	if (key == '\0' || name[1] != '\0')
		return GZ_KEY_NONE;
	return (key >= 'a' && key <= 'z') || (key >= '0' && key <= '9') ? key : GZ_KEY_NONE;
}
