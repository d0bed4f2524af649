#include "drivers/tobii/tobii_sample.h"

#include <math.h>

#include "base/clock.h"

bool gz_tobii_time_read(struct gz_tobii_time *time, int64_t before_ns, int64_t system_us,
			int64_t after_ns)
{
	int64_t system_ns, offset_ns;
	int64_t middle_ns = before_ns + (after_ns - before_ns) / 2;
	if (__builtin_mul_overflow(system_us, GZ_NS_PER_US, &system_ns) ||
	    __builtin_sub_overflow(middle_ns, system_ns, &offset_ns))
		return false;
	*time = (struct gz_tobii_time) {
		.known = true,
		.offset_ns = offset_ns,
		.error_ns = (after_ns - before_ns) / 2 + GZ_NS_PER_US,
	};
	return true;
}

int64_t gz_tobii_time_of(const struct gz_tobii_time *time, int64_t system_us, int64_t arrival_ns)
{
	int64_t system_ns, taken_ns, age_ns;
	if (!time->known || __builtin_mul_overflow(system_us, GZ_NS_PER_US, &system_ns) ||
	    __builtin_add_overflow(system_ns, time->offset_ns, &taken_ns) ||
	    __builtin_sub_overflow(arrival_ns, taken_ns, &age_ns))
		return arrival_ns;
	if (age_ns > GZ_TOBII_AGE_MAX_NS || age_ns < -GZ_TOBII_EARLY_MAX_NS - time->error_ns)
		return arrival_ns;
	return age_ns < 0 ? arrival_ns : taken_ns;
}

int64_t gz_tobii_device_ns(int64_t device_us)
{
	int64_t ns;
	return __builtin_mul_overflow(device_us, GZ_NS_PER_US, &ns) ? GZ_NO_DEVICE_TIME : ns;
}

/* From the eye to what it looks at; NaN where they are the same place. */
static void direction(const float from_mm[3], const float to_mm[3], float out_direction[3])
{
	double step[3], length = 0;
	for (int i = 0; i < 3; i++) {
		step[i] = (double)to_mm[i] - (double)from_mm[i];
		length += step[i] * step[i];
	}
	length = sqrt(length);
	for (int i = 0; i < 3 && length > 0 && isfinite(length); i++)
		out_direction[i] = (float)(step[i] / length);
}

static void take_eye(const struct gz_tobii_eye *eye, struct gz_eye_sample *out_eye)
{
	bool has_point = eye->point.validity == GZ_TOBII_VALID;
	bool has_origin = eye->origin.validity == GZ_TOBII_VALID;
	out_eye->point = (struct gz_point) { eye->point.on_display[0], eye->point.on_display[1] };
	out_eye->valid = has_point;
	if (eye->pupil.validity == GZ_TOBII_VALID)
		out_eye->pupil_mm = eye->pupil.diameter_mm;
	for (int i = 0; i < 3 && has_origin; i++)
		out_eye->origin_mm[i] = eye->origin.user_mm[i];
	if (has_point && has_origin)
		direction(eye->origin.user_mm, eye->point.user_mm, out_eye->direction);
}

struct gz_sample gz_tobii_sample(const struct gz_tobii_gaze *gaze)
{
	struct gz_sample sample = gz_sample_unmeasured();
	take_eye(&gaze->right, &sample.eye[GZ_EYE_RIGHT]);
	take_eye(&gaze->left, &sample.eye[GZ_EYE_LEFT]);
	return sample;
}
