#include "client/keys.h"

#include <stdio.h>
#include <string.h>
#include <zmq.h>

#include "protocol/endpoint.h"
#include "protocol/key.h"
#include "protocol/key_file.h"

#define GZ_LOG_MODULE "client"

enum { PATH_SIZE = 1024 };

_Static_assert(GZ_KEYS_TEXT_SIZE == GZ_KEY_TEXT_SIZE, "one size of a key");

/* The host of "tcp://HOST:PORT", without the brackets of an IPv6 address, nor the address that the
 * connection is to leave from ("tcp://FROM;HOST:PORT"). */
static bool host_of(const char *endpoint, char *host, size_t size)
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

static enum gz_result find_own(const char *directory, const struct gz_log *log,
			       struct gz_keys *keys)
{
	char path[PATH_SIZE];
	enum gz_result result = gz_key_file_find(directory, GZ_CLIENT_KEY_FILE, path, sizeof path);
	if (result == GZ_OK)
		result = gz_key_file_read_secret(path, log, keys->secret_key);
	if (result == GZ_ERR_NOT_FOUND) {
		gz_err(log,
		       "the daemon wants a key, and %s is not there: run gazectl keygen "
		       "--client",
		       path);
		return GZ_ERR_ACCESS;
	}
	if (result == GZ_OK && zmq_curve_public(keys->public_key, keys->secret_key) != 0) {
		gz_err(log, "%s: libzmq does not take the key: %s", path, zmq_strerror(errno));
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
	if (!host_of(endpoint, host, sizeof host))
		return GZ_ERR_NOT_FOUND;
	if (!server_key || !server_key[0]) {
		result = gz_key_file_find_server(directory, host, log, keys.server_key);
	} else if (gz_key_valid(server_key, strlen(server_key))) {
		memcpy(keys.server_key, server_key, sizeof keys.server_key);
	} else {
		gz_err(log,
		       "the server key has %zu characters and is none: it is the word of 40 that "
		       "gazectl keygen --server prints",
		       strlen(server_key));
		return GZ_ERR_INVAL;
	}
	if (result == GZ_OK)
		result = find_own(directory, log, &keys);
	if (result == GZ_OK)
		*out_keys = keys;
	explicit_bzero(&keys, sizeof keys);
	return result;
}
