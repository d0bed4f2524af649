#include "drivers/pupil/pupil_keys.h"

#include <string.h>
#include <zmq.h>

#include "protocol/gaze.h"
#include "protocol/key_file.h"

#define GZ_LOG_MODULE "pupil"

static enum gz_result find_own(const struct gz_log *log, struct gz_key_pair *own)
{
	char path[GZ_PATH_SIZE];
	enum gz_result result = gz_key_file_find(NULL, GZ_CLIENT_KEY_FILE, path, sizeof path);
	if (result == GZ_OK)
		result = gz_key_file_read_secret(path, log, own->secret_text);
	if (result == GZ_ERR_NOT_FOUND) {
		gz_err(log,
		       "the other daemon wants a key, and %s is not there: run gazectl keygen "
		       "--client",
		       path);
		return GZ_ERR_ACCESS;
	}
	if (result == GZ_OK && zmq_curve_public(own->public_text, own->secret_text) != 0)
		result = GZ_ERR_FORMAT;
	return result;
}

enum gz_result gz_pupil_keys_find(const char *host, const struct gz_log *log,
				  struct gz_pupil_keys *out_keys)
{
	struct gz_pupil_keys keys = { .server = "" };
	char bare[GZ_KEY_NAME_SIZE];
	size_t length = strlen(host);
	if (length > 2 && host[0] == '[' && host[length - 1] == ']') {
		host++;
		length -= 2;
	}
	if (length >= sizeof bare) /* no list names it */
		length = 0;
	memcpy(bare, host, length);
	bare[length] = '\0';
	enum gz_result result = gz_key_file_find_server(NULL, bare, log, keys.server);
	if (result == GZ_ERR_NOT_FOUND)
		result = GZ_OK;
	if (result == GZ_OK && keys.server[0])
		result = find_own(log, &keys.own);
	if (result == GZ_OK)
		*out_keys = keys;
	explicit_bzero(&keys, sizeof keys);
	return result;
}

bool gz_pupil_keys_apply(const struct gz_pupil_keys *keys, void *socket)
{
	return keys->server[0] == '\0' ||
	       (zmq_setsockopt(socket, ZMQ_CURVE_SERVERKEY, keys->server, GZ_KEY_TEXT_SIZE) == 0 &&
		zmq_setsockopt(socket, ZMQ_CURVE_PUBLICKEY, keys->own.public_text,
			       GZ_KEY_TEXT_SIZE) == 0 &&
		zmq_setsockopt(socket, ZMQ_CURVE_SECRETKEY, keys->own.secret_text,
			       GZ_KEY_TEXT_SIZE) == 0);
}
