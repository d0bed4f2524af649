/**
 * @file
 * The keys that answer a trial, by the names that an experiment's file gives them.
 */
#ifndef GZ_VIEW_EXPERIMENT_ANSWER_KEYS_H
#define GZ_VIEW_EXPERIMENT_ANSWER_KEYS_H

/** A key: the small letter or the digit itself, or one of these. */
enum gz_answer_key {
	GZ_KEY_NONE = 0,
	GZ_KEY_SPACE = ' ',
	GZ_KEY_LEFT = 256,
	GZ_KEY_RIGHT,
	GZ_KEY_UP,
	GZ_KEY_DOWN,
	GZ_KEY_RETURN,
	GZ_KEY_ESCAPE, /**< leaves; answers nothing */
};

/** The key named @p name: "a" to "z", "0" to "9", "left", "right", "up", "down", "space" or
 *  "return"; GZ_KEY_NONE for anything else. */
int gz_answer_key_of(const char *name);

#endif
