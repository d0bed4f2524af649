/**
 * @file
 * Binding the daemon's sockets: each in the runtime directory, and over TCP too if the
 * configuration allows it. Clients on other machines need a key.
 */
#ifndef GZ_DAEMON_NETWORK_H
#define GZ_DAEMON_NETWORK_H

#include "base/log.h"
#include "base/result.h"
#include "daemon/config.h"
#include "daemon/guard.h"
#include "daemon/handed_sockets.h"
#include "protocol/key.h"

/** How sockets are bound. Borrowed by each function that binds one. */
struct gz_network {
	const struct gz_config *config;
	const char *directory;            /**< of local sockets */
	struct gz_handed_sockets *handed; /**< bound by a service manager; NULL: none */
	void *context;                    /**< ZeroMQ */
	struct gz_guard *guard;
	struct gz_key_pair keys; /**< the daemon's, with tcp = curve */
	const struct gz_log *log;
};

/**
 * Read the daemon's key, if the configuration has tcp = curve, and create the guard.
 *
 * @param network  filled except for guard and keys; call gz_network_close() even after a failure
 * @retval GZ_ERR_UNSUPPORTED  libzmq was built without CURVE; logged
 * @retval GZ_ERR_NOT_FOUND    there is no key; logged with the remedy
 * @retval GZ_ERR_FORMAT       the file holds no key; logged
 * @return else as gz_key_file_find(), gz_key_file_read_secret() and gz_guard_create()
 */
enum gz_result gz_network_open(struct gz_network *network);

/**
 * Watch @p socket, bind it as @p name in the runtime directory, or take over the local socket that
 * a service manager has bound there, and bind it over TCP if the configuration allows it.
 *
 * @param name      "stream", "latest", "control" or "inlet"
 * @param endpoint  of TCP
 * @param[out] out_port  the TCP port, 0 without TCP
 * @param[out] out_connections  as gz_guard_watch(); may be NULL
 * @retval GZ_ERR_BUSY         an endpoint is in use, or a service manager listens at the local one
 *                             for another daemon; logged with the remedy
 * @retval GZ_ERR_INVAL        the TCP endpoint cannot be bound; logged with the remedy
 * @retval GZ_ERR_FULL         the path of the runtime directory is too long; logged
 * @retval GZ_ERR_UNSUPPORTED  libzmq refuses the keys; logged
 * @retval GZ_ERR_IO           the local socket cannot be bound or opened to its readers; logged
 */
enum gz_result gz_network_bind(const struct gz_network *network, void *socket, const char *name,
			       const char *endpoint, int *out_port,
			       const struct gz_connections **out_connections);

/** "tcp://ADDRESS:PORT" with the configured address; if @p port is 0, the system chooses the port.
 */
void gz_network_endpoint(const struct gz_network *network, int port, char text[GZ_ENDPOINT_SIZE]);

/** Destroy the guard and wipe the keys. */
void gz_network_close(struct gz_network *network);

#endif
