/**
 * @file
 * An experiment: blocks of trials. A trial shows a scene in one or two intervals, asks a question
 * and takes a key as the answer. An experiment is read from an INI file (its keys:
 * docs/experiments.md); all errors are reported before anything is shown.
 *
 * Settings of a trial may be given in [experiment], [block …] and [trial …]; the later of these
 * sections overrides the earlier. The prefix "a." or "b." limits a setting to that alternative. A
 * trial in a block, with all settings that apply there, is a condition.
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

/* Chosen: more than anyone sits through, less than a mistyped number asks for. */
#define GZ_EXPERIMENT_SECTIONS_MAX 256   /**< trials, and also blocks */
#define GZ_EXPERIMENT_TRIALS_MAX   10000 /**< presentations in total */
#define GZ_EXPERIMENT_SETTINGS_MAX 64    /**< scene keys of one alternative */
#define GZ_EXPERIMENT_ANSWERS_MAX  10    /**< keys of one question */
#define GZ_EXPERIMENT_TEXT_SIZE    4096  /**< of a text to show, with its NUL, bytes */
#define GZ_EXPERIMENT_LABEL_SIZE   50 /**< of the name of a trial or block, with its NUL, bytes */

/** What a key stands for. */
enum gz_experiment_asks {
	GZ_ASKS_AUTO,     /**< INTERVAL if there are two intervals, otherwise ANSWER */
	GZ_ASKS_INTERVAL, /**< the first key stands for the first interval, the second for the
			     second */
	GZ_ASKS_ANSWER,   /**< each key stands for its answer */
};

/** Order of the two alternatives. */
enum gz_experiment_interval_order {
	GZ_INTERVALS_BALANCED, /**< each order in half of a condition's repeats, drawn at random */
	GZ_INTERVALS_RANDOM,   /**< drawn for each presentation */
	GZ_INTERVALS_AB,
	GZ_INTERVALS_BA,
};

/** Order of the trials in a block. */
enum gz_experiment_order {
	GZ_ORDER_RANDOM, /**< random; each condition comes once before any comes again */
	GZ_ORDER_FULL,   /**< random over all repeats */
	GZ_ORDER_LISTED,
};

/** Order of the blocks. Practice blocks keep their places. */
enum gz_experiment_block_order {
	GZ_BLOCKS_LISTED,
	GZ_BLOCKS_RANDOM,
	GZ_BLOCKS_ROTATED, /**< participant n starts with block n: a Latin square */
};

/** Which values of a staircase's setting are answered right more often. */
enum gz_experiment_easier { GZ_EASIER_GREATER, GZ_EASIER_SMALLER };

/** Whether gaze is required. */
enum gz_experiment_gaze { GZ_GAZE_OPTIONAL, GZ_GAZE_REQUIRED };

/** Settings of a trial; docs/experiments.md explains them. */
struct gz_trial_params {
	char scene[GZ_INI_LINE_SIZE]; /**< as written in the file */
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
	char staircase[GZ_INI_LINE_SIZE]; /**< scene key that varies; empty: no staircase */
	double staircase_range[2];
	double staircase_start; /**< 0: the middle of the range */
	double staircase_sd;    /**< decades */
	int staircase_easier;   /**< enum gz_experiment_easier */
	double staircase_beta, staircase_delta, staircase_gamma, staircase_target;
	double staircase_stop_sd; /**< decades; 0: never */
};

/** Table over struct gz_trial_params; its keys have no section. */
extern const struct gz_option gz_trial_options[];
extern const size_t gz_trial_option_count;

/** Settings of a block. */
struct gz_block_params {
	char trials[GZ_INI_LINE_SIZE]; /**< names; * matches any part of a name */
	int repeats;
	int order; /**< enum gz_experiment_order */
	bool practice;
	int break_every; /**< trials between breaks; 0: no breaks */
	char break_text[GZ_INI_LINE_SIZE];
	char instructions[GZ_INI_LINE_SIZE];
	char instructions_file[GZ_INI_LINE_SIZE];
};

/** Table over struct gz_block_params; its keys have no section. */
extern const struct gz_option gz_block_options[];
extern const size_t gz_block_option_count;

/** Settings of the whole experiment. */
struct gz_experiment_params {
	char name[GZ_EXPERIMENT_LABEL_SIZE]; /**< letters and digits, like a BIDS task label */
	int seed;
	int block_order; /**< enum gz_experiment_block_order */
	int gaze;        /**< enum gz_experiment_gaze */
	/** GZ_GAZE_REQUIRED: longest time without gaze in an interval, s; 0: any */
	double gaze_lost_s;
	char instructions[GZ_INI_LINE_SIZE];
	char instructions_file[GZ_INI_LINE_SIZE];
	char goodbye[GZ_INI_LINE_SIZE];
	bool buttons;        /**< show buttons for the mouse */
	double ground[3];    /**< background between pictures: red, green, blue, 0 to 1 */
	double text_size;    /**< height of a line of text, as a fraction of the picture's */
	double fixation_deg; /**< width of the cross */
};

/** Table over struct gz_experiment_params; its keys have no section. */
extern const struct gz_option gz_experiment_options[];
extern const size_t gz_experiment_option_count;

/** A setting in the file. */
struct gz_experiment_setting {
	int alternative; /**< 0 a, 1 b; -1: both */
	bool of_scene;   /**< a scene key, otherwise one of struct gz_trial_params */
	bool own;        /**< belongs to the section itself and was read already */
	char key[GZ_INI_LINE_SIZE];
	char value[GZ_INI_LINE_SIZE];
	int line;
};

