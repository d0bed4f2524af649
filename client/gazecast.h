/**
 * @file
 * Everything an application needs of Gazecast: the latest gaze (client.h), every message (stream.h)
 * and requests to the daemon (control.h). Link with `pkg-config --cflags --libs gazecast`;
 * gazecast(3) has an example.
 */
#ifndef GAZECAST_H
#define GAZECAST_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#include "base/clock.h"
#include "base/log.h"
#include "base/result.h"
#include "client/client.h"
#include "client/control.h"
#include "client/keys.h"
#include "client/stream.h"
#include "protocol/display.h"
#include "protocol/gaze.h"

#ifdef __cplusplus
}
#endif

#endif
