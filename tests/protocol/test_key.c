#include "suite.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zmq.h>

#include "base/captured_log.h"
#include "protocol/key.h"

/* The key in the examples of ZeroMQ RFC 26, and another one. */
static const char key_a[] = "Yne@$w-vo<fVvi]a<NY6T1ed:M$fCG*[IaLV{hID";
static const char key_b[] = "rq:rM>}U?@Lns47E1%kR.o@n%FcmmsL/@{H8]yf7";

static struct captured_log captured;

static int set_up(void **state)
{
	(void)state;
	captured_log_init(&captured, NULL);
	return 0;
}

static void key_is_valid_where_libzmq_decodes_it(void **state)
{
	(void)state;
	static const char *const texts[] = {
		key_a,
		key_b,
		"0000000000000000000000000000000000000000",
		"%nSc0%nSc0%nSc0%nSc0%nSc0%nSc0%nSc0%nSc0", /* the greatest */
		"%nSc1%nSc0%nSc0%nSc0%nSc0%nSc0%nSc0%nSc0", /* one more in the first group */
		"%nSc0%nSc0%nSc0%nSc0%nSc0%nSc0%nSc0#####",
		"Yne@$w-vo<fVvi]a<NY6T1ed:M$fCG*[IaLV{hI~",
		"Yne@$w-vo<fVvi]a<NY6T1ed:M$fCG*[IaLV{hI ",
	};
	for (size_t i = 0; i < sizeof texts / sizeof *texts; i++) {
		uint8_t bytes[32];
		bool decoded = zmq_z85_decode(bytes, texts[i]) != NULL;
		if (gz_key_valid(texts[i], strlen(texts[i])) != decoded)
			fail_msg("%s: libzmq %s", texts[i], decoded ? "takes it" : "refuses it");
	}
	assert_false(gz_key_valid(key_a, 39));
	assert_false(gz_key_valid("Yne@$w-vo<fVvi]a<NY6T1ed:M$fCG*[IaLV{hIDx", 41));
	assert_false(gz_key_valid("", 0));
}

/* Each byte at each place of the first group: gz_key_valid() agrees with libzmq. */
static void key_of_any_character_is_judged_as_libzmq_does(void **state)
{
	(void)state;
	for (int c = 1; c < 256; c++) {
		for (int place = 0; place < 5; place++) {
			char text[GZ_KEY_TEXT_SIZE];
			uint8_t bytes[32];
			memcpy(text, key_a, sizeof text);
			text[place] = (char)c;
			/* The table of libzmq ends at 0x7f. */
			bool decoded = c > ' ' && c < 0x7f && zmq_z85_decode(bytes, text) != NULL;
			if (gz_key_valid(text, GZ_KEY_LENGTH) != decoded)
				fail_msg("character %d at %d: libzmq %d", c, place, decoded);
		}
	}
}

static void key_file_holds_one_key_among_comments(void **state)
{
	(void)state;
	char text[256], key[GZ_KEY_TEXT_SIZE];
	snprintf(text, sizeof text, "# mine\r\n\n  %s\t\r\n", key_a);
	assert_int_equal(gz_key_parse("f", text, strlen(text), &captured.log, key), GZ_OK);
	assert_string_equal(key, key_a);
	snprintf(text, sizeof text, "%s", key_b); /* without a line end */
	assert_int_equal(gz_key_parse("f", text, strlen(text), &captured.log, key), GZ_OK);
	assert_string_equal(key, key_b);
}

static void key_file_of_anything_else_is_refused_without_showing_it(void **state)
{
	(void)state;
	char text[256], key[GZ_KEY_TEXT_SIZE] = "as before";
	snprintf(text, sizeof text, "%s\n%s\n", key_a, key_b);
	assert_int_equal(gz_key_parse("f", text, strlen(text), &captured.log, key), GZ_ERR_FORMAT);
	assert_non_null(strstr(captured.last, "f:2: a second key"));
	snprintf(text, sizeof text, "secret %s\n", key_a);
	assert_int_equal(gz_key_parse("f", text, strlen(text), &captured.log, key), GZ_ERR_FORMAT);
	assert_non_null(strstr(captured.last, "f:1: no key"));
	assert_null(strstr(captured.last, "Yne@"));
	assert_int_equal(gz_key_parse("f", "# no\n", 5, &captured.log, key), GZ_ERR_FORMAT);
	assert_non_null(strstr(captured.last, "contains no key"));
	assert_string_equal(key, "as before");
}

static enum gz_result parse_list(const char *text, enum gz_key_list_kind kind,
				 struct gz_key_list *list)
{
	return gz_key_list_parse("f", text, strlen(text), kind, &captured.log, list);
}

static void list_of_clients_has_keys_and_comments(void **state)
{
	(void)state;
	static struct gz_key_list list;
	char text[256];
	snprintf(text, sizeof text, "# us\n%s anna at the desk \n%s\n", key_a, key_b);
	assert_int_equal(parse_list(text, GZ_KEY_LIST_AUTHORIZED, &list), GZ_OK);
	assert_int_equal(list.count, 2);
	assert_string_equal(gz_key_list_find_key(&list, key_a)->name, "anna at the desk");
	assert_string_equal(gz_key_list_find_key(&list, key_b)->name, "");
	assert_null(gz_key_list_find_key(&list, ""));
	assert_int_equal(parse_list("", GZ_KEY_LIST_AUTHORIZED, &list), GZ_OK);
	assert_null(gz_key_list_find_key(&list, key_a));
}

