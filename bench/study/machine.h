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

#endif
