/* MINC 2 files from anywhere. */
#include "fuzz/decoder_case.h"
#include "render/decode/minc/minc_load.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	run_decoder_case(gz_minc_load, "a.mnc", data, size);
	return 0;
}
