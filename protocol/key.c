#include "protocol/key.h"

#include <errno.h>
#include <fcntl.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/file.h"
#include "base/text.h"

#define GZ_LOG_MODULE "key"

/* ZeroMQ RFC 32/Z85: the characters for 0 to 84. Five of them are 32 bits, most significant first.
 */
static const char alphabet[] = "0123456789abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ"
			       ".-:+=^!/*?&<>()[]{}@%$#";

enum { GROUP_LENGTH = 5 };

bool gz_key_valid(const char *text, size_t length)
{
	uint64_t value = 0;
	if (length != GZ_KEY_LENGTH)
		return false;
	for (size_t i = 0; i < length; i++) {
		const char *digit = text[i] ? strchr(alphabet, text[i]) : NULL;
		if (!digit)
			return false;
		value = (i % GROUP_LENGTH ? 85 * value : 0) + (uint64_t)(digit - alphabet);
		if (value > UINT32_MAX)
			return false;
	}
	return true;
}

/* The lines of a text and, of the present line, what has not been read. */
struct key_lines {
	const char *rest, *end;
	int number;        /* of the present line, from 1 */
	const char *start; /* of the present line, without the blanks around it */
	size_t length;
};

static bool is_blank(char c)
{
	return c == ' ' || c == '\t' || c == '\r';
}

/* Go to the next line that is neither empty nor a comment. */
static bool next_key_line(struct key_lines *lines)
{
	while (lines->rest < lines->end) {
		const char *start = lines->rest;
		const char *stop = memchr(start, '\n', (size_t)(lines->end - start));
		lines->rest = stop ? stop + 1 : lines->end;
		if (!stop)
			stop = lines->end;
		while (start < stop && is_blank(*start))
			start++;
		while (stop > start && is_blank(stop[-1]))
			stop--;
		lines->number++;
		lines->start = start;
		lines->length = (size_t)(stop - start);
		if (lines->length > 0 && *start != '#')
			return true;
	}
	return false;
}

/* Cut the first word off the present line. @return its length */
static size_t take_key_word(struct key_lines *lines, const char **out_word)
{
	size_t length = 0;
	*out_word = lines->start;
	while (length < lines->length && !is_blank(lines->start[length]))
		length++;
	lines->start += length;
	lines->length -= length;
	while (lines->length > 0 && is_blank(*lines->start)) {
		lines->start++;
		lines->length--;
	}
	return length;
}

enum gz_result gz_key_parse(const char *name, const char *text, size_t size,
			    const struct gz_log *log, char out_key[GZ_KEY_TEXT_SIZE])
{
	struct key_lines lines = { .rest = text, .end = text + size };
	char key[GZ_KEY_TEXT_SIZE] = "";
	while (next_key_line(&lines)) {
		if (!gz_key_valid(lines.start, lines.length) || key[0]) {
			gz_err(log,
			       "%s:%d: %s; keep one line with a key of %d characters, as gazectl "
			       "keygen writes it",
			       name, lines.number, key[0] ? "a second key" : "no key",
			       GZ_KEY_LENGTH);
			return GZ_ERR_FORMAT;
		}
		memcpy(key, lines.start, GZ_KEY_LENGTH);
		key[GZ_KEY_LENGTH] = '\0';
	}
	if (!key[0]) {
		gz_err(log, "%s: contains no key; make a new one with gazectl keygen", name);
		return GZ_ERR_FORMAT;
	}
	memcpy(out_key, key, sizeof key);
	return GZ_OK;
}

/* Copy a comment or hosts. Control characters are refused: the text is logged, perhaps to a
 * terminal. */
static bool take_key_name(const char *text, size_t length, char out[GZ_KEY_NAME_SIZE])
{
	if (length >= GZ_KEY_NAME_SIZE)
		return false;
	for (size_t i = 0; i < length; i++) {
		if ((unsigned char)text[i] < ' ' || text[i] == 0x7f)
			return false;
	}
	memcpy(out, text, length);
	out[length] = '\0';
	return true;
}

