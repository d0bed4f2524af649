/* What a test tells the library that plays the Tobii Pro SDK; tobii_stand_in.c. */
#ifndef GZ_TESTS_DRIVERS_TOBII_STAND_IN_H
#define GZ_TESTS_DRIVERS_TOBII_STAND_IN_H

#include <stdatomic.h>
#include <stdint.h>

/* The exported function's name, and its type. */
#define TOBII_STAND_IN_CONTROL "tobii_stand_in_control"

struct tobii_stand_in {
	int trackers;           /* that are there, 0 to 2 */
	const char *fails;      /* name of a function that fails, as "get_address"; NULL for none */
	double rate_hz;         /* of the data */
	int64_t system_zero_us; /* added to the host's clock to make the library's */
	int64_t device_zero_us; /* likewise the tracker's */
	int burst;              /* deliveries made at once when it is subscribed to */
	float display_mm[2];
	/* Told by the library. */
	float frequency_set_hz;
	atomic_int subscriptions; /* now */
	atomic_int strings;       /* given out and not freed */
	atomic_int lists;         /* likewise */
	/* Asked of its thread; it sets them to 0 once done. */
	atomic_int lose_connection;
	atomic_int change_display; /* tells of another display area */
	atomic_int repeat_display; /* tells of the same one */
	atomic_int step_clock_s;   /* the tracker's clock leaps by so much */
};

typedef struct tobii_stand_in *tobii_stand_in_control_function(void);

#endif
