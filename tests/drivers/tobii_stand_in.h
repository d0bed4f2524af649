/* Controls for the fake Tobii Pro SDK (tobii_stand_in.c). */
#ifndef GZ_TESTS_DRIVERS_TOBII_STAND_IN_H
#define GZ_TESTS_DRIVERS_TOBII_STAND_IN_H

#include <stdatomic.h>
#include <stdint.h>

/* Name and type of the exported function that returns the controls. */
#define TOBII_STAND_IN_CONTROL "tobii_stand_in_control"

struct tobii_stand_in {
	int trackers;      /* trackers that are present, 0 to 2 */
	const char *fails; /* name of a function that fails, such as "get_address"; NULL for none */
	double rate_hz;    /* sample rate */
	int64_t system_zero_us; /* clock of the library - host clock */
	int64_t device_zero_us; /* clock of the tracker - host clock */
	int burst;              /* deliveries made at once on subscription */
	float display_mm[2];
	/* Reported by the library. */
	float frequency_set_hz;
	atomic_int subscriptions; /* active now */
	atomic_int strings;       /* returned and not freed */
	atomic_int lists;         /* returned and not freed */
	/* Requests to its thread, which resets them to 0 when done. */
	atomic_int lose_connection;
	atomic_int change_display; /* notify of another display area */
	atomic_int repeat_display; /* notify of the same display area */
	atomic_int step_clock_s;   /* let the clock of the tracker jump by this */
};

typedef struct tobii_stand_in *tobii_stand_in_control_function(void);

#endif
