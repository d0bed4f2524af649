/* gazectl keygen: makes the keys of a daemon or a client, and prints what to do with them. */
#include <errno.h>
#include <pwd.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>
#include <zmq.h>

#include "client/gazectl/gazectl.h"
#include "protocol/key.h"

#define GZ_LOG_MODULE "gazectl"

struct settings {
	struct gz_command_common common;
	bool server;
	char client[GZ_KEY_NAME_SIZE];
	char directory[GZ_PATH_SIZE];
	char owner[64];
};

#define AT(field) offsetof(struct settings, field)

static const struct gz_option options[] = {
	GZ_COMMAND_HELP_OPTION,
	{ "server", GZ_OPTION_BOOL, AT(server), 0, 0, 0, NULL, "false",
	  "make the key with which a daemon proves its identity" },
	{ "client", GZ_OPTION_STRING, AT(client), 0, GZ_KEY_NAME_SIZE, 0, NULL, "",
	  "make the key of a client; its name, such as anna@desk, shows whose key it is" },
	{ "keys", GZ_OPTION_STRING, AT(directory), 0, GZ_PATH_SIZE, 0, NULL, "",
	  "directory for the files; empty: gazecast in the user's configuration directory" },
	{ "owner", GZ_OPTION_STRING, AT(owner), 0, 64, 0, NULL, "",
	  "user who will own the files, for root only; empty: the user who runs gazectl" },
};

/* The keys and files being made. */
struct keygen {
	const struct settings *settings;
	const struct gz_log *log;
	char directory[GZ_PATH_SIZE];
	char secret_path[GZ_PATH_SIZE + 32];
	char public_path[GZ_PATH_SIZE + 32];
	struct gz_key_pair keys;
};

static enum gz_result check_settings(const struct settings *settings, const struct gz_log *log)
{
	if (settings->server == (settings->client[0] != '\0')) {
		gz_err(log, "give --server on the daemon's machine, or --client NAME on another");
		return GZ_ERR_INVAL;
	}
	for (const char *c = settings->client; *c; c++) {
		if ((unsigned char)*c < ' ' || *c == 0x7f) {
			gz_err(log, "--client: the name must not have control characters");
			return GZ_ERR_INVAL;
		}
	}
	return GZ_OK;
}

static enum gz_result choose_files(struct keygen *keygen)
{
	const struct settings *settings = keygen->settings;
	const char *name = settings->server ? GZ_SERVER_KEY_FILE : GZ_CLIENT_KEY_FILE;
	enum gz_result result = GZ_OK;
	if (settings->directory[0])
		memcpy(keygen->directory, settings->directory, sizeof keygen->directory);
	else
		result = gz_key_directory(keygen->directory, sizeof keygen->directory);
	if (result != GZ_OK) {
		gz_err(keygen->log,
		       "there is no configuration directory; give a directory with --keys");
		return result;
	}
	snprintf(keygen->secret_path, sizeof keygen->secret_path, "%s/%s", keygen->directory, name);
	snprintf(keygen->public_path, sizeof keygen->public_path, "%s/%s.pub", keygen->directory,
		 name);
	return GZ_OK;
}

static enum gz_result make_pair(struct keygen *keygen)
{
	if (zmq_curve_keypair(keygen->keys.public_text, keygen->keys.secret_text) == 0)
		return GZ_OK;
	gz_err(keygen->log, "libzmq cannot make keys: %s; it must be built with CURVE",
	       zmq_strerror(errno));
	return GZ_ERR_UNSUPPORTED;
}

static enum gz_result give_away(const struct keygen *keygen)
{
	const char *owner = keygen->settings->owner;
	if (!owner[0])
		return GZ_OK;
	const struct passwd *user = getpwnam(owner);
	if (!user) {
		gz_err(keygen->log, "--owner: there is no user %s", owner);
		return GZ_ERR_NOT_FOUND;
	}
	if (chown(keygen->secret_path, user->pw_uid, user->pw_gid) == 0 &&
	    chown(keygen->public_path, user->pw_uid, user->pw_gid) == 0)
		return GZ_OK;
	gz_err(keygen->log, "cannot give the files to %s: %s; run as root, or without --owner",
	       owner, strerror(errno));
	return GZ_ERR_ACCESS;
}