static void list_of_servers_finds_a_host_by_any_of_its_names(void **state)
{
	(void)state;
	static struct gz_key_list list;
	char text[256];
	snprintf(text, sizeof text, "Lab,10.0.0.1 %s\nfe80::1 %s second\n", key_a, key_b);
	assert_int_equal(parse_list(text, GZ_KEY_LIST_SERVERS, &list), GZ_OK);
	assert_string_equal(gz_key_list_find_host(&list, "lab")->key, key_a);
	assert_string_equal(gz_key_list_find_host(&list, "10.0.0.1")->key, key_a);
	assert_string_equal(gz_key_list_find_host(&list, "fe80::1")->key, key_b);
	static const char *const strangers[] = { "la", "lab,10.0.0.1", "10.0.0.11", "", "0.0.0.1" };
	for (size_t i = 0; i < sizeof strangers / sizeof *strangers; i++)
		assert_null(gz_key_list_find_host(&list, strangers[i]));
}

static void list_with_a_bad_line_is_refused_by_its_number(void **state)
{
	(void)state;
	static struct gz_key_list list;
	char text[512];
	static const struct {
		enum gz_key_list_kind kind;
		const char *format, *wanted;
	} cases[] = {
		{ GZ_KEY_LIST_AUTHORIZED, "%s\nbad\n", "f:2: no key of 40 characters" },
		{ GZ_KEY_LIST_AUTHORIZED, "\n\n%s a\033[2J\n", "f:3: the comment" },
		{ GZ_KEY_LIST_AUTHORIZED, "host %s\n", "f:1: no key" },
		{ GZ_KEY_LIST_SERVERS, "%s\n", "f:1: no key of 40 characters after the host" },
		{ GZ_KEY_LIST_SERVERS, "h %s\nH 0000000000000000000000000000000000000000\n",
		  "f:2: a line above gives this host another key" },
	};
	for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
		snprintf(text, sizeof text, cases[i].format, key_a);
		enum gz_result result = parse_list(text, cases[i].kind, &list);
		if (result != GZ_ERR_FORMAT || !strstr(captured.last, cases[i].wanted))
			fail_msg("%zu: %s: %s", i, gz_result_text(result), captured.last);
	}
}

static void list_longer_than_its_room_is_refused(void **state)
{
	(void)state;
	static struct gz_key_list list;
	static char text[(GZ_KEYS_MAX + 1) * (GZ_KEY_LENGTH + 1) + 1];
	size_t size = 0;
	for (int i = 0; i <= GZ_KEYS_MAX; i++)
		size += (size_t)snprintf(text + size, sizeof text - size, "%s\n", key_a);
	assert_int_equal(
		gz_key_list_parse("f", text, size, GZ_KEY_LIST_AUTHORIZED, &captured.log, &list),
		GZ_ERR_FULL);
	assert_non_null(strstr(captured.last, "f:257: more than 256 keys"));
	assert_int_equal(gz_key_list_parse("f", text, size - GZ_KEY_LENGTH - 1,
					   GZ_KEY_LIST_AUTHORIZED, &captured.log, &list),
			 GZ_OK);
	assert_int_equal(list.count, GZ_KEYS_MAX);
}

static void key_file_that_is_no_file_of_keys_is_refused(void **state)
{
	(void)state;
	char directory[] = "/tmp/gz_key_XXXXXX", path[64], key[GZ_KEY_TEXT_SIZE];
	assert_non_null(mkdtemp(directory));
	snprintf(path, sizeof path, "%s/key", directory);
	assert_int_equal(gz_key_file_read_secret(path, &captured.log, key), GZ_ERR_NOT_FOUND);
	assert_int_equal(captured.messages, 0);
	assert_int_equal(mkfifo(path, 0600), 0); /* nobody writes into it; reading must not wait */
	assert_int_equal(gz_key_file_read_secret(path, &captured.log, key), GZ_ERR_ACCESS);
	assert_non_null(strstr(captured.last, "is not a regular file"));
	assert_int_equal(unlink(path), 0);
	FILE *file = fopen(path, "w");
	for (int i = 0; i <= GZ_KEY_FILE_SIZE_MAX; i++)
		fputc('\n', file);
	fclose(file);
	assert_int_equal(chmod(path, 0600), 0);
	assert_int_equal(gz_key_file_read_secret(path, &captured.log, key), GZ_ERR_FORMAT);
	assert_non_null(strstr(captured.last, "is longer than 65536 bytes"));
	unlink(path);
	assert_int_equal(rmdir(directory), 0);
}

TEST_SUITE(key)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test_setup(key_is_valid_where_libzmq_decodes_it, set_up),
		cmocka_unit_test_setup(key_of_any_character_is_judged_as_libzmq_does, set_up),
		cmocka_unit_test_setup(key_file_holds_one_key_among_comments, set_up),
		cmocka_unit_test_setup(key_file_of_anything_else_is_refused_without_showing_it,
				       set_up),
		cmocka_unit_test_setup(list_of_clients_has_keys_and_comments, set_up),
		cmocka_unit_test_setup(list_of_servers_finds_a_host_by_any_of_its_names, set_up),
		cmocka_unit_test_setup(list_with_a_bad_line_is_refused_by_its_number, set_up),
		cmocka_unit_test_setup(list_longer_than_its_room_is_refused, set_up),
		cmocka_unit_test_setup(key_file_that_is_no_file_of_keys_is_refused, set_up),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
