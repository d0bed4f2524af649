/**
 * @file
 * An experiment: trials in blocks, each of one or two intervals that show a scene, a question and
 * the keys that answer it. Read from an INI file (docs/experiments.md has its keys), whole or not
 * at all: what is wrong with it is said before anything is shown.
 *
 * Settings of a trial may stand in [experiment], in a [block …] and in a [trial …]; the later of
 * these comes before the earlier, and "a." or "b." in front of one keeps it to that alternative. A
 * trial as it appears in a block, with all that holds for it there, is a condition.
 */
#ifndef GZ_VIEW_EXPERIMENT_EXPERIMENT_H
#define GZ_VIEW_EXPERIMENT_EXPERIMENT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/ini.h"
#include "base/log.h"
#include "base/option.h"
#include "base/result.h"
#include "render/scene/scene.h"

/* Limits chosen: beyond what somebody sits through, within what a mistyped number makes. */
#define GZ_EXPERIMENT_SECTIONS_MAX 256   /**< trials, and blocks */
#define GZ_EXPERIMENT_TRIALS_MAX   10000 /**< presentations in all */
#define GZ_EXPERIMENT_SETTINGS_MAX 64    /**< scene keys of one alternative */
#define GZ_EXPERIMENT_ANSWERS_MAX  10    /**< keys of one question */
#define GZ_EXPERIMENT_TEXT_SIZE    4096  /**< bytes of a text shown, with its NUL */
#define GZ_EXPERIMENT_LABEL_SIZE   50    /**< bytes of the name of a trial or block, with its NUL */

/** What a key answers. */
enum gz_experiment_asks {
	GZ_ASKS_AUTO,     /**< which interval where there are two, else an answer */
	GZ_ASKS_INTERVAL, /**< the first key means the first interval, the second the second */
	GZ_ASKS_ANSWER,   /**< each key stands for its answer */
};

/** In which order two alternatives are shown. */
enum gz_experiment_interval_order {
	GZ_INTERVALS_BALANCED, /**< of a condition's repeats, half each way, which is drawn */
	GZ_INTERVALS_RANDOM,   /**< drawn for each presentation */
	GZ_INTERVALS_AB,
	GZ_INTERVALS_BA,
};

/** In which order a block's trials come. */
enum gz_experiment_order {
	GZ_ORDER_RANDOM, /**< drawn; each condition comes once before any comes again */
	GZ_ORDER_FULL,   /**< drawn over all repeats */
	GZ_ORDER_LISTED,
};

/** In which order blocks come. Practice keeps its place. */
enum gz_experiment_block_order {
	GZ_BLOCKS_LISTED,
	GZ_BLOCKS_RANDOM,
	GZ_BLOCKS_ROTATED, /**< begins one further for each participant number: a Latin square */
};

/** Whether there must be gaze. */
enum gz_experiment_gaze { GZ_GAZE_OPTIONAL, GZ_GAZE_REQUIRED };

/** What holds for a trial. */
struct gz_trial_params {
	char scene[GZ_INI_LINE_SIZE]; /**< as written */
	int intervals;                /**< 1 or 2 */
	int interval_order;           /**< enum gz_experiment_interval_order */
	double fixation_s, duration_s, blank_s, pause_s;
	char question[GZ_INI_LINE_SIZE];
	int asks; /**< enum gz_experiment_asks; not AUTO in a condition */
	char keys[GZ_INI_LINE_SIZE];
	char answers[GZ_INI_LINE_SIZE];
	char correct[GZ_INI_LINE_SIZE];
	double timeout_s; /**< 0: none */
	bool feedback;
	double feedback_s;
	char feedback_correct[GZ_INI_LINE_SIZE];
	char feedback_wrong[GZ_INI_LINE_SIZE];
	char feedback_late[GZ_INI_LINE_SIZE];
};

/** Table over struct gz_trial_params; its keys have no section. */
extern const struct gz_option gz_trial_options[];
extern const size_t gz_trial_option_count;

/** What holds for a block. */
struct gz_block_params {
	char trials[GZ_INI_LINE_SIZE]; /**< names, with * for any part of one */
	int repeats;
	int order; /**< enum gz_experiment_order */
	bool practice;
	int break_every; /**< trials; 0: none */
	char break_text[GZ_INI_LINE_SIZE];
	char instructions[GZ_INI_LINE_SIZE];
	char instructions_file[GZ_INI_LINE_SIZE];
};

/** Table over struct gz_block_params; its keys have no section. */
extern const struct gz_option gz_block_options[];
extern const size_t gz_block_option_count;

/** What holds for the whole. */
struct gz_experiment_params {
	char name[GZ_EXPERIMENT_LABEL_SIZE]; /**< letters and digits, as BIDS has task labels */
	int seed;
	int block_order; /**< enum gz_experiment_block_order */
	int gaze;        /**< enum gz_experiment_gaze */
	char instructions[GZ_INI_LINE_SIZE];
	char instructions_file[GZ_INI_LINE_SIZE];
	char goodbye[GZ_INI_LINE_SIZE];
	double ground[3];    /**< red, green, blue between pictures, 0 to 1 */
	double text_size;    /**< of a line of text, share of the picture's height */
	double fixation_deg; /**< of the cross, across */
};

