/**
 * @file
 * Memory for grids of light: one number of 16 bits a cell, kept from one grid to the next.
 */
#ifndef GZ_RENDER_LIGHT_LIGHT_CELLS_H
#define GZ_RENDER_LIGHT_LIGHT_CELLS_H

#include <stddef.h>
#include <stdint.h>

#include "base/result.h"

/**
 * Make room for cells, and for GZ_VOLUME_PADDING bytes behind them. New memory is zero; what is
 * large enough stays as it is.
 *
 * @param[in,out] cells     freed with free(); NULL if there is no memory
 * @param[in,out] capacity  cells that fit; 0 at first
 * @retval GZ_ERR_NO_MEM  there are no cells; not logged
 */
enum gz_result gz_light_cells_reserve(size_t count, uint16_t **cells, size_t *capacity);

#endif
