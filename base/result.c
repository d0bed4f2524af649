#include "base/result.h"

const char *gz_result_text(enum gz_result result)
{
	switch (result) {
	case GZ_OK:
		return "success";
	case GZ_ERR_INVAL:
		return "argument out of range";
	case GZ_ERR_NO_DEVICE:
		return "no such device";
	case GZ_ERR_ACCESS:
		return "access refused by the operating system";
	case GZ_ERR_TIMEOUT:
		return "timed out";
	case GZ_ERR_PROTOCOL:
		return "malformed message";
	case GZ_ERR_NO_MEM:
		return "out of memory";
	case GZ_ERR_IO:
		return "input or output failed";
	case GZ_ERR_NOT_FOUND:
		return "not found";
	case GZ_ERR_FORMAT:
		return "malformed file";
	case GZ_ERR_UNSUPPORTED:
		return "not supported";
	case GZ_ERR_BUSY:
		return "already in use";
	case GZ_ERR_END:
		return "end of stream";
	case GZ_ERR_FULL:
		return "no space left";
	case GZ_ERR_CANCELLED:
		return "stopped on request";
	case GZ_ERR_CHOICE:
		return "one of several must be chosen";
	}
	return "unknown result";
}
