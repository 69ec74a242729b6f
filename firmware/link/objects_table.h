/*
 * The objects of the dictionary that CiA 301 and 402 lay down, declared once: a row for each
 * sub-index, and those of the capture. The drive's own, settings, commands and signals, are rows of
 * firmware/interface. From the rows follow the members of struct link_objects, their defaults, what
 * the slave serves and the sheet steadystep.eds. To add an object: a row, and what makes use of it.
 *
 *   GROUP(index, name)                                       of an index with several sub-indexes
 *   STORED(index, sub, type, access, member, preset, name)   a member of struct link_objects
 *   ASKED(index, sub, type, access, preset, name)            link_objects.c, cia402_objects.c
 * answer
 *
 * - access: RO, RW, WO; _T: may be mapped into a PDO that is sent, _R: that is received; NODE: the
 *   node's number is added to the preset.
 * - Of 1400h, 1600h, 1800h and 1a00h there are four each, one behind the other; the rows show the
 *   first. Of a mapping and of 60e3h a row stands for as many as LINK_OBJECT_ENTRIES has.
 * - Bytes that count sub-indexes stand last: members lie in the rows' order, and a byte between
 * wider ones takes four.
 */
#ifndef STEADYSTEP_OBJECTS_TABLE_H
#define STEADYSTEP_OBJECTS_TABLE_H

/* The methods of homing in 60e3h: those that take an encoder's index last. */
#define LINK_HOMING_METHODS                                                                        \
    37, 35, -1, -2, 17, 18, 19, 20, 21, 22, 23, 24, 25, 26, 27, 28, 29, 30, 33, 34

enum { LINK_HOMING_METHODS_IN_ALL = 20, LINK_HOMING_METHODS_ON_INDEX = 2, LINK_PDO_OBJECTS = 8 };

/* For how many sub-indexes, from its own on, a row stands. */
#define LINK_OBJECT_ENTRIES(index, sub)                                                            \
    ((sub) != 1u          ? 1u                                                                     \
     : (index) == 0x60e3u ? (unsigned)LINK_HOMING_METHODS_IN_ALL                                   \
     : ((index)&0xfffcu) == 0x1600u || ((index)&0xfffcu) == 0x1a00u ? (unsigned)LINK_PDO_OBJECTS   \
                                                                    : 1u)

#define LINK_OBJECT_GROUPS(GROUP)                                                                  \
    GROUP(0x1003, "Pre-defined error field")                                                       \
    GROUP(0x1010, "Store parameters")                                                              \
    GROUP(0x1011, "Restore default parameters")                                                    \
    GROUP(0x1016, "Consumer heartbeat time")                                                       \
    GROUP(0x1018, "Identity object")                                                               \
    GROUP(0x1200, "SDO server parameter")                                                          \
    GROUP(0x1400, "RPDO communication parameter")                                                  \
    GROUP(0x1600, "RPDO mapping parameter")                                                        \
    GROUP(0x1800, "TPDO communication parameter")                                                  \
    GROUP(0x1a00, "TPDO mapping parameter")                                                        \
    GROUP(0x2400, "Capture")                                                                       \
    GROUP(0x2401, "Captured signals")                                                              \
    GROUP(0x2403, "Homing on a stop")                                                              \
    GROUP(0x607d, "Software position limit")                                                       \
    GROUP(0x608f, "Position encoder resolution")                                                   \
    GROUP(0x6091, "Gear ratio")                                                                    \
    GROUP(0x6092, "Feed constant")                                                                 \
    GROUP(0x6099, "Homing speeds")                                                                 \
    GROUP(0x60c2, "Interpolation time period")                                                     \
    GROUP(0x60e3, "Supported homing methods")                                                      \
    GROUP(0x60fe, "Digital outputs")

