/* gazedecode: decodes one file with a library of another project and gives its voxels to the
 * program that started it. It is not for users: the arguments are those of
 * render/decode/decode_protocol.h. */
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/text.h"
#include "render/decode/child/confine.h"
#include "render/decode/child/decoder.h"
#include "render/decode/dicom/dicom_list.h"
#include "render/decode/dicom/dicom_load.h"
#include "render/decode/minc/minc_load.h"

#define GZ_LOG_MODULE "decode"

/* What is to be decoded. */
struct task {
	struct gz_volume_file file;
	const char *choice; /* NULL: none */
	const struct gz_decode_listener *listener;
};

static enum gz_result load_dicom_series(const struct task *task, struct gz_volume *out_volume)
{
	return gz_dicom_load(&task->file, task->choice, out_volume);
}

static enum gz_result load_or_list_dicom(const struct task *task, struct gz_volume *out_volume)
{
	return gz_dicom_load_or_list(&task->file, task->listener, out_volume);
}

static enum gz_result list_dicom(const struct task *task, struct gz_volume *out_volume)
{
	(void)out_volume;
	return gz_dicom_list(&task->file, task->listener, NULL);
}

static enum gz_result load_minc(const struct task *task, struct gz_volume *out_volume)
{
	return gz_minc_load(&task->file, task->choice, out_volume);
}

/* One decoder. */
struct decoder_row {
	const char *name;
	void (*prepare)(void); /* before the process is confined: opens what its libraries need;
				  NULL: nothing */
	enum gz_result (*load)(const struct task *task, struct gz_volume *out_volume);
};

static const struct decoder_row decoders[] = {
	{ "dicom", gz_dicom_prepare_texts, load_dicom_series },
	{ "dicom-choose", gz_dicom_prepare_texts, load_or_list_dicom },
	{ "dicom-list", gz_dicom_prepare_texts, list_dicom },
	{ "minc", NULL, load_minc },
};

static bool resampling_named(const char *name, enum gz_resampling *out_resampling)
{
	for (int i = 0; gz_resampling_names[i]; i++)
		if (strcmp(gz_resampling_names[i], name) == 0) {
			*out_resampling = (enum gz_resampling)i;
			return true;
		}
	return false;
}

static const struct decoder_row *decoder_named(const char *name)
{
	for (size_t i = 0; i < sizeof decoders / sizeof decoders[0]; i++)
		if (strcmp(decoders[i].name, name) == 0)
			return &decoders[i];
	return NULL;
}

int main(int argc, char **argv)
{
	struct gz_decoder decoder;
	struct gz_volume volume = { 0 };
	char protection[GZ_CONFINE_TEXT_SIZE];
	long long parent = 0;
	const struct decoder_row *row = argc == 8 ? decoder_named(argv[2]) : NULL;
	gz_decoder_init(&decoder);
	if (!row || !gz_number_parse_whole(argv[1], &parent) ||
	    !gz_decoder_take_series(&decoder, argv[5], argv[6]) ||
	    !resampling_named(argv[7], &decoder.loading.resampling)) {
		fprintf(stderr, "gazedecode is started by gazeview and has no use of its own\n");
		return 2;
	}
	if (row->prepare)
		row->prepare();
	if (gz_confine((pid_t)parent, argv[3], protection) != GZ_OK) {
		gz_err(&decoder.log, "%s: its decoder cannot be confined; it was not read",
		       argv[3]);
		gz_decoder_end(GZ_ERR_IO, NULL);
	}
	gz_debug(&decoder.log, "%s: its decoder is confined by: %s", argv[3], protection);
	const struct task task = {
		.file = { argv[3], NULL, &decoder.loading, &decoder.log },
		.choice = argv[4][0] ? argv[4] : NULL,
		.listener = &decoder.listener,
	};
	/* The voxels are the parent's: they are not freed here. */
	const enum gz_result result = row->load(&task, &volume);
	gz_decoder_end(result, &volume);
}
