/* Not compiled: a room reaches what the rooms that it names reach. */
#include "low/low.h"
#include "middle/middle.h"
