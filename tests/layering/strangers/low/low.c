/* Not compiled: what the test of the rooms must find. */
#include "middle/middle.h"
