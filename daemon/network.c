#include "daemon/network.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <zmq.h>

#include "protocol/endpoint.h"
#include "protocol/key.h"
#include "protocol/wire.h"

#define GZ_LOG_MODULE "network"

/* RFC 27: the domain, a name for what the keys give access to. */
static const char zap_domain[] = "gazecast";

/* Longest handshake, ms; then the connection is closed. Chosen: several round trips across the
 * world. */
enum { HANDSHAKE_MS = 5000 };

/* How often a connection is tested, and after how long without an answer it is closed and its queue
 * freed, ms: the other machine may have vanished from the network. libzmq 4.2 and later answer by
 * themselves. Chosen. */
enum { HEARTBEAT_MS = 5000, HEARTBEAT_TIMEOUT_MS = 20000 };

/* Read the daemon's key pair. @param[out] path  the file of the secret key */
static enum gz_result read_server_key(struct gz_network *network, char path[GZ_PATH_SIZE])
{
	const char *directory = network->config->key_directory;
	if (!zmq_has("curve")) {
		gz_err(network->log, "network.tcp: this libzmq was built without CURVE; use "
				     "loopback or off, or a libzmq with libsodium");
		return GZ_ERR_UNSUPPORTED;
	}
	enum gz_result result = gz_key_file_find(directory, GZ_SERVER_KEY_FILE, path, GZ_PATH_SIZE);
	if (result == GZ_OK)
		result = gz_key_file_read_secret(path, network->log, network->keys.secret_text);
	if (result == GZ_ERR_NOT_FOUND)
		gz_err(network->log,
		       "network.tcp: curve needs a key, but %s does not exist; run gazectl keygen "
		       "--server, or use --tcp loopback",
		       path);
	if (result != GZ_OK)
		return result;
	if (zmq_curve_public(network->keys.public_text, network->keys.secret_text) == 0)
		return GZ_OK;
	gz_err(network->log, "libzmq refuses the key in %s: %s", path, zmq_strerror(errno));
	return GZ_ERR_FORMAT;
}

/* What the daemon sends besides the topics of the protocol. */
static void know_surfaces(const struct gz_network *network)
{
	char topic[sizeof GZ_TOPIC_SURFACES + GZ_NAME_SIZE];
	for (size_t i = 0; i < network->config->surface_count; i++) {
		snprintf(topic, sizeof topic, "%s%s", GZ_TOPIC_SURFACES,
			 network->config->surface[i]);
		gz_guard_know_topic(network->guard, topic);
	}
}

/* The doors' limits, as far as they can be set. */
static void set_door_limits(const struct gz_config *config,
			    struct gz_door_limits limits[GZ_DOOR_PLACES])
{
	for (int place = 0; place < GZ_DOOR_PLACES; place++) {
		limits[place] = gz_door_usual_limits((enum gz_door_place)place);
		if (place == GZ_DOOR_OPEN) {
			limits[place].connections = (uint32_t)config->open_clients;
			continue;
		}
		limits[place].connections = (uint32_t)config->trusted_clients;
		limits[place].strange = (uint32_t)config->trusted_topics;
		limits[place].strange_each = (uint32_t)config->trusted_topics / 4;
	}
}

enum gz_result gz_network_open(struct gz_network *network)
{
	char path[GZ_PATH_SIZE], authorized[GZ_PATH_SIZE + sizeof GZ_AUTHORIZED_KEYS_FILE];
	bool curve = network->config->tcp == GZ_TCP_CURVE;
	if (curve) {
		enum gz_result result = read_server_key(network, path);
		if (result != GZ_OK)
			return result;
		/* The list of authorised keys is in the same directory. */
		snprintf(authorized, sizeof authorized, "%.*s%s",
			 (int)(strlen(path) - strlen(GZ_SERVER_KEY_FILE)), path,
			 GZ_AUTHORIZED_KEYS_FILE);
	}
	struct gz_door_limits limits[GZ_DOOR_PLACES];
	set_door_limits(network->config, limits);
	enum gz_result result = gz_guard_create(network->context, curve ? authorized : NULL, limits,
						network->log, &network->guard);
	if (result == GZ_OK)
		know_surfaces(network);
	return result;
}

void gz_network_endpoint(const struct gz_network *network, int port, char text[GZ_ENDPOINT_SIZE])
{
	if (port > 0)
		snprintf(text, GZ_ENDPOINT_SIZE, "tcp://%s:%d", network->config->address, port);
	else
		snprintf(text, GZ_ENDPOINT_SIZE, "tcp://%s:*", network->config->address);
}

static bool set_socket_option(void *socket, int option, int value)
{
	return zmq_setsockopt(socket, option, &value, sizeof value) == 0;
}

/* Let libzmq accept connections at a socket that is bound already, and whose file stays. It closes
 * @p fd. */
static enum gz_result take_over_local(const struct gz_network *network, void *socket,
				      const char *endpoint, int fd)
{
	bool taken = set_socket_option(socket, ZMQ_USE_FD, fd) && zmq_bind(socket, endpoint) == 0;
	const int error = errno;
	if (set_socket_option(socket, ZMQ_USE_FD, -1) && taken)
		return GZ_OK;
	gz_err(network->log, "cannot take over %s from the service manager: %s", endpoint,
	       zmq_strerror(error));
	return GZ_ERR_IO;
}