/* Read the present line. @return what is wrong with it, or NULL */
static const char *read_key_entry(struct key_lines *lines, enum gz_key_list_kind kind,
				  struct gz_known_key *out)
{
	const char *word;
	size_t length = take_key_word(lines, &word);
	if (kind == GZ_KEY_LIST_SERVERS) {
		if (!take_key_name(word, length, out->name))
			return "the host is longer than 127 bytes or contains control characters";
		length = take_key_word(lines, &word);
	}
	if (!gz_key_valid(word, length))
		return kind == GZ_KEY_LIST_SERVERS
			       ? "no key of 40 characters after the host; write HOST KEY"
			       : "no key of 40 characters; write KEY, then a comment if you like";
	memcpy(out->key, word, GZ_KEY_LENGTH);
	out->key[GZ_KEY_LENGTH] = '\0';
	if (kind == GZ_KEY_LIST_AUTHORIZED &&
	    !take_key_name(lines->start, lines->length, out->name))
		return "the comment is longer than 127 bytes or contains control characters";
	return NULL;
}

/* Whether a host of @p entry has another key in @p list. */
static bool contradicts_key_list(const struct gz_key_list *list, const struct gz_known_key *entry)
{
	char host[GZ_KEY_NAME_SIZE];
	for (const char *rest = entry->name; *rest;) {
		size_t length = strcspn(rest, ",");
		memcpy(host, rest, length);
		host[length] = '\0';
		rest += length + (rest[length] == ',');
		const struct gz_known_key *other = gz_key_list_find_host(list, host);
		if (other && strcmp(other->key, entry->key) != 0)
			return true;
	}
	return false;
}

enum gz_result gz_key_list_parse(const char *name, const char *text, size_t size,
				 enum gz_key_list_kind kind, const struct gz_log *log,
				 struct gz_key_list *out_list)
{
	struct key_lines lines = { .rest = text, .end = text + size };
	out_list->count = 0;
	while (next_key_line(&lines)) {
		struct gz_known_key entry;
		if (out_list->count == GZ_KEYS_MAX) {
			gz_err(log, "%s:%d: more than %d keys; remove some", name, lines.number,
			       GZ_KEYS_MAX);
			return GZ_ERR_FULL;
		}
		const char *fault = read_key_entry(&lines, kind, &entry);
		if (!fault && kind == GZ_KEY_LIST_SERVERS && contradicts_key_list(out_list, &entry))
			fault = "a line above gives this host another key; keep the right one";
		if (fault) {
			gz_err(log, "%s:%d: %s", name, lines.number, fault);
			return GZ_ERR_FORMAT;
		}
		out_list->items[out_list->count++] = entry;
	}
	return GZ_OK;
}

const struct gz_known_key *gz_key_list_find_key(const struct gz_key_list *list, const char *key)
{
	for (size_t i = 0; i < list->count; i++) {
		if (strcmp(list->items[i].key, key) == 0)
			return &list->items[i];
	}
	return NULL;
}

static bool names_host(const char *hosts, const char *host)
{
	size_t wanted = strlen(host);
	for (;;) {
		size_t length = strcspn(hosts, ",");
		if (length == wanted && wanted > 0 && strncasecmp(hosts, host, wanted) == 0)
			return true;
		if (!hosts[length])
			return false;
		hosts += length + 1;
	}
}

const struct gz_known_key *gz_key_list_find_host(const struct gz_key_list *list, const char *host)
{
	for (size_t i = 0; i < list->count; i++) {
		if (names_host(list->items[i].name, host))
			return &list->items[i];
	}
	return NULL;
}

/* The longest path that Linux accepts, with its NUL, bytes. */
enum { KEY_PATH_SIZE = 4096 };

enum gz_result gz_key_directory(char *text, size_t size)
{
	const char *configuration = getenv("XDG_CONFIG_HOME");
	const char *home = getenv("HOME");
	if (configuration && configuration[0] == '/')
		return gz_text_print(text, size, "%s/gazecast", configuration);
	if (home && home[0] == '/')
		return gz_text_print(text, size, "%s/.config/gazecast", home);
	return GZ_ERR_NOT_FOUND;
}

enum gz_result gz_key_file_find(const char *directory, const char *name, char *path, size_t size)
{
	char user[KEY_PATH_SIZE], system[KEY_PATH_SIZE];
	if (directory && directory[0]) {
		if (gz_text_print(path, size, "%s/%s", directory, name) != GZ_OK)
			return GZ_ERR_FULL;
		return access(path, F_OK) == 0 ? GZ_OK : GZ_ERR_NOT_FOUND;
	}
	snprintf(system, sizeof system, "%s/gazecast/%s", GAZECAST_SYSCONFDIR, name);
	bool has_user = gz_key_directory(user, sizeof user) == GZ_OK;
	if (has_user) {
		if (gz_text_print(path, size, "%s/%s", user, name) != GZ_OK)
			return GZ_ERR_FULL;
		if (access(path, F_OK) == 0)
			return GZ_OK;
	}
	bool in_system = access(system, F_OK) == 0;
	if ((in_system || !has_user) && gz_text_print(path, size, "%s", system) != GZ_OK)
		return GZ_ERR_FULL;
	return in_system ? GZ_OK : GZ_ERR_NOT_FOUND;
}

