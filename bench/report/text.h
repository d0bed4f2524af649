/**
 * @file
 * What HTML wants of text: escaping and base64.
 */
#ifndef GZ_BENCH_REPORT_TEXT_H
#define GZ_BENCH_REPORT_TEXT_H

#include "base/text.h"

/** Append @p plain for HTML and XML: & < > " ' are escaped, and bytes of no text are left out. */
void gz_text_add_escaped(struct gz_text *text, const char *plain);

/** Append @p size bytes in base64 (RFC 4648, section 4). */
void gz_text_add_base64(struct gz_text *text, const void *bytes, size_t size);

#endif
