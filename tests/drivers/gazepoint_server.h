/* A fake Gazepoint Control on a port of 127.0.0.1: answers requests and sends records. */
#ifndef GZ_TESTS_DRIVERS_GAZEPOINT_SERVER_H
#define GZ_TESTS_DRIVERS_GAZEPOINT_SERVER_H

#include <pthread.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stddef.h>

/* What it does after it has been told to send data. */
struct gazepoint_play {
	const char *script;    /* sent first, unchanged; NULL for none */
	size_t script_size;    /* 0: the script is a string */
	size_t chunk;          /* bytes for each send(); 0: all at once */
	bool stream;           /* then send a record every 2 ms */
	bool hang_up;          /* then close the connection */
	const char *refuses;   /* answer NACK to commands that contain this; NULL for none */
	const char *frequency; /* its FREQ; NULL for 10 MHz */
	bool mute;             /* never answer, never send */
};

struct gazepoint_server {
	struct gazepoint_play play;
	int listen_fd;
	int port;
	pthread_t thread;
	atomic_bool quit;
	atomic_int connections; /* connections accepted so far */
};

/* Start. @param port  0 for any free one. Fails the test if it cannot listen. */
void gazepoint_server_start(struct gazepoint_server *server, const struct gazepoint_play *play,
			    int port);

/* Close all connections; the port may be used again. */
void gazepoint_server_stop(struct gazepoint_server *server);

#endif
