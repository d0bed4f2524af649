/* Controls for the fake liblsl (lsl_stand_in.c), and what it was told. */
#ifndef GZ_TESTS_DAEMON_LSL_STAND_IN_H
#define GZ_TESTS_DAEMON_LSL_STAND_IN_H

#include <pthread.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stdint.h>

/* Name and type of the exported function that returns the controls. */
#define LSL_STAND_IN_CONTROL "lsl_stand_in_control"

/* Names a file to which each event and, when a stream ends, its type and number of samples are
 * appended, for tests of the whole daemon. */
#define LSL_STAND_IN_FILE "LSL_STAND_IN_FILE"

enum { LSL_STAND_IN_OUTLETS = 8, LSL_STAND_IN_VALUES = 32 };

/* One sample that was pushed. */
struct lsl_stand_in_push {
	double time_s;
	double values[LSL_STAND_IN_VALUES];
	char text[128];
	int32_t pushthrough;
};

/* The description of a stream. */
struct lsl_stand_in_info {
	char name[128], type[32], source[512];
	int32_t channels, format;
	double rate_hz;
	char description[16384]; /* the elements as XML, without blanks */
	char open[256];          /* names of the elements that are not closed, each with a blank */
};

/* A stream. */
struct lsl_stand_in_outlet {
	struct lsl_stand_in_info info;
	int32_t max_buffered;
	bool open;
	int pushes; /* all; the first ones are kept */
	struct lsl_stand_in_push *kept;
};

enum { LSL_STAND_IN_KEPT = 16384 };

struct lsl_stand_in {
	double clock_s;          /* clock of the library - host clock, s */
	bool refuse;             /* create_outlet() fails */
	atomic_bool refuse_push; /* each push fails */
	atomic_bool busy;        /* while set, no push returns */
	atomic_int pushing;      /* pushes that have not returned */
	atomic_int consumers;    /* what have_consumers() returns */
	atomic_int descriptions; /* made and not freed */
	pthread_mutex_t mutex;   /* guards what follows */
	int outlet_count;        /* all, closed ones included */
	struct lsl_stand_in_outlet outlets[LSL_STAND_IN_OUTLETS];
};

typedef struct lsl_stand_in *lsl_stand_in_control_function(void);

#endif
