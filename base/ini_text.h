/**
 * @file
 * Setting keys in an INI text and leaving all else as its author wrote it. The text is one that
 * gz_options_read_text() takes.
 */
#ifndef GZ_BASE_INI_TEXT_H
#define GZ_BASE_INI_TEXT_H

#include <stdbool.h>

#include "base/text.h"

/**
 * Set one key of an INI text: its value where it is given, else a line at the end of its section,
 * else a section at the end. Comments, blanks and all other lines stay, byte for byte.
 *
 * @param section, name  of the key "section.name"
 * @param value          without a line's end
 */
void gz_ini_text_set(struct gz_text *text, const char *section, const char *name,
		     const char *value);

/** Remove the line that gives a key, with its comment. @return false: there is none */
bool gz_ini_text_remove(struct gz_text *text, const char *section, const char *name);

/** Whether a line gives the key. */
bool gz_ini_text_has(const struct gz_text *text, const char *section, const char *name);

#endif
