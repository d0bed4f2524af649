/**
 * @file
 * What opening and saving ask and show: the dialogs for opening a file, for the layout of a raw
 * volume and for saving a scene, and the progress of loading. Inside a frame of panels/widgets.h. A
 * zero-initialised dialog is closed.
 */
#ifndef GZ_VIEW_PANELS_FILE_DIALOGS_H
#define GZ_VIEW_PANELS_FILE_DIALOGS_H

#include <stdbool.h>
#include <stddef.h>

#include "protocol/gaze.h"
#include "render/data/raw_guess.h"
#include "view/files/folder.h"
#include "view/files/recent.h"

/** Size of a dialog's message with its NUL, bytes. */
enum { GZ_PANEL_MESSAGE_SIZE = 256 };

/** The dialog that opens something: a folder's entries, recent files, and a field for a path. */
struct gz_open_panel {
	bool open;
	struct gz_folder folder;
	struct gz_folder_filter filter;
	const struct gz_recent *recent;      /**< borrowed */
	char typed[GZ_PATH_SIZE];            /**< a path, or the beginning of a name in the list */
	char message[GZ_PANEL_MESSAGE_SIZE]; /**< what went wrong; empty: nothing */
	bool focus_wanted;                   /**< the field gets the keyboard in the next frame */
};

/** Open the dialog on a folder; if it cannot be read, on the home folder or "/". */
void gz_open_panel_show(struct gz_open_panel *panel, const char *folder,
			const struct gz_recent *recent);

/**
 * Draw the dialog, if it is open.
 *
 * @param[out] out_path  absolute path of a file, or of a folder that holds a volume
 * @return whether something was chosen. The caller then closes the dialog, or writes into
 *         panel->message why it cannot be opened
 */
bool gz_open_panel_draw(struct gz_open_panel *panel, char out_path[GZ_PATH_SIZE]);

/** Close the dialog, and free its folder. */
void gz_open_panel_close(struct gz_open_panel *panel);

/** The dialog that asks for the layout of a volume without a header. */
struct gz_raw_panel {
	bool open;
	char path[GZ_PATH_SIZE];
	uint64_t bytes; /**< size of the file's voxels; 0: not known */
	struct gz_raw_guess guesses[GZ_RAW_GUESSES_MAX];
	size_t count;
	struct gz_raw_layout layout; /**< as in the fields */
	char warning[192];           /**< the name contradicts the size; empty: it does not */
};

/** Open the dialog for a file, with the best guess in the fields. */
void gz_raw_panel_show(struct gz_raw_panel *panel, const char *path);

/** Draw the dialog, if it is open. @return whether panel->layout was confirmed; the dialog is then
 *  closed. The layout has the file's size, unless that is not known */
bool gz_raw_panel_draw(struct gz_raw_panel *panel);

/** What a dialog that saves says. Static texts. */
struct gz_save_words {
	const char *title; /**< of the dialog; unique among panels */
	const char *what;  /**< one line: what is saved */
	const char *verb;  /**< on the button that does it */
};

/** The dialog that asks where something is saved. */
struct gz_save_panel {
	bool open;
	const struct gz_save_words *words;    /**< borrowed */
	char path[GZ_PATH_SIZE];              /**< as typed */
	char asked[GZ_PATH_SIZE];             /**< path that the question is about */
	char question[GZ_PANEL_MESSAGE_SIZE]; /**< to be confirmed before saving; empty: none */
	char message[GZ_PANEL_MESSAGE_SIZE];  /**< what went wrong; empty: nothing */
	bool focus_wanted;                    /**< the field gets the keyboard in the next frame */
};

/** Open the dialog with a suggested path. @param words  borrowed until it is closed */
void gz_save_panel_show(struct gz_save_panel *panel, const struct gz_save_words *words,
			const char *path);

/** Ask a question before saving to the path in the field. It is confirmed by the next
 *  gz_save_panel_draw() that returns true, if the path is still the same. */
void gz_save_panel_ask(struct gz_save_panel *panel, const char *question);

/**
 * Draw the dialog, if it is open.
 *
 * @param[out] out_sure  the question for this path was confirmed
 * @return whether to save to panel->path. The caller then closes the dialog, asks a question, or
 *         writes into panel->message why it cannot save
 */
bool gz_save_panel_draw(struct gz_save_panel *panel, bool *out_sure);

/**
 * Draw the progress of long work in the middle, with a button that cancels it.
 *
 * @param title    what is done
 * @param what     the file or thing that it is done to
 * @param share    share done, 0 to 1; below 0: not known
 * @param spent_s  seconds since it began
 * @return whether to cancel it
 */
bool gz_progress_panel_draw(const char *title, const char *what, double share, double spent_s);

/** Print "40 %, 3 s left", without the time where it cannot be told yet; nothing for a @p share
 *  below 0. */
void gz_progress_text(double share, double spent_s, char *text, size_t size);

#endif
