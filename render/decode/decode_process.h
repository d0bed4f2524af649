/* A decoder's process: started with its descriptors, ended, and why it ended. For this room. */
#ifndef GZ_RENDER_DECODE_PROCESS_H
#define GZ_RENDER_DECODE_PROCESS_H

#include <sys/types.h>

#include "render/decode/decode.h"

/** A process. */
struct gz_decode_process {
	pid_t pid;       /**< 0: none */
	int messages;    /**< to read from, does not block; -1: none */
	int answers;     /**< to write to; -1: none */
	int answers_end; /**< the decoder's end of it, kept open: writing to a decoder that has died
			    then raises no signal */
	int memory;      /**< the memfd; -1: none */
};

/** No process. */
#define GZ_DECODE_NO_PROCESS ((struct gz_decode_process) { 0, -1, -1, -1, -1 })

/** Start the decoder of @p job. On failure @p process has what gz_decode_process_end() ends.
 * GZ_ERR_NO_MEM, GZ_ERR_ACCESS; logged. */
enum gz_result gz_decode_process_start(const struct gz_decode_job *job,
				       struct gz_decode_process *process);

/** Kill it, wait for its end and close the pipes; the memfd stays. @return its status as of
 *  waitpid(); 0 if there was none. */
int gz_decode_process_stop(struct gz_decode_process *process);

/** Stop it and close the memfd. */
void gz_decode_process_end(struct gz_decode_process *process);

#endif
