#include "suite.h"

#include <stdio.h>
#include <string.h>
#include <zmq.h>

#include "daemon/admission.h"

static const unsigned char key[32] = { 1, 2, 3, 255 };

#define FRAME(text)                     \
	{                               \
		text, sizeof(text) - 1, \
	}

/* A request as libzmq writes it. */
static void fill(struct gz_zap_frame frames[GZ_ZAP_FRAMES + 1])
{
	const struct gz_zap_frame request[GZ_ZAP_FRAMES + 1] = {
		FRAME("1.0"), FRAME("7"),     FRAME("gazecast"),   FRAME("192.168.0.9"),
		FRAME(""),    FRAME("CURVE"), { key, sizeof key }, FRAME("more"),
	};
	memcpy(frames, request, sizeof request);
}

static void zap_request_tells_address_and_key(void **state)
{
	(void)state;
	struct gz_zap_frame frames[GZ_ZAP_FRAMES + 1];
	struct gz_zap_request request;
	char wanted[GZ_KEY_TEXT_SIZE];
	fill(frames);
	assert_int_equal(gz_zap_parse(frames, GZ_ZAP_FRAMES, &request), GZ_OK);
	assert_int_equal(request.id_size, 1);
	assert_int_equal(request.id[0], '7');
	assert_string_equal(request.address, "192.168.0.9");
	assert_string_equal(request.key, zmq_z85_encode(wanted, key, sizeof key));
}

static void zap_request_cut_anywhere_is_refused(void **state)
{
	(void)state;
	struct gz_zap_frame frames[GZ_ZAP_FRAMES + 1];
	struct gz_zap_request request;
	for (size_t count = 0; count <= GZ_ZAP_FRAMES + 1; count++) {
		fill(frames);
		enum gz_result result = gz_zap_parse(frames, count, &request);
		if ((result == GZ_OK) != (count == GZ_ZAP_FRAMES))
			fail_msg("%zu frames: %d", count, result);
		/* As soon as there is an id, a reply is owed. */
		assert_int_equal(request.id_size, count > 1 ? 1 : 0);
	}
}

static void zap_request_of_another_kind_is_refused(void **state)
{
	(void)state;
	static const struct {
		size_t frame;
		struct gz_zap_frame with;
	} cases[] = {
		{ 0, FRAME("1.1") },
		{ 0, FRAME("1.0\0") },
		{ 0, FRAME("") },
		{ 5, FRAME("NULL") },
		{ 5, FRAME("PLAIN") },
		{ 5, FRAME("CURVE\0") },
		{ 6, { key, 31 } },
		{ 6, { key, 0 } },
		{ 6, FRAME("Yne@$w-vo<fVvi]a<NY6T1ed:M$fCG*[IaLV{hID") },
	};
	for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
		struct gz_zap_frame frames[GZ_ZAP_FRAMES + 1];
		struct gz_zap_request request;
		fill(frames);
		frames[cases[i].frame] = cases[i].with;
		enum gz_result result = gz_zap_parse(frames, GZ_ZAP_FRAMES, &request);
		if (result != GZ_ERR_ACCESS || request.id_size != 1)
			fail_msg("case %zu: %d", i, result);
	}
}

static void zap_request_with_an_endless_id_is_refused(void **state)
{
	(void)state;
	struct gz_zap_frame frames[GZ_ZAP_FRAMES + 1];
	struct gz_zap_request request;
	static const char id[GZ_ZAP_ID_SIZE_MAX + 1];
	fill(frames);
	frames[1] = (struct gz_zap_frame) { id, GZ_ZAP_ID_SIZE_MAX };
	assert_int_equal(gz_zap_parse(frames, GZ_ZAP_FRAMES, &request), GZ_OK);
	frames[1].size++;
	assert_int_equal(gz_zap_parse(frames, GZ_ZAP_FRAMES, &request), GZ_ERR_PROTOCOL);
	assert_int_equal(request.id_size, 0);
}

static void zap_address_is_cut_and_cannot_steer_a_terminal(void **state)
{
	(void)state;
	struct gz_zap_frame frames[GZ_ZAP_FRAMES + 1];
	struct gz_zap_request request;
	char address[200];
	fill(frames);
	memset(address, 'a', sizeof address);
	memcpy(address, "\033[2J\0", 5);
	frames[3] = (struct gz_zap_frame) { address, sizeof address };
	assert_int_equal(gz_zap_parse(frames, GZ_ZAP_FRAMES, &request), GZ_OK);
	assert_int_equal(strlen(request.address), GZ_ADDRESS_SIZE - 1);
	assert_memory_equal(request.address, "?[2J?aaa", 8);
	frames[3].size = 0;
	assert_int_equal(gz_zap_parse(frames, GZ_ZAP_FRAMES, &request), GZ_OK);
	assert_string_equal(request.address, "?");
}

TEST_SUITE(zap)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(zap_request_tells_address_and_key),
		cmocka_unit_test(zap_request_cut_anywhere_is_refused),
		cmocka_unit_test(zap_request_of_another_kind_is_refused),
		cmocka_unit_test(zap_request_with_an_endless_id_is_refused),
		cmocka_unit_test(zap_address_is_cut_and_cannot_steer_a_terminal),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
