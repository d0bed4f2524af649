/**
 * @file
 * What the window calls a scene key: "field of view, degrees" for "camera.fov_deg".
 */
#ifndef GZ_VIEW_SETTINGS_SETTING_LABEL_H
#define GZ_VIEW_SETTINGS_SETTING_LABEL_H

#include <stddef.h>

#include "base/option.h"

/** Size of a label with its NUL, bytes. */
enum { GZ_SETTING_LABEL_SIZE = 64 };

/** Print the name of a setting with its unit, without its section. */
void gz_setting_label(const struct gz_option *option, char out_text[GZ_SETTING_LABEL_SIZE]);

/** Print the name of a setting without its unit and its section: "field of view". */
void gz_setting_name(const struct gz_option *option, char out_text[GZ_SETTING_LABEL_SIZE]);

/** Print the name of a setting's section, which begins with a capital: "Camera". */
void gz_setting_section(const struct gz_option *option, char out_text[GZ_SETTING_LABEL_SIZE]);

/** Letters before the numbers of a setting, one each: "xyz" for a place or a direction; NULL: the
 *  numbers have none. */
const char *gz_setting_axes(const struct gz_option *option);

#endif
