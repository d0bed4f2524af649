/**
 * @file
 * The effects that techniques are compared with: reflection, shadow, both and glass, as settings of
 * a scene. A technique takes those of its own keys.
 */
#ifndef GZ_BENCH_COMPARISON_EFFECTS_H
#define GZ_BENCH_COMPARISON_EFFECTS_H

#include <stdbool.h>
#include <stddef.h>

#include "base/result.h"
#include "render/technique/technique.h"

/** Effects. Each is one row of gz_effects[]. */
#define GZ_EFFECT_COUNT 5

/** Most settings of an effect. */
#define GZ_EFFECT_SETTINGS_MAX 8

/** One effect. */
struct gz_effect {
	const char *name;  /**< in files: "none", "reflection", "shadow", "both", "glass" */
	const char *words; /**< in tables */
	const char *needs; /**< key of techniques that have the effect; NULL: any of its keys */
	/** Keys of a scene and their values; key NULL behind the last. */
	struct {
		const char *key, *value;
	} settings[GZ_EFFECT_SETTINGS_MAX + 1];
};

/** The effects; the first is none. */
extern const struct gz_effect gz_effects[GZ_EFFECT_COUNT];

/** Whether a technique has an option of this key, such as "slices.count". */
bool gz_technique_has_key(const struct gz_technique *technique, const char *key);

/**
 * Set an option of a technique. Options that it does not have are left alone.
 *
 * @param settings  the struct that the technique's options describe
 * @retval GZ_ERR_INVAL  the value is out of range
 */
enum gz_result gz_technique_set(const struct gz_technique *technique, void *settings,
				const char *key, const char *value);

/** Apply an effect to a technique's settings. GZ_ERR_INVAL: a value is out of range. */
enum gz_result gz_effect_apply(const struct gz_effect *effect, const struct gz_technique *technique,
			       void *settings);

#endif
