/**
 * @file
 * Texts in PNG files: what a picture says of itself.
 */
#ifndef GZ_RENDER_PICTURE_PNG_TEXT_H
#define GZ_RENDER_PICTURE_PNG_TEXT_H

#include <stdio.h>

#include "base/result.h"
#include "base/text.h"

/** Longest text that is read, bytes. Chosen: as long as the longest scene. */
#define GZ_PNG_TEXT_MAX ((size_t)1 << 20)

/**
 * Find the first text with a keyword: chunks tEXt, zTXt and iTXt (PNG third edition, sections
 * 11.3.3.2 to 11.3.3.4), compressed or not. Pixels are not looked at.
 *
 * @param file      at the beginning of a PNG; moved
 * @param keyword   1 to 79 bytes
 * @param[out] out_text  empty before; the text's bytes
 * @retval GZ_ERR_NOT_FOUND  no text has the keyword; not logged, as the others
 * @retval GZ_ERR_FORMAT     no PNG, cut off, a checksum is wrong, or the text is too long
 * @retval GZ_ERR_NO_MEM
 */
enum gz_result gz_png_text_find(FILE *file, const char *keyword, struct gz_text *out_text);

#endif
