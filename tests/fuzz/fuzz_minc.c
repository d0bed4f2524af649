/* MINC 2 files from anywhere. */
#include "fuzz/decoder_case.h"
#include "render/decode/minc/minc_load.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	write_decoder_case("a.mnc", data, size);
	run_decoder_case(gz_minc_load, NULL);
	return 0;
}
