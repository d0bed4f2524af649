#include "bench/study/machine.h"

#include <sched.h>
#include <stdio.h>
#include <string.h>
#include <sys/utsname.h>
#include <unistd.h>

#include "bench/study/hash.h"

/* The value of the first line "name<blanks>between<blanks>value" of a file, without quotes. */
static void find_value(const char *path, const char *name, char between,
		       char out_value[GZ_STUDY_TEXT_SIZE])
{
	FILE *file = fopen(path, "re");
	char line[1024];
	snprintf(out_value, GZ_STUDY_TEXT_SIZE, "unknown");
	while (file && fgets(line, sizeof line, file)) {
		char *value = strchr(line, between);
		if (strncmp(line, name, strlen(name)) != 0 || !value)
			continue;
		value += 1 + strspn(value + 1, " \t\"");
		value[strcspn(value, "\"\n")] = '\0';
		snprintf(out_value, GZ_STUDY_TEXT_SIZE, "%.200s", value);
		break;
	}
	if (file)
		fclose(file);
}

void gz_study_machine_describe(struct gz_study_machine *out_machine)
{
	char text[GZ_STUDY_TEXT_SIZE];
	cpu_set_t processors;
	const int count = sched_getaffinity(0, sizeof processors, &processors) == 0
				  ? CPU_COUNT(&processors)
				  : 0;
	find_value("/proc/cpuinfo", "model name", ':', text);
	snprintf(out_machine->host_cpu, GZ_STUDY_TEXT_SIZE, "%.200s, %d processors", text, count);
	const double bytes = (double)sysconf(_SC_PHYS_PAGES) * (double)sysconf(_SC_PAGE_SIZE);
	snprintf(out_machine->memory, GZ_STUDY_TEXT_SIZE, "%.1f GiB", bytes / (1 << 30));
	struct utsname kernel;
	find_value("/etc/os-release", "PRETTY_NAME", '=', text);
	if (uname(&kernel) == 0)
		snprintf(out_machine->system, GZ_STUDY_TEXT_SIZE, "%.40s %.80s, %.100s",
			 kernel.sysname, kernel.release, text);
	else
		snprintf(out_machine->system, GZ_STUDY_TEXT_SIZE, "%.200s", text);
	snprintf(out_machine->compiler, GZ_STUDY_TEXT_SIZE, "%s%.150s, %s",
#ifdef __clang__
		 "",
#else
		 "gcc ",
#endif
		 __VERSION__, GZ_BUILD_TYPE);
}

/* SHA-256 of a file; false where it cannot be read. */
static bool hash_file(const char *path, char out_hex[GZ_STUDY_HASH_SIZE])
{
	FILE *file = fopen(path, "re");
	struct gz_hash *hash = NULL;
	unsigned char bytes[16384];
	size_t size;
	if (!file)
		return false;
	if (gz_hash_begin(&hash) != GZ_OK) {
		fclose(file);
		return false;
	}
	while ((size = fread(bytes, 1, sizeof bytes, file)) > 0)
		gz_hash_add(hash, bytes, size);
	const bool whole = !ferror(file);
	fclose(file);
	return gz_hash_end(&hash, out_hex) == GZ_OK && whole;
}

void gz_study_identify(const char *commit, const char *file, char out_text[GZ_STUDY_TEXT_SIZE])
{
	static const char dirty[] = "-dirty";
	const size_t length = strlen(commit), end = sizeof dirty - 1;
	char hex[GZ_STUDY_HASH_SIZE];
	const bool says_all = strcmp(commit, "unknown") != 0 &&
			      (length < end || strcmp(commit + length - end, dirty) != 0);
	if (!says_all && hash_file(file, hex))
		snprintf(out_text, GZ_STUDY_TEXT_SIZE, "%.200s-%.12s", commit, hex);
	else
		snprintf(out_text, GZ_STUDY_TEXT_SIZE, "%.200s", commit);
}
