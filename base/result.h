/**
 * @file
 * The result code of every call that can fail.
 */
#ifndef GZ_BASE_RESULT_H
#define GZ_BASE_RESULT_H

/** Result of a fallible call: 0 on success, negative on failure. */
enum gz_result {
	GZ_OK = 0,
	GZ_ERR_INVAL = -1,        /**< an argument is outside its documented range */
	GZ_ERR_NO_DEVICE = -2,    /**< the tracker was unplugged or never present */
	GZ_ERR_ACCESS = -3,       /**< the operating system refused */
	GZ_ERR_TIMEOUT = -4,      /**< nothing arrived in the time allowed */
	GZ_ERR_PROTOCOL = -5,     /**< bytes from outside do not form a valid message */
	GZ_ERR_NO_MEM = -6,       /**< an allocation failed */
	GZ_ERR_IO = -7,           /**< reading or writing failed */
	GZ_ERR_NOT_FOUND = -8,    /**< no such file, key, driver or scene */
	GZ_ERR_FORMAT = -9,       /**< a file's content does not have the expected format */
	GZ_ERR_UNSUPPORTED = -10, /**< valid, but not supported by this build */
	GZ_ERR_BUSY = -11,        /**< already in use: an endpoint, a lock, a recording */
	GZ_ERR_END = -12,         /**< the stream or file has ended; not an error */
	GZ_ERR_FULL = -13,        /**< no room left: disk, buffer, queue */
	GZ_ERR_CANCELLED = -14,   /**< the caller asked to stop early */
	GZ_ERR_CHOICE = -15,      /**< there are several; the caller must choose one */
};

/**
 * A short English phrase for @p result: lower case, no full stop.
 *
 * @param result  any value, including one outside the enum
 * @return static text, never NULL; "unknown result" for a value outside the enum
 *
 * Threads: any.
 */
const char *gz_result_text(enum gz_result result);

#endif
