/* DICOM files from anywhere: images, segmentations and dose, with slices as they lie and resampled.
 */
#include "fuzz/decoder_case.h"
#include "render/decode/dicom/dicom_load.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	write_decoder_case("a.dcm", data, size);
	for (int i = 0; i < GZ_RESAMPLING_COUNT; i++) {
		const struct gz_loading loading = { .resampling = (enum gz_resampling)i };
		run_decoder_case(gz_dicom_load, &loading);
	}
	return 0;
}