#define LINK_OBJECTS(STORED, ASKED)                                                                \
    STORED(0x1000, 0, U32, RO, device_type, 0x00040192, "Device type")                             \
    ASKED(0x1001, 0, U8, RO_T, 0, "Error register")                                                \
    ASKED(0x1003, 0, U8, RW, 0, "Number of errors")                                                \
    STORED(0x1003, 1, U32, RO, error_1, 0, "Standard error field 1")                               \
    STORED(0x1003, 2, U32, RO, error_2, 0, "Standard error field 2")                               \
    STORED(0x1003, 3, U32, RO, error_3, 0, "Standard error field 3")                               \
    STORED(0x1003, 4, U32, RO, error_4, 0, "Standard error field 4")                               \
    STORED(0x1005, 0, U32, RW, sync_cob_id, 0x80, "COB-ID SYNC message")                           \
    STORED(0x1006, 0, U32, RW, sync_period_us, 0, "Communication cycle period")                    \
    ASKED(0x1008, 0, TEXT, RO, 0, "Manufacturer device name")                                      \
    ASKED(0x100a, 0, TEXT, RO, 0, "Manufacturer software version")                                 \
    ASKED(0x1010, 1, U32, RW, 1, "Save all parameters")                                            \
    ASKED(0x1011, 1, U32, RW, 1, "Restore all default parameters")                                 \
    STORED(0x1014, 0, U32, RW_NODE, emergency_cob_id, 0x80, "COB-ID EMCY")                         \
    STORED(0x1016, 1, U32, RW, consumer_heartbeat, 0, "Consumer heartbeat time 1")                 \
    STORED(0x1017, 0, U16, RW, heartbeat_ms, 0, "Producer heartbeat time")                         \
    STORED(0x1018, 1, U32, RO, vendor, 0, "Vendor-ID")                                             \
    STORED(0x1018, 2, U32, RO, product, 1, "Product code")                                         \
    STORED(0x1018, 3, U32, RO, revision, 0x00000002, "Revision number")                            \
    STORED(0x1018, 4, U32, RO, serial, 0, "Serial number")                                         \
    ASKED(0x1021, 0, DOMAIN, RO, 0, "Store EDS")                                                   \
    ASKED(0x1022, 0, U8, RO, 0, "Store format")                                                    \
    STORED(0x1200, 1, U32, RO_NODE, sdo_request, 0x600, "COB-ID client to server")                 \
    STORED(0x1200, 2, U32, RO_NODE, sdo_response, 0x580, "COB-ID server to client")                \
    ASKED(0x1400, 0, U8, RO, 2, "Highest sub-index supported")                                     \
    ASKED(0x1400, 1, U32, RW, 0x200, "COB-ID used by RPDO")                                        \
    ASKED(0x1400, 2, U8, RW, 255, "Transmission type")                                             \
    ASKED(0x1600, 0, U8, RW, 1, "Number of mapped objects")                                        \
    ASKED(0x1600, 1, U32, RW, 0, "Mapped object")                                                  \
    ASKED(0x1800, 0, U8, RO, 5, "Highest sub-index supported")                                     \
    ASKED(0x1800, 1, U32, RW, 0x180, "COB-ID used by TPDO")                                        \
    ASKED(0x1800, 2, U8, RW, 255, "Transmission type")                                             \
    ASKED(0x1800, 3, U16, RW, 0, "Inhibit time")                                                   \
    ASKED(0x1800, 5, U16, RW, 0, "Event timer")                                                    \
    ASKED(0x1a00, 0, U8, RW, 1, "Number of mapped objects")                                        \
    ASKED(0x1a00, 1, U32, RW, 0, "Mapped object")                                                  \
    ASKED(0x2400, 1, U8, RW, 0, "Capture")                                                         \
    STORED(0x2400, 2, U16, RW, capture_divider, 1, "Periods from sample to sample")                \
    STORED(0x2400, 3, U16, RW, capture_trigger, 0, "Trigger signal")                               \
    STORED(0x2400, 4, REAL64, RW, capture_level, 0, "Trigger level")                               \
    STORED(0x2400, 5, I8, RW, capture_edge, 1, "Trigger edge")                                     \
    STORED(0x2400, 6, U32, RW, capture_before, 0, "Samples before the trigger")                    \
    STORED(0x2400, 7, U32, RW, capture_samples, 0, "Samples in all")                               \
    ASKED(0x2400, 8, U32, RO, 0, "Samples taken")                                                  \
    ASKED(0x2400, 9, U32, RO, 0, "Period of the first sample")                                     \
    STORED(0x2401, 1, U16, RW, capture_1, 0, "Captured signal 1")                                  \
    STORED(0x2401, 2, U16, RW, capture_2, 0, "Captured signal 2")                                  \
    STORED(0x2401, 3, U16, RW, capture_3, 0, "Captured signal 3")                                  \
    STORED(0x2401, 4, U16, RW, capture_4, 0, "Captured signal 4")                                  \
    STORED(0x2401, 5, U16, RW, capture_5, 0, "Captured signal 5")                                  \
    STORED(0x2401, 6, U16, RW, capture_6, 0, "Captured signal 6")                                  \
    STORED(0x2401, 7, U16, RW, capture_7, 0, "Captured signal 7")                                  \
    STORED(0x2401, 8, U16, RW, capture_8, 0, "Captured signal 8")                                  \
    ASKED(0x2402, 0, DOMAIN, RO, 0, "Captured values")                                             \
    STORED(0x2403, 1, U16, RW, homing_torque, 700, "Torque of a stop")                             \
    STORED(0x2403, 2, U32, RW, homing_travel, 0, "Travel to a stop")                               \
    ASKED(0x6040, 0, U16, RW_R, 0, "Controlword")                                                  \
    ASKED(0x6041, 0, U16, RO_T, 0, "Statusword")                                                   \
    STORED(0x605a, 0, I16, RW, quick_stop_option, 2, "Quick stop option code")                     \
    STORED(0x605d, 0, I16, RW, halt_option, 1, "Halt option code")                                 \
    STORED(0x6060, 0, I8, RW_R, mode, 1, "Modes of operation")                                     \
    ASKED(0x6061, 0, I8, RO_T, 1, "Modes of operation display")                                    \
    ASKED(0x6062, 0, I32, RO_T, 0, "Position demand value")                                        \
    ASKED(0x6064, 0, I32, RO_T, 0, "Position actual value")                                        \
    STORED(0x6065, 0, U32, RW, following_window, 2048, "Following error window")                   \
    STORED(0x6066, 0, U16, RW, following_ms, 10, "Following error time out")                       \
    STORED(0x6067, 0, U32, RW, target_window, 100, "Position window")                              \
    STORED(0x6068, 0, U16, RW, target_ms, 10, "Position window time")                              \
    ASKED(0x606b, 0, I32, RO_T, 0, "Velocity demand value")                                        \
    ASKED(0x606c, 0, I32, RO_T, 0, "Velocity actual value")                                        \
    STORED(0x6071, 0, I16, RW_R, target_torque, 0, "Target torque")                                \
    ASKED(0x6072, 0, U16, RW_R, 0, "Max torque")                                                   \
    ASKED(0x6074, 0, I16, RO_T, 0, "Torque demand")                                                \
    ASKED(0x6075, 0, U32, RO, 0, "Motor rated current")                                            \
    ASKED(0x6076, 0, U32, RO, 0, "Motor rated torque")                                             \
    ASKED(0x6077, 0, I16, RO_T, 0, "Torque actual value")                                          \
    ASKED(0x6078, 0, I16, RO_T, 0, "Current actual value")                                         \
    ASKED(0x6079, 0, U32, RO_T, 0, "DC link circuit voltage")                                      \
    STORED(0x607a, 0, I32, RW_R, target_position, 0, "Target position")                            \
    STORED(0x607c, 0, I32, RW, home_offset, 0, "Home offset")                                      \
    STORED(0x607d, 1, I32, RW, position_least, INT32_MIN, "Min position limit")                    \
    STORED(0x607d, 2, I32, RW, position_most, INT32_MAX, "Max position limit")                     \
    STORED(0x6080, 0, U32, RW_R, max_speed_rpm, 0, "Max motor speed")                              \
    STORED(0x6081, 0, U32, RW_R, profile_velocity, 0, "Profile velocity")                          \
    STORED(0x6083, 0, U32, RW_R, profile_acceleration, 0, "Profile acceleration")                  \
    STORED(0x6084, 0, U32, RW_R, profile_deceleration, 0, "Profile deceleration")                  \
    STORED(0x6085, 0, U32, RW, quick_stop_deceleration, 0, "Quick stop deceleration")              \
    STORED(0x608f, 1, U32, RO, increments, 65536, "Encoder increments")                            \
    STORED(0x608f, 2, U32, RO, increments_turns, 1, "Motor revolutions")                           \
    STORED(0x6091, 1, U32, RW, gear_motor, 1, "Motor revolutions")                                 \
    STORED(0x6091, 2, U32, RW, gear_shaft, 1, "Shaft revolutions")                                 \
    STORED(0x6092, 1, U32, RW, feed, 65536, "Feed")                                                \
    STORED(0x6092, 2, U32, RW, feed_shaft, 1, "Shaft revolutions")                                 \
    STORED(0x6098, 0, I8, RW_R, homing_method, 37, "Homing method")                                \
    STORED(0x6099, 1, U32, RW, homing_speed, 0, "Speed during search for switch")                  \
    STORED(0x6099, 2, U32, RW, homing_zero_speed, 0, "Speed during search for zero")               \
    STORED(0x609a, 0, U32, RW, homing_acceleration, 0, "Homing acceleration")                      \
    STORED(0x60c2, 1, U8, RW, interval, 4, "Interpolation time period value")                      \
    STORED(0x60c2, 2, I8, RW, interval_exponent, -3, "Interpolation time index")                   \
    ASKED(0x60e3, 0, U8, RO, 18, "Number of supported homing methods")                             \
    ASKED(0x60e3, 1, I8, RO, 0, "Supported homing method")                                         \
    ASKED(0x60f4, 0, I32, RO_T, 0, "Following error actual value")                                 \
    ASKED(0x60fd, 0, U32, RO_T, 0, "Digital inputs")                                               \
    ASKED(0x60fe, 1, U32, RO_T, 0, "Physical outputs")                                             \
    STORED(0x60ff, 0, I32, RW_R, target_velocity, 0, "Target velocity")                            \
    ASKED(0x6502, 0, U32, RO, 0x000000a5, "Supported drive modes")                                 \
    STORED(0x607e, 0, U8, RW, polarity, 0, "Polarity")                                             \
    STORED(0x1010, 0, U8, RO, store_highest, 1, "Highest sub-index supported")                     \
    STORED(0x1011, 0, U8, RO, restore_highest, 1, "Highest sub-index supported")                   \
    STORED(0x1016, 0, U8, RO, consumer_highest, 1, "Highest sub-index supported")                  \
    STORED(0x1018, 0, U8, RO, identity_highest, 4, "Highest sub-index supported")                  \
    STORED(0x1200, 0, U8, RO, sdo_highest, 2, "Highest sub-index supported")                       \
    STORED(0x2400, 0, U8, RO, capture_highest, 9, "Highest sub-index supported")                   \
    STORED(0x2401, 0, U8, RO, capture_columns, 8, "Highest sub-index supported")                   \
    STORED(0x2403, 0, U8, RO, homing_highest, 2, "Highest sub-index supported")                    \
    STORED(0x607d, 0, U8, RO, limits_highest, 2, "Highest sub-index supported")                    \
    STORED(0x608f, 0, U8, RO, resolution_highest, 2, "Highest sub-index supported")                \
    STORED(0x6091, 0, U8, RO, gear_highest, 2, "Highest sub-index supported")                      \
    STORED(0x6092, 0, U8, RO, feed_highest, 2, "Highest sub-index supported")                      \
    STORED(0x6099, 0, U8, RO, homing_speeds_highest, 2, "Highest sub-index supported")             \
    STORED(0x60c2, 0, U8, RO, interval_highest, 2, "Highest sub-index supported")                  \
    STORED(0x60fe, 0, U8, RO, outputs_highest, 1, "Highest sub-index supported")

#endif
