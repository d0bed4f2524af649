#include "client/keys.h"

#include <stdio.h>
#include <string.h>
#include <zmq.h>

#include "base/sizes.h"
#include "protocol/endpoint.h"
#include "protocol/key.h"

#define GZ_LOG_MODULE "client"

_Static_assert(GZ_KEYS_TEXT_SIZE == GZ_KEY_TEXT_SIZE, "both headers give a key the same size");

/* Copy the host of "tcp://HOST:PORT", without the brackets of an IPv6 address and without the
 * source address of "tcp://FROM;HOST:PORT". @return false for any other text */
static bool tcp_host(const char *endpoint, char *host, size_t size)
{
	static const char scheme[] = "tcp://";
	if (!endpoint || strncmp(endpoint, scheme, sizeof scheme - 1) != 0)
		return false;
	const char *start = endpoint + sizeof scheme - 1;
	const char *semicolon = strchr(start, ';');
	if (semicolon)
		start = semicolon + 1;
	const char *stop = strrchr(start, ':');
	if (!stop)
		return false;
	if (*start == '[' && stop > start + 1 && stop[-1] == ']') {
		start++;
		stop--;
	}
	size_t length = (size_t)(stop - start);
	if (length == 0 || length >= size)
		return false;
	memcpy(host, start, length);
	host[length] = '\0';
	return true;
}

static enum gz_result find_client_key(const char *directory, const struct gz_log *log,
				      struct gz_keys *keys)
{
	char path[GZ_PATH_SIZE];
	enum gz_result result = gz_key_file_find(directory, GZ_CLIENT_KEY_FILE, path, sizeof path);
	if (result == GZ_OK)
		result = gz_key_file_read_secret(path, log, keys->secret_key);
	if (result == GZ_ERR_NOT_FOUND) {
		gz_err(log,
		       "the daemon requires a key, but %s does not exist; run gazectl keygen "
		       "--client",
		       path);
		return GZ_ERR_ACCESS;
	}
	if (result == GZ_OK && zmq_curve_public(keys->public_key, keys->secret_key) != 0) {
		gz_err(log, "%s: libzmq refuses the key: %s", path, zmq_strerror(errno));
		return GZ_ERR_FORMAT;
	}
	return result;
}

enum gz_result gz_keys_find(const char *endpoint, const char *directory, const char *server_key,
			    const struct gz_log *log, struct gz_keys *out_keys)
{
	char host[GZ_ENDPOINT_SIZE];
	struct gz_keys keys;
	enum gz_result result = GZ_OK;
	if (!tcp_host(endpoint, host, sizeof host))
		return GZ_ERR_NOT_FOUND;
	if (!server_key || !server_key[0]) {
		result = gz_key_file_find_server(directory, host, log, keys.server_key);
	} else if (gz_key_valid(server_key, strlen(server_key))) {
		memcpy(keys.server_key, server_key, sizeof keys.server_key);
	} else {
		gz_err(log,
		       "the server key, of %zu characters, is not valid: give the word of 40 "
		       "characters that gazectl keygen --server prints",
		       strlen(server_key));
		return GZ_ERR_INVAL;
	}
	if (result == GZ_OK)
		result = find_client_key(directory, log, &keys);
	if (result == GZ_OK)
		*out_keys = keys;
	explicit_bzero(&keys, sizeof keys);
	return result;
}