/* Write both files or neither. */
static enum gz_result write_files(const struct keygen *keygen)
{
	char text[256];
	const char *whose = keygen->settings->server ? "daemon" : "client";
	snprintf(text, sizeof text, "# Secret key of a gazecast %s: nobody else may read it.\n%s\n",
		 whose, keygen->keys.secret_text);
	enum gz_result result = gz_key_file_write(keygen->secret_path, true, text, keygen->log);
	explicit_bzero(text, sizeof text);
	if (result != GZ_OK)
		return result;
	snprintf(text, sizeof text, "%s\n", keygen->keys.public_text);
	result = gz_key_file_write(keygen->public_path, false, text, keygen->log);
	if (result != GZ_OK) {
		unlink(keygen->secret_path);
		return result;
	}
	result = give_away(keygen);
	if (result != GZ_OK) {
		unlink(keygen->secret_path);
		unlink(keygen->public_path);
	}
	return result;
}

static void print_server_steps(const struct keygen *keygen)
{
	char host[256] = "HOST";
	if (gethostname(host, sizeof host - 1) != 0 || !host[0])
		snprintf(host, sizeof host, "HOST");
	printf("secret key: %s (stays here)\n\n"
	       "1. On each machine that will connect to this one, add this line to known_servers "
	       "in ~/.config/gazecast, with the name or address by which it reaches this "
	       "machine:\n\n"
	       "%s %s\n\n"
	       "2. There, run gazectl keygen --client NAME, and add the line that it prints to "
	       "this file here:\n"
	       "   %s/" GZ_AUTHORIZED_KEYS_FILE "\n\n"
	       "3. In section [network] of gazed.conf here, set tcp = curve, and address = the "
	       "address of this machine (* for all)\n",
	       keygen->secret_path, host, keygen->keys.public_text, keygen->directory);
}

static void print_client_steps(const struct keygen *keygen)
{
	printf("secret key: %s (stays here)\n\n"
	       "1. On the daemon's machine, add this line to authorized_keys in the directory of "
	       "its server_key:\n\n"
	       "%s %s\n\n"
	       "2. Here, add the line that gazectl keygen --server printed there to\n"
	       "   %s/" GZ_KNOWN_SERVERS_FILE "\n",
	       keygen->secret_path, keygen->keys.public_text, keygen->settings->client,
	       keygen->directory);
}

static int keygen_run(int argc, char *const *argv, const struct gz_log *log)
{
	struct settings settings;
	struct gz_operands operands;
	int exit_status =
		gz_command_read_arguments(&gazectl_keygen, argc, argv, log, &settings, &operands);
	if (exit_status != GZ_COMMAND_GO_ON)
		return exit_status;
	if (check_settings(&settings, log) != GZ_OK)
		return GAZECTL_USAGE;
	struct keygen keygen = { .settings = &settings, .log = log };
	enum gz_result result = choose_files(&keygen);
	if (result == GZ_OK)
		result = make_pair(&keygen);
	if (result == GZ_OK)
		result = gz_key_directory_make(keygen.directory, log);
	if (result == GZ_OK)
		result = write_files(&keygen);
	if (result == GZ_OK && settings.server)
		print_server_steps(&keygen);
	else if (result == GZ_OK)
		print_client_steps(&keygen);
	explicit_bzero(&keygen.keys, sizeof keygen.keys);
	return result == GZ_OK ? GAZECTL_DONE : GAZECTL_FAILED;
}

const struct gz_command gazectl_keygen = {
	.program = "gazectl",
	.name = "keygen",
	.operands = "",
	.operands_max = 0,
	.summary = "make keys for a daemon that other machines read",
	.details = "Existing files are never overwritten. The output says which line belongs into "
		   "which file.\n",
	.options = options,
	.option_count = sizeof options / sizeof options[0],
	.run = keygen_run,
};
