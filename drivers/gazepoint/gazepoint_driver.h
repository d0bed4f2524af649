/**
 * @file
 * Gazepoint GP3 and GP3 HD, through Gazepoint Control's server (TCP, port 4242), on this machine or
 * another. What it says: gazepoint_protocol.h.
 *
 * Connecting never waits longer than GZ_GAZEPOINT_CONNECT_MS; the look-up of a host's name may take
 * some seconds where no name server answers. A server that goes away, or says nothing for
 * GZ_GAZEPOINT_SILENCE_MS, is a device that is unplugged: the daemon closes it and looks for it
 * again, with growing pauses.
 */
#ifndef GZ_DRIVERS_GAZEPOINT_DRIVER_H
#define GZ_DRIVERS_GAZEPOINT_DRIVER_H

#include "drivers/driver.h"

/** Longest wait for a connection, ms. Chosen: many round trips of any laboratory's network. */
#define GZ_GAZEPOINT_CONNECT_MS 300

/** Longest wait for the server's answers about the tracker before its stream is asked for, ms.
 * Chosen: as above; answers that come later are taken, too. */
#define GZ_GAZEPOINT_ANSWER_MS 300

/** A server that says nothing for so long has gone, ms: it sends a record for each camera picture,
 * whether or not it finds an eye. Chosen: 180 pictures of the slowest tracker. */
#define GZ_GAZEPOINT_SILENCE_MS 3000

extern const struct gz_driver gz_driver_gazepoint;

#endif