static enum gz_result refuse_key_path(const char *path, const char *what, const char *remedy,
				      const struct gz_log *log)
{
	gz_err(log, "%s %s: run %s", path, what, remedy);
	return GZ_ERR_ACCESS;
}

/* Check the directory of @p path: who can write it can replace the file that was checked. */
static enum gz_result check_key_directory(const char *path, const struct gz_log *log)
{
	char directory[KEY_PATH_SIZE], remedy[KEY_PATH_SIZE + 32];
	struct stat status;
	const char *slash = strrchr(path, '/');
	if (!slash)
		snprintf(directory, sizeof directory, ".");
	else
		snprintf(directory, sizeof directory, "%.*s",
			 slash > path ? (int)(slash - path) : 1, path);
	if (stat(directory, &status) != 0) {
		gz_err(log, "cannot inspect %s: %s", directory, strerror(errno));
		return GZ_ERR_IO;
	}
	snprintf(remedy, sizeof remedy, "chmod 700 %s", directory);
	bool open = (status.st_mode & (S_IWGRP | S_IWOTH)) != 0;
	if (!open && (status.st_uid == 0 || status.st_uid == geteuid()))
		return GZ_OK;
	if (!open)
		snprintf(remedy, sizeof remedy, "chown %ld %s", (long)geteuid(), directory);
	return refuse_key_path(directory, open ? "can be written by others" : "is another user's",
			       remedy, log);
}

static enum gz_result check_key_file(const char *path, const struct stat *status, bool secret,
				     const struct gz_log *log)
{
	char remedy[KEY_PATH_SIZE + 16];
	if (!S_ISREG(status->st_mode))
		return refuse_key_path(path, "is not a regular file", "gazectl keygen", log);
	snprintf(remedy, sizeof remedy, "chmod %s %s", secret ? "600" : "go-w", path);
	if (secret && (status->st_mode & (S_IRWXG | S_IRWXO)))
		return refuse_key_path(path, "is a secret key that others can read", remedy, log);
	if (status->st_mode & (S_IWGRP | S_IWOTH))
		return refuse_key_path(path, "can be written by others", remedy, log);
	snprintf(remedy, sizeof remedy, "chown %ld %s", (long)geteuid(), path);
	if (status->st_uid != 0 && status->st_uid != geteuid())
		return refuse_key_path(path, "is another user's", remedy, log);
	return GZ_OK;
}

static enum gz_result read_key_bytes(int fd, const char *path, const struct gz_log *log, char *text,
				     size_t *out_size)
{
	size_t size = 0;
	ssize_t n;
	do {
		n = read(fd, text + size, GZ_KEY_FILE_SIZE_MAX + 1 - size);
		size += n > 0 ? (size_t)n : 0;
	} while ((n > 0 && size <= GZ_KEY_FILE_SIZE_MAX) || (n < 0 && errno == EINTR));
	if (n < 0) {
		gz_err(log, "cannot read %s: %s", path, strerror(errno));
		return GZ_ERR_IO;
	}
	if (size > GZ_KEY_FILE_SIZE_MAX) {
		gz_err(log, "%s is longer than %d bytes, too long for a key file; check the path",
		       path, GZ_KEY_FILE_SIZE_MAX);
		return GZ_ERR_FORMAT;
	}
	*out_size = size;
	return GZ_OK;
}

static enum gz_result read_checked_key_file(int fd, const char *path, bool secret,
					    const struct gz_log *log, char **out_text,
					    size_t *out_size)
{
	struct stat status;
	if (fstat(fd, &status) != 0) {
		gz_err(log, "cannot inspect %s: %s", path, strerror(errno));
		return GZ_ERR_IO;
	}
	enum gz_result result = check_key_file(path, &status, secret, log);
	if (result == GZ_OK)
		result = check_key_directory(path, log);
	if (result != GZ_OK)
		return result;
	char *text = malloc(GZ_KEY_FILE_SIZE_MAX + 1);
	if (!text)
		return GZ_ERR_NO_MEM;
	result = read_key_bytes(fd, path, log, text, out_size);
	if (result != GZ_OK) {
		free(text);
		return result;
	}
	*out_text = text;
	return GZ_OK;
}

