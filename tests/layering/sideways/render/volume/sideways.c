/* Not compiled: what the test of the folders of render/ must find. */
#include "render/cpu/cast.h"
#include "render/volume/volume.h"