/** Table over struct gz_experiment_params; its keys have no section. */
extern const struct gz_option gz_experiment_options[];
extern const size_t gz_experiment_option_count;

/** One line of the file that sets something. */
struct gz_experiment_setting {
	int alternative; /**< 0 a, 1 b; -1: both */
	bool of_scene;   /**< a key of the scene, else of struct gz_trial_params */
	bool own;        /**< of the section itself; read already */
	char key[GZ_INI_LINE_SIZE];
	char value[GZ_INI_LINE_SIZE];
	int line;
};

/** One of a condition's two sides. */
struct gz_alternative {
	char scene[GZ_PATH_SIZE]; /**< path as the program opens it */
	/** Keys of the scene that take the place of its own; into the experiment's sections. */
	const struct gz_experiment_setting *settings[GZ_EXPERIMENT_SETTINGS_MAX];
	size_t setting_count;
	int method; /**< enum gz_method, of the scene with these; by gz_experiment_check() */
};

/** A key and what it stands for. */
struct gz_answer {
	int key; /**< enum gz_answer_key, letter or digit */
	char key_name[GZ_EXPERIMENT_LABEL_SIZE];
	char name[GZ_EXPERIMENT_LABEL_SIZE];
};

/** A trial in a block. */
struct gz_condition {
	char label[GZ_EXPERIMENT_LABEL_SIZE]; /**< of the trial */
	int line;                             /**< of its section */
	struct gz_trial_params params;
	struct gz_alternative alternatives[2]; /**< a, b; b only with two intervals */
	struct gz_answer answers[GZ_EXPERIMENT_ANSWERS_MAX];
	size_t answer_count;
	/** The alternative (asks INTERVAL) or the answer (asks ANSWER) that is right; -1: none. */
	int correct;
};

/** Trials that come together. */
struct gz_block {
	char label[GZ_EXPERIMENT_LABEL_SIZE];
	int line; /**< of its section; 0: none is in the file, all trials make one */
	struct gz_block_params params;
	char *instructions; /**< text to show; NULL: none */
	struct gz_condition *conditions;
	size_t condition_count;
};

/** Where settings stand in the file. */
struct gz_experiment_section {
	char label[GZ_EXPERIMENT_LABEL_SIZE];
	int line;
	struct gz_experiment_setting *settings;
	size_t setting_count, setting_room;
};

/** An experiment, read. Texts hold line breaks where the file has \n. */
struct gz_experiment {
	char path[GZ_PATH_SIZE];
	uint64_t fingerprint; /**< of all that was read: texts, too */
	struct gz_experiment_params params;
	char *instructions; /**< text to show; NULL: none */
	struct gz_block *blocks;
	size_t block_count;
	struct gz_experiment_section common;
	struct gz_experiment_section *trials;
	size_t trial_count;
	struct gz_experiment_section *sections; /**< of blocks, where the file has any */
	size_t section_count;
};

/**
 * Read an experiment from text. Files are not looked at, but for texts that it names.
 *
 * @param path  of the file: for messages, and for what it names beside itself
 * @param[out] out_experiment  filled; the caller frees it with gz_experiment_free()
 * @retval GZ_ERR_FORMAT     refused; logged with file, line and what is allowed
 * @retval GZ_ERR_NOT_FOUND  a text that it names is not there; logged
 * @retval GZ_ERR_IO, GZ_ERR_NO_MEM  logged but for the last
 */
enum gz_result gz_experiment_parse(const char *path, const char *text, size_t size,
				   const struct gz_log *log, struct gz_experiment *out_experiment);

/** As gz_experiment_parse() over the file @p path. GZ_ERR_NOT_FOUND also where there is none. */
enum gz_result gz_experiment_load(const char *path, const struct gz_log *log,
				  struct gz_experiment *out_experiment);

/**
 * Check that every scene, transfer function, table and volume that the experiment names is there
 * and understood, voxels apart, and that each alternative's settings go together; note its method.
 *
 * @retval GZ_ERR_NOT_FOUND, GZ_ERR_FORMAT, GZ_ERR_IO, GZ_ERR_NO_MEM  logged with the line of the
 *         experiment
 */
enum gz_result gz_experiment_check(struct gz_experiment *experiment, const struct gz_log *log);

/**
 * Put an alternative's keys in the place of its scene's own.
 *
 * @param settings  of the scene that @p alternative names
 * @return GZ_OK; they were checked when they were read. The table of spacings is not read:
 *         gz_scene_load_table()
 */
enum gz_result gz_alternative_apply(const struct gz_alternative *alternative,
				    struct gz_scene_settings *settings);

/** The alternative's keys as "key=value" parted by blanks; cut where @p size is too small. */
void gz_alternative_print(const struct gz_alternative *alternative, char *text, size_t size);

/** Free what it holds and zero it. */
void gz_experiment_free(struct gz_experiment *experiment);

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
