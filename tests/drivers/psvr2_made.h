/**
 * @file
 * Packets of a PlayStation VR2 for tests: the one place that lays them out. By the offsets of the
 * public descriptions (drivers/psvr2/psvr2_packet.h), not by those of the parser under test.
 */
#ifndef GZ_TESTS_DRIVERS_PSVR2_MADE_H
#define GZ_TESTS_DRIVERS_PSVR2_MADE_H

#include "drivers/psvr2/psvr2_packet.h"

/** Offsets of fields that tests damage. An eye begins with its ray: the flag and numbers of the
 * origin, then those of the direction at PSVR2_AT_DIRECTION. */
enum {
	PSVR2_AT_TIME = 0x50,
	PSVR2_AT_FRAME = 0x58,
	PSVR2_AT_LEFT = 0x5c,
	PSVR2_AT_RIGHT = 0xa4,
	PSVR2_AT_COMBINED = 0xec,
	PSVR2_AT_DIRECTION = 0x10,
	PSVR2_AT_PUPIL = 0x20,
	PSVR2_AT_BLINK = 0x40,
	PSVR2_AT_CONVERGENCE = 0x144,
};

/** Lay out @p packet. Directions need not be of unit length; device_ns is cut to whole us. */
void psvr2_made_packet(const struct gz_psvr2_packet *packet,
		       unsigned char bytes[GZ_PSVR2_PACKET_SIZE]);

#endif
