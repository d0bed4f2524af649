/* Whatever a Gazepoint server sends: framing, XML and numbers. The first byte says in what pieces
 * it arrives. */
#include <math.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "drivers/gazepoint/gazepoint_protocol.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static void require(bool holds)
{
	if (!holds)
		abort();
}

static void check_record(const struct gz_gazepoint_record *record)
{
	int64_t frequency_hz = gz_gazepoint_frequency_hz(record->frequency);
	require(record->kind <= GZ_GAZEPOINT_OTHER);
	require(memchr(record->id, '\0', sizeof record->id) != NULL);
	require(memchr(record->value, '\0', sizeof record->value) != NULL);
	require(!isinf(record->best[0]) && !isinf(record->time_s));
	require(frequency_hz == 0 || (frequency_hz >= 1000 && frequency_hz <= 9000000000));
}

static void take_records(struct gz_gazepoint_xml *xml, struct gz_gazepoint_framer *framer)
{
	for (;;) {
		const char *text;
		size_t size;
		enum gz_malformed reason = GZ_MALFORMED_COUNT;
		struct gz_gazepoint_record record;
		enum gz_result result = gz_gazepoint_framer_next(framer, &text, &size);
		if (result == GZ_ERR_TIMEOUT)
			return;
		if (result != GZ_OK)
			continue;
		require(size > 0 && size < GZ_GAZEPOINT_RECORD_MAX);
		if (gz_gazepoint_parse(xml, text, size, &record, &reason) == GZ_OK)
			check_record(&record);
		else
			require(reason == GZ_MALFORMED_SYNTAX || reason == GZ_MALFORMED_VALUE);
	}
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	static struct gz_gazepoint_xml *xml;
	static struct gz_gazepoint_framer framer;
	if (size < 1 || (!xml && gz_gazepoint_xml_create(&xml) != GZ_OK))
		return 0;
	memset(&framer, 0, sizeof framer);
	size_t piece = (size_t)data[0] * 16 + 1;
	for (size_t fed = 1; fed < size;) {
		size_t room, count = piece < size - fed ? piece : size - fed;
		char *at = gz_gazepoint_framer_room(&framer, &room);
		require(room > 0);
		count = count < room ? count : room;
		memcpy(at, data + fed, count);
		gz_gazepoint_framer_add(&framer, count);
		fed += count;
		take_records(xml, &framer);
	}
	return 0;
}
