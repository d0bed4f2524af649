/* Runs a fuzz target over every file of the folders named on the command line: what a build without
 * libFuzzer has instead of its main(). */
#include <dirent.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static int run_file(const char *path)
{
	FILE *file = fopen(path, "rb");
	if (!file || fseek(file, 0, SEEK_END) != 0)
		return -1;
	long size = ftell(file);
	rewind(file);
	/* An exact allocation, so that a sanitizer sees the first byte read past the end. */
	uint8_t *data = size > 0 ? malloc((size_t)size) : NULL;
	size_t got = data ? fread(data, 1, (size_t)size, file) : 0;
	fclose(file);
	if (size < 0 || got != (size_t)size) {
		free(data);
		return -1;
	}
	LLVMFuzzerTestOneInput(data, got);
	free(data);
	return 0;
}

int main(int argc, char **argv)
{
	int runs = 0;
	for (int i = 1; i < argc; i++) {
		DIR *folder = opendir(argv[i]);
		if (!folder) {
			fprintf(stderr, "no corpus in %s\n", argv[i]);
			return 1;
		}
		for (struct dirent *entry; (entry = readdir(folder));) {
			char path[4096];
			if (entry->d_name[0] == '.')
				continue;
			snprintf(path, sizeof path, "%s/%s", argv[i], entry->d_name);
			if (run_file(path) != 0) {
				fprintf(stderr, "cannot read %s\n", path);
				return 1;
			}
			runs++;
		}
		closedir(folder);
	}
	printf("%d inputs\n", runs);
	return runs > 0 ? 0 : 1;
}
