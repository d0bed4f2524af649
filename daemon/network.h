/**
 * @file
 * Where the daemon's sockets are bound: each in the runtime directory, and at TCP where the
 * configuration says so. Whoever reaches TCP from another machine needs a key.
 */
#ifndef GZ_DAEMON_NETWORK_H
#define GZ_DAEMON_NETWORK_H

#include "base/log.h"
#include "base/result.h"
#include "daemon/config.h"
#include "daemon/guard.h"
#include "protocol/key.h"

/** How sockets are bound. Borrowed by those who bind, while they do. */
struct gz_network {
	const struct gz_config *config;
	const char *directory; /**< of local sockets */
	void *context;         /**< ZeroMQ */
	struct gz_guard *guard;
	struct gz_key_pair keys; /**< of tcp = curve */
	const struct gz_log *log;
};

/**
 * Read the daemon's key, where the configuration has tcp = curve, and open the guard.
 *
 * @param network  filled but for guard and keys; gz_network_close() it, also after a failure
 * @retval GZ_ERR_UNSUPPORTED  libzmq has no CURVE; logged
 * @retval GZ_ERR_NOT_FOUND    there is no key; logged with the remedy
 * @return else as gz_key_file_read() and gz_guard_create(); logged
 */
enum gz_result gz_network_open(struct gz_network *network);

/**
 * Watch @p socket, bind it as @p name in the runtime directory, and at TCP where there is.
 *
 * @param name      "stream", "latest", "control" or "inlet"
 * @param endpoint  at TCP
 * @param[out] out_port  the TCP port, 0 without TCP
 * @param[out] out_connections  as gz_guard_watch(); may be NULL
 * @retval GZ_ERR_BUSY  an endpoint is taken; logged with the remedy
 * @retval GZ_ERR_IO, GZ_ERR_FULL, GZ_ERR_INVAL  logged
 */
enum gz_result gz_network_bind(const struct gz_network *network, void *socket, const char *name,
			       const char *endpoint, int *out_port,
			       const struct gz_connections **out_connections);

/** "tcp://ADDRESS:PORT" of the configured address; a port of the system's choice where @p port is
 * 0.
 */
void gz_network_endpoint(const struct gz_network *network, int port, char text[GZ_ENDPOINT_SIZE]);

/** Close the guard and wipe the keys. */
void gz_network_close(struct gz_network *network);

#endif
