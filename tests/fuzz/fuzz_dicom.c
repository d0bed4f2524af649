/* DICOM files from anywhere: images, segmentations and dose. */
#include "fuzz/decoder_case.h"
#include "render/decode/dicom/dicom_load.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	run_decoder_case(gz_dicom_load, "a.dcm", data, size);
	return 0;
}
