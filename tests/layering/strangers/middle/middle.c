/* Not compiled: what the test of the rooms must find. */
#include "low/low.h"
