#include "render/attention/attention.h"

#define AT(field) offsetof(struct gz_attention_params, field)

const struct gz_option gz_attention_options[] = {
	{ "attention.dead_band_deg", GZ_OPTION_DOUBLE, AT(dead_band_deg), 0, 10, .preset = "0.5",
	  .help = "how far a tracker's gaze may move within a fixation without moving the plan, "
		  "degrees" },
	{ "attention.dead_band_noise", GZ_OPTION_DOUBLE, AT(dead_band_noise), 0, 10, .preset = "2",
	  .help = "at least so many times the tracker's noise, up to 1.5 degrees" },
	{ "attention.saccade_scale", GZ_OPTION_DOUBLE, AT(saccade_scale), 1, GZ_BUDGET_SCALE_MAX,
	  .preset = "2", .help = "how much coarser the plan is in a saccade; 1 = not" },
	{ "attention.blink_ms", GZ_OPTION_DOUBLE, AT(blink_ms), 0, 10000, .preset = "500",
	  .help = "longest blink, and oldest gaze that counts, ms" },
	{ "attention.hold_ms", GZ_OPTION_DOUBLE, AT(hold_ms), 0, 1e6, .preset = "150",
	  .help = "how long the plan stays where the gaze was lost, ms" },
	{ "attention.widen_ms", GZ_OPTION_DOUBLE, AT(widen_ms), 0, 1e6, .preset = "500",
	  .help = "how long it then takes to become even, ms; 0 = it stays" },
	{ "attention.budget_ms", GZ_OPTION_DOUBLE, AT(budget_ms), 0, 10000, .preset = "0",
	  .help = "what 95 of 100 frames may take, ms: the plan is as coarse as that needs; "
		  "0 = no limit" },
};
const size_t gz_attention_option_count =
	sizeof gz_attention_options / sizeof gz_attention_options[0];

struct gz_attention_params gz_attention_default(void)
{
	struct gz_attention_params params = { 0 };
	const struct gz_option_binding binding = {
		.options = gz_attention_options,
		.count = gz_attention_option_count,
		.target = &params,
	};
	gz_options_preset(&binding);
	return params;
}
