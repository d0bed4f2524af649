/**
 * @file
 * Undo and redo for settings. A step holds the keys that changed, with their values as text, so
 * that a hundred steps are small. Steps of something else, such as the transfer function, take
 * their place among them.
 */
#ifndef GZ_VIEW_SETTINGS_SETTING_HISTORY_H
#define GZ_VIEW_SETTINGS_SETTING_HISTORY_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/result.h"
#include "render/scene/scene.h"
#include "view/settings/setting_label.h"

/** Most steps that are kept. Chosen: as many as of the transfer function. */
#define GZ_SETTING_HISTORY_STEPS 100

/** Changes of the camera within this time are one step: notches of a wheel, a key that repeats.
 *  Chosen: slower ones are meant one by one. */
#define GZ_SETTING_HISTORY_MERGE_NS (700 * INT64_C(1000000))

/** Size of the name of a step with its NUL, bytes. */
#define GZ_SETTING_STEP_SIZE (2 * GZ_SETTING_LABEL_SIZE + 2)

/** The steps of one set of settings. */
struct gz_setting_history;

/** What an undo or a redo did. */
enum gz_history_outcome {
	GZ_HISTORY_NOTHING, /**< there was no step */
	GZ_HISTORY_SETTING, /**< settings have other values */
	GZ_HISTORY_FOREIGN, /**< the step is the caller's to take */
};

/**
 * Watch settings.
 *
 * @param settings  borrowed; outlives the history
 * @param[out] out_history  owned by the caller: gz_setting_history_destroy()
 * @retval GZ_ERR_NO_MEM  not logged
 */
enum gz_result gz_setting_history_create(struct gz_scene_settings *settings,
					 struct gz_setting_history **out_history);

/** Free and set to NULL. Accepts a pointer to NULL. */
void gz_setting_history_destroy(struct gz_setting_history **history);

/** Forget all steps: what the settings are now is where undo ends. */
void gz_setting_history_restart(struct gz_setting_history *history);

/** Note what has changed since the last note as one step, or as part of the last one. What was
 *  undone can no longer be redone then. @return whether anything has changed */
bool gz_setting_history_note(struct gz_setting_history *history, int64_t now_ns);

/** Take over what has changed since the last note, which is no step: a scene that was saved names
 *  its files in another way. */
void gz_setting_history_adopt(struct gz_setting_history *history);

/** Add a foreign step. */
void gz_setting_history_mark(struct gz_setting_history *history);

/** Drop the last foreign step that can be undone: it was undone in another way. */
void gz_setting_history_unmark(struct gz_setting_history *history);

/** Whether there is a step to undo. */
bool gz_setting_history_can_undo(const struct gz_setting_history *history);

/** Whether there is a step to redo. */
bool gz_setting_history_can_redo(const struct gz_setting_history *history);

/** Undo the last step. @param[out] out_name  what it was about, without its unit: "Light, ambient
 *  share"; set for GZ_HISTORY_SETTING */
enum gz_history_outcome gz_setting_history_undo(struct gz_setting_history *history,
						char out_name[GZ_SETTING_STEP_SIZE]);

/** Redo the last step that was undone; as gz_setting_history_undo(). */
enum gz_history_outcome gz_setting_history_redo(struct gz_setting_history *history,
						char out_name[GZ_SETTING_STEP_SIZE]);

#endif