/** One of the two alternatives of a condition. */
struct gz_alternative {
	char scene[GZ_PATH_SIZE]; /**< path to open */
	/** Scene keys that override the scene's own. Point into the experiment's sections. */
	const struct gz_experiment_setting *settings[GZ_EXPERIMENT_SETTINGS_MAX];
	size_t setting_count;
	int method; /**< enum gz_method with these keys; set by gz_experiment_check() */
};

/** A key and its answer. */
struct gz_answer {
	int key; /**< enum gz_answer_key, letter or digit */
	char key_name[GZ_EXPERIMENT_LABEL_SIZE];
	char name[GZ_EXPERIMENT_LABEL_SIZE];
};

struct gz_staircase;

/** A trial in a block. */
struct gz_condition {
	char label[GZ_EXPERIMENT_LABEL_SIZE]; /**< of the trial */
	int line;                             /**< of its section */
	struct gz_trial_params params;
	struct gz_alternative alternatives[2]; /**< a, b; b only with two intervals */
	struct gz_answer answers[GZ_EXPERIMENT_ANSWERS_MAX];
	size_t answer_count;
	/** The correct alternative (asks INTERVAL) or answer (asks ANSWER); -1: none. */
	int correct;
	/** What varies from trial to trial: staircase.h. NULL: nothing. A run changes it. */
	struct gz_staircase *staircase;
};

/** A group of trials. */
struct gz_block {
	char label[GZ_EXPERIMENT_LABEL_SIZE];
	int line; /**< of its section; 0: the file has no blocks, and all trials make one */
	struct gz_block_params params;
	char *instructions; /**< text to show; NULL: none */
	struct gz_condition *conditions;
	size_t condition_count;
};

/** A section of the file with its settings. */
struct gz_experiment_section {
	char label[GZ_EXPERIMENT_LABEL_SIZE];
	int line;
	struct gz_experiment_setting *settings;
	size_t setting_count, setting_room;
};

/** An experiment. In its texts, "\n" of the file has become a line break. */
struct gz_experiment {
	char path[GZ_PATH_SIZE];
	uint64_t fingerprint; /**< hash of everything that was read, texts included */
	struct gz_experiment_params params;
	char *instructions; /**< text to show; NULL: none */
	struct gz_block *blocks;
	size_t block_count;
	struct gz_experiment_section common;
	struct gz_experiment_section *trials;
	size_t trial_count;
	struct gz_experiment_section *sections; /**< of the blocks, if the file has any */
	size_t section_count;
};

/**
 * Read an experiment from memory. Of the files it names, only texts are read.
 *
 * @param path  of the experiment's file, for messages and relative names
 * @param[out] out_experiment  the caller frees it with gz_experiment_free()
 * @retval GZ_ERR_FORMAT     invalid; logged with file, line and what is allowed
 * @retval GZ_ERR_NOT_FOUND  a text file does not exist; logged
 * @retval GZ_ERR_IO         a text file cannot be read; logged
 * @retval GZ_ERR_NO_MEM     out of memory
 */
enum gz_result gz_experiment_parse(const char *path, const char *text, size_t size,
				   const struct gz_log *log, struct gz_experiment *out_experiment);

/** Read an experiment from the file @p path. Results as for gz_experiment_parse();
 * GZ_ERR_NOT_FOUND also if the file itself does not exist. */
enum gz_result gz_experiment_load(const char *path, const struct gz_log *log,
				  struct gz_experiment *out_experiment);

/**
 * Check that all scenes, transfer functions, tables and volumes that the experiment names exist and
 * are valid (except voxels), and that the settings of each alternative are consistent. Sets each
 * alternative's method.
 *
 * @retval GZ_ERR_NOT_FOUND, GZ_ERR_FORMAT, GZ_ERR_IO, GZ_ERR_NO_MEM  logged with the line of the
 *         experiment
 */
enum gz_result gz_experiment_check(struct gz_experiment *experiment, const struct gz_log *log);

/**
 * Override a scene's settings by the alternative's keys. Does not load the spacing table:
 * gz_scene_load_table() does.
 *
 * @param settings  of the scene that @p alternative names
 * @return GZ_OK; GZ_ERR_INVAL cannot occur after gz_experiment_parse()
 */
enum gz_result gz_alternative_apply(const struct gz_alternative *alternative,
				    struct gz_scene_settings *settings);

/** Print the alternative's keys as "key=value", separated by blanks. Cut to @p size bytes. */
void gz_alternative_print(const struct gz_alternative *alternative, char *text, size_t size);

/** Free the contents and zero @p experiment. */
void gz_experiment_free(struct gz_experiment *experiment);

/** A key: the lower-case letter or digit itself, or one of these. */
enum gz_answer_key {
	GZ_KEY_NONE = 0,
	GZ_KEY_SPACE = ' ',
	GZ_KEY_LEFT = 256,
	GZ_KEY_RIGHT,
	GZ_KEY_UP,
	GZ_KEY_DOWN,
	GZ_KEY_RETURN,
	GZ_KEY_ESCAPE, /**< leaves the experiment; is not an answer */
};

/** The key with a name: "a" to "z", "0" to "9", "left", "right", "up", "down", "space" or "return";
 * otherwise GZ_KEY_NONE. */
int gz_answer_key_of(const char *name);

#endif
