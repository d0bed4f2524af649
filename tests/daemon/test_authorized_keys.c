#include "suite.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/captured_log.h"
#include "daemon/admission.h"

static const char key_a[] = "Yne@$w-vo<fVvi]a<NY6T1ed:M$fCG*[IaLV{hID";
static const char key_b[] = "rq:rM>}U?@Lns47E1%kR.o@n%FcmmsL/@{H8]yf7";

static struct captured_log captured;
static struct gz_authorized_keys keys;
static char directory[32], path[64];

static int set_up(void **state)
{
	(void)state;
	captured_log_init(&captured, NULL);
	snprintf(directory, sizeof directory, "/tmp/gz_keys_XXXXXX");
	assert_non_null(mkdtemp(directory));
	snprintf(path, sizeof path, "%s/authorized_keys", directory);
	return 0;
}

static int tear_down(void **state)
{
	(void)state;
	unlink(path);
	rmdir(directory);
	return 0;
}

static void write_keys(const char *first, const char *second)
{
	FILE *file = fopen(path, "w");
	assert_non_null(file);
	fprintf(file, "%s one\n%s two\n", first, second);
	assert_int_equal(fclose(file), 0);
}

static void keys_are_looked_up_in_the_file_as_it_is(void **state)
{
	(void)state;
	write_keys(key_a, "");
	assert_int_equal(truncate(path, GZ_KEY_LENGTH + 5), 0);
	assert_int_equal(gz_authorized_keys_open(&keys, path, &captured.log), GZ_OK);
	assert_int_equal(captured.messages, 0);
	assert_string_equal(gz_authorized_keys_find(&keys, key_a)->name, "one");
	assert_null(gz_authorized_keys_find(&keys, key_b));
	write_keys(key_a, key_b);
	assert_string_equal(gz_authorized_keys_find(&keys, key_b)->name, "two");
	assert_int_equal(captured.messages, 1);
	/* Nothing has changed, so nothing is read or logged. */
	assert_non_null(gz_authorized_keys_find(&keys, key_a));
	assert_int_equal(captured.messages, 1);
	/* The same length, and perhaps the same second. */
	write_keys(key_b, key_b);
	assert_null(gz_authorized_keys_find(&keys, key_a));
	assert_int_equal(unlink(path), 0);
	assert_null(gz_authorized_keys_find(&keys, key_b));
	assert_non_null(strstr(captured.last, "no client is let in until"));
}

static void keys_of_a_missing_file_may_come_later(void **state)
{
	(void)state;
	assert_int_equal(gz_authorized_keys_open(&keys, path, &captured.log), GZ_OK);
	assert_non_null(strstr(captured.last, "does not exist, so no client is let in"));
	assert_null(gz_authorized_keys_find(&keys, key_a));
	assert_int_equal(captured.messages, 1);
	write_keys(key_a, key_b);
	assert_non_null(gz_authorized_keys_find(&keys, key_a));
}

static void keys_of_a_damaged_or_unsafe_file_let_nobody_in(void **state)
{
	(void)state;
	write_keys(key_a, "oops");
	assert_int_equal(gz_authorized_keys_open(&keys, path, &captured.log), GZ_ERR_FORMAT);
	assert_non_null(strstr(captured.last, "authorized_keys:2: no key"));
	write_keys(key_a, key_b);
	assert_int_equal(gz_authorized_keys_open(&keys, path, &captured.log), GZ_OK);
	assert_int_equal(chmod(path, 0622), 0);
	assert_null(gz_authorized_keys_find(&keys, key_a));
	int messages = captured.messages;
	assert_null(gz_authorized_keys_find(&keys, key_a));
	assert_int_equal(captured.messages, messages);
	assert_int_equal(chmod(path, 0644), 0);
	assert_non_null(gz_authorized_keys_find(&keys, key_a));
}

TEST_SUITE(authorized_keys)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test_setup_teardown(keys_are_looked_up_in_the_file_as_it_is, set_up,
						tear_down),
		cmocka_unit_test_setup_teardown(keys_of_a_missing_file_may_come_later, set_up,
						tear_down),
		cmocka_unit_test_setup_teardown(keys_of_a_damaged_or_unsafe_file_let_nobody_in,
						set_up, tear_down),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
