/*
 * Which parts an image carries. A build may leave out some that do not fit its controller,
 * STEADYSTEP_WITHOUT_.... The settings of what is left out keep the value without it. Any other is
 * refused by name, and one that is stored is passed over, and named.
 */
#ifndef STEADYSTEP_PARTS_CARRIED_H
#define STEADYSTEP_PARTS_CARRIED_H

#ifdef STEADYSTEP_WITHOUT_LINK
enum { LINK_CARRIED = 0 };
#else
enum { LINK_CARRIED = 1 };
#endif

#ifdef STEADYSTEP_WITHOUT_MACHINE_IO
enum { MACHINE_IO_CARRIED = 0 };
#else
enum { MACHINE_IO_CARRIED = 1 };
#endif

/* The reading of an encoder. */
#ifdef STEADYSTEP_WITHOUT_ENCODER
enum { ENCODER_CARRIED = 0 };
#else
enum { ENCODER_CARRIED = 1 };
#endif

/* Without it the loops are as they are designed. */
#ifdef STEADYSTEP_WITHOUT_BELT_WATCH
enum { WATCHES_BELT = 0 };
#else
enum { WATCHES_BELT = 1 };
#endif

/* Without it the settings' torque constant is in force. */
#ifdef STEADYSTEP_WITHOUT_TORQUE_CONSTANT
enum { LEARNS_TORQUE_CONSTANT = 0 };
#else
enum { LEARNS_TORQUE_CONSTANT = 1 };
#endif

/* Without it the settings' inductance is in force. */
#ifdef STEADYSTEP_WITHOUT_INDUCTANCE
enum { FINDS_INDUCTANCE = 0 };
#else
enum { FINDS_INDUCTANCE = 1 };
#endif

/* All that have settings. */
enum {
    SETTINGS_CARRIED = LINK_CARRIED && MACHINE_IO_CARRIED && ENCODER_CARRIED && FINDS_INDUCTANCE
};

#endif