static enum gz_result bind_local(const struct gz_network *network, void *socket, const char *name,
				 struct gz_connections *connections)
{
	char endpoint[GZ_ENDPOINT_SIZE];
	static const char scheme[] = "ipc://";
	enum gz_result result =
		gz_endpoint_ipc(network->directory, name, endpoint, sizeof endpoint);
	if (result != GZ_OK) {
		gz_err(network->log,
		       "%s is too long for the path of a socket; set GAZECAST_RUNTIME_DIR to a "
		       "shorter one",
		       network->directory);
		return result;
	}
	const char *path = endpoint + sizeof scheme - 1;
	gz_guard_open_local_door(connections, path);
	const int handed = gz_handed_sockets_take(network->handed, path, SOCK_STREAM);
	if (handed >= 0)
		return take_over_local(network, socket, endpoint, handed);
	if (gz_socket_is_listened_at(path)) {
		gz_err(network->log,
		       "a service manager listens at %s to start gazed: use its daemon (systemctl "
		       "--user start gazed), stop that (systemctl --user stop gazed.socket), or "
		       "set "
		       "GAZECAST_RUNTIME_DIR to another directory for this one",
		       path);
		return GZ_ERR_BUSY;
	}
	if (zmq_bind(socket, endpoint) != 0) {
		gz_err(network->log,
		       "cannot bind %s: %s; set GAZECAST_RUNTIME_DIR to another directory",
		       endpoint, zmq_strerror(errno));
		return errno == EADDRINUSE ? GZ_ERR_BUSY : GZ_ERR_IO;
	}
	/* The directory's permissions decide who may enter; connecting needs write permission. */
	if (chmod(path, gz_runtime_directory_is_shared(network->directory) ? 0660 : 0600) == 0)
		return GZ_OK;
	gz_err(network->log, "cannot set the permissions of %s: %s", endpoint, strerror(errno));
	return GZ_ERR_IO;
}

/* Require keys for endpoints that are bound from now on. The local one, bound before, needs none.
 */
static enum gz_result require_keys(const struct gz_network *network, void *socket)
{
	if (set_socket_option(socket, ZMQ_CURVE_SERVER, 1) &&
	    zmq_setsockopt(socket, ZMQ_CURVE_SECRETKEY, network->keys.secret_text,
			   GZ_KEY_TEXT_SIZE) == 0 &&
	    zmq_setsockopt(socket, ZMQ_ZAP_DOMAIN, zap_domain, sizeof zap_domain - 1) == 0 &&
	    set_socket_option(socket, ZMQ_HEARTBEAT_IVL, HEARTBEAT_MS) &&
	    set_socket_option(socket, ZMQ_HEARTBEAT_TIMEOUT, HEARTBEAT_TIMEOUT_MS))
		return GZ_OK;
	gz_err(network->log, "libzmq refuses the keys: %s", zmq_strerror(errno));
	return GZ_ERR_UNSUPPORTED;
}

static int bound_tcp_port(void *socket)
{
	char endpoint[GZ_ENDPOINT_SIZE] = "";
	size_t size = sizeof endpoint;
	if (zmq_getsockopt(socket, ZMQ_LAST_ENDPOINT, endpoint, &size) != 0)
		return 0;
	const char *colon = strrchr(endpoint, ':');
	return colon ? atoi(colon + 1) : 0;
}

static enum gz_result bind_tcp(const struct gz_network *network, void *socket, const char *name,
			       const char *endpoint, int *out_port)
{
	enum gz_result result = GZ_OK;
	if (network->config->tcp == GZ_TCP_CURVE)
		result = require_keys(network, socket);
	/* ZMQ_IPV6 is set for an address in brackets. */
	bool bound = result == GZ_OK &&
		     set_socket_option(socket, ZMQ_HANDSHAKE_IVL, HANDSHAKE_MS) &&
		     set_socket_option(socket, ZMQ_IPV6, strchr(endpoint, '[') != NULL) &&
		     zmq_bind(socket, endpoint) == 0;
	if (bound)
		*out_port = bound_tcp_port(socket);
	if (bound || result != GZ_OK)
		return result;
	if (errno == EADDRINUSE) {
		gz_err(network->log,
		       "%s is in use, perhaps by Pupil Capture or another gazed; stop that "
		       "program, "
		       "or give %s another port (network.%s), or use --tcp off",
		       endpoint, name, strcmp(name, "control") == 0 ? "control" : "*_port");
		return GZ_ERR_BUSY;
	}
	gz_err(network->log,
	       "cannot bind %s: %s; network.address must be an address of this machine and "
	       "network.control must be tcp://ADDRESS:PORT; or use --tcp off",
	       endpoint, zmq_strerror(errno));
	return GZ_ERR_INVAL;
}

enum gz_result gz_network_bind(const struct gz_network *network, void *socket, const char *name,
			       const char *endpoint, int *out_port,
			       const struct gz_connections **out_connections)
{
	struct gz_connections *connections;
	enum gz_result result = gz_guard_watch(network->guard, socket, name, &connections);
	*out_port = 0;
	if (result == GZ_OK)
		result = bind_local(network, socket, name, connections);
	if (result == GZ_OK && network->config->tcp != GZ_TCP_OFF)
		result = bind_tcp(network, socket, name, endpoint, out_port);
	if (result == GZ_OK && *out_port > 0)
		gz_guard_open_door(connections, *out_port);
	if (result == GZ_OK && out_connections)
		*out_connections = connections;
	return result;
}

void gz_network_close(struct gz_network *network)
{
	gz_guard_destroy(&network->guard);
	explicit_bzero(&network->keys, sizeof network->keys);
}
