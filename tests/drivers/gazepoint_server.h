/* Plays Gazepoint Control on a port of 127.0.0.1: answers what it is asked and sends records. */
#ifndef GZ_TESTS_DRIVERS_GAZEPOINT_SERVER_H
#define GZ_TESTS_DRIVERS_GAZEPOINT_SERVER_H

#include <pthread.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stddef.h>

/* What it does once it is told to send data. */
struct gazepoint_play {
	const char *script;    /* sent first, as it is; NULL for nothing */
	size_t script_size;    /* 0: the script is a string */
	size_t chunk;          /* bytes sent at a time; 0: all at once */
	bool stream;           /* then a record every 2 ms */
	bool hang_up;          /* or close the connection */
	const char *refuses;   /* answers NACK where a command holds this; NULL for none */
	const char *frequency; /* what it says of its clock; NULL for 10 MHz */
	bool mute;             /* never answers, never sends */
};

struct gazepoint_server {
	struct gazepoint_play play;
	int listen_fd;
	int port;
	pthread_t thread;
	atomic_bool quit;
	atomic_int connections; /* accepted so far */
};

/* @param port  0 for one that is free. Fails the test where it cannot listen. */
void gazepoint_server_start(struct gazepoint_server *server, const struct gazepoint_play *play,
			    int port);

/* Closes all that is open; the port may be listened at again. */
void gazepoint_server_stop(struct gazepoint_server *server);

#endif
