/**
 * @file
 * What a study runs on.
 */
#ifndef GZ_BENCH_STUDY_MACHINE_H
#define GZ_BENCH_STUDY_MACHINE_H

#include "bench/study/study.h"

/** Describe this machine and build: host_cpu, memory, system and compiler. "unknown" stands for
 *  what cannot be told. */
void gz_study_machine_describe(struct gz_study_machine *out_machine);

/**
 * The commit of a program, so that two programs of one commit are told apart where somebody has
 * changed files since: behind a commit that does not say all, "unknown" or one that ends with
 * "-dirty", stand the first digits of the SHA-256 of the program's own file.
 *
 * @param commit        as cmake/commit.cmake tells it
 * @param file          of the program: "/proc/self/exe" is the one that runs. One that cannot be
 *                      read adds nothing
 * @param[out] out_text  "0123abc", "0123abc-dirty-89ab01cd45ef"
 */
void gz_study_identify(const char *commit, const char *file, char out_text[GZ_STUDY_TEXT_SIZE]);

#endif
