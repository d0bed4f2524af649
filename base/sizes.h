/**
 * @file
 * Sizes of the texts in structs.
 */
#ifndef GZ_BASE_SIZES_H
#define GZ_BASE_SIZES_H

#define GZ_NAME_SIZE 64   /**< a name with its NUL, bytes */
#define GZ_PATH_SIZE 1024 /**< a path with its NUL, bytes */

#endif