enum gz_result gz_key_file_read(const char *path, bool secret, const struct gz_log *log,
				char **out_text, size_t *out_size)
{
	/* O_NONBLOCK: the file may have been replaced by a FIFO, which would block. */
	int fd = open(path, O_RDONLY | O_CLOEXEC | O_NOCTTY | O_NONBLOCK);
	if (fd < 0 && errno == ENOENT)
		return GZ_ERR_NOT_FOUND;
	if (fd < 0) {
		gz_err(log, "cannot open %s: %s; it must be readable by user %ld", path,
		       strerror(errno), (long)geteuid());
		return errno == EACCES ? GZ_ERR_ACCESS : GZ_ERR_IO;
	}
	enum gz_result result = read_checked_key_file(fd, path, secret, log, out_text, out_size);
	close(fd);
	return result;
}

enum gz_result gz_key_file_read_secret(const char *path, const struct gz_log *log,
				       char out_key[GZ_KEY_TEXT_SIZE])
{
	char *text;
	size_t size;
	enum gz_result result = gz_key_file_read(path, true, log, &text, &size);
	if (result != GZ_OK)
		return result;
	result = gz_key_parse(path, text, size, log, out_key);
	explicit_bzero(text, size);
	free(text);
	return result;
}

enum gz_result gz_key_file_read_list(const char *path, enum gz_key_list_kind kind,
				     const struct gz_log *log, struct gz_key_list *out_list)
{
	char *text;
	size_t size;
	enum gz_result result = gz_key_file_read(path, false, log, &text, &size);
	if (result != GZ_OK)
		return result;
	result = gz_key_list_parse(path, text, size, kind, log, out_list);
	free(text);
	return result;
}

enum gz_result gz_key_file_find_server(const char *directory, const char *host,
				       const struct gz_log *log, char out_key[GZ_KEY_TEXT_SIZE])
{
	char path[KEY_PATH_SIZE];
	enum gz_result result =
		gz_key_file_find(directory, GZ_KNOWN_SERVERS_FILE, path, sizeof path);
	if (result != GZ_OK)
		return result;
	struct gz_key_list *list = malloc(sizeof *list); /* large */
	if (!list)
		return GZ_ERR_NO_MEM;
	result = gz_key_file_read_list(path, GZ_KEY_LIST_SERVERS, log, list);
	if (result == GZ_OK) {
		const struct gz_known_key *known = gz_key_list_find_host(list, host);
		if (known)
			memcpy(out_key, known->key, GZ_KEY_TEXT_SIZE);
		else
			result = GZ_ERR_NOT_FOUND;
	}
	free(list);
	return result;
}

enum gz_result gz_key_directory_make(const char *directory, const struct gz_log *log)
{
	char path[KEY_PATH_SIZE];
	if (gz_text_print(path, sizeof path, "%s", directory) != GZ_OK)
		return GZ_ERR_FULL;
	for (char *slash = strchr(path + 1, '/'); slash; slash = strchr(slash + 1, '/')) {
		*slash = '\0';
		mkdir(path, 0700); /* if this fails, the last one fails too */
		*slash = '/';
	}
	if (mkdir(path, 0700) == 0 || errno == EEXIST)
		return GZ_OK;
	gz_err(log, "cannot make %s: %s; name another directory", directory, strerror(errno));
	return GZ_ERR_IO;
}

static bool write_key_bytes(int fd, const char *text)
{
	const size_t size = strlen(text);
	return gz_write_all(fd, text, size) == size && fsync(fd) == 0;
}

enum gz_result gz_key_file_write(const char *path, bool secret, const char *text,
				 const struct gz_log *log)
{
	int fd = open(path, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC | O_NOFOLLOW,
		      secret ? 0600 : 0644);
	if (fd < 0 && errno == EEXIST) {
		gz_err(log,
		       "%s exists and is kept: everybody who has that key would be locked out; "
		       "to replace it, move it away first",
		       path);
		return GZ_ERR_BUSY;
	}
	bool written = fd >= 0 && write_key_bytes(fd, text);
	if (!written)
		gz_err(log, "cannot write %s: %s", path, strerror(errno));
	if (fd >= 0)
		close(fd);
	if (fd >= 0 && !written)
		unlink(path);
	return written ? GZ_OK : GZ_ERR_IO;
}
