/*
 * Where the firmware is optimised into one object (tools/cmake/FirmwareObject.cmake), what
 * programs outside it call keeps its name, all else may be inlined, specialised or left out.
 */
#ifndef STEADYSTEP_LINKAGE_H
#define STEADYSTEP_LINKAGE_H

#if defined(__GNUC__) && !defined(__clang__)
#define CALLED_FROM_OUTSIDE __attribute__((externally_visible))
#else
#define CALLED_FROM_OUTSIDE
#endif

#endif
