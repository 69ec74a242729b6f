/*
 * Block transfer of the SDO server, CiA 301: segments of seven bytes one behind the other, up to
 * 127 of them for one acknowledgement, and a checksum over all. What a client has not received it
 * does not acknowledge, and gets again.
 */
#ifndef STEADYSTEP_SDO_BLOCK_H
#define STEADYSTEP_SDO_BLOCK_H

#include <stdbool.h>
#include <stdint.h>

#include "firmware/link/can_frame.h"

struct application;

/* A request of a block upload or download. Why it is aborted, 0: it is not; `answers`: there is a
   response. */
uint32_t sdo_block_upload(struct application *application, const struct can_frame *request,
                          struct can_frame *response, bool *answers);
uint32_t sdo_block_download(struct application *application, const struct can_frame *request,
                            struct can_frame *response);

/* Whether a frame is one where they are awaited, or an abort: what begins another transfer has a
   higher first byte. */
bool sdo_block_is_segment(const struct can_frame *request);

/* A segment of a block download. */
uint32_t sdo_block_take(struct application *application, const struct can_frame *request,
                        struct can_frame *response, bool *answers);

/* Background: sends segments of a block upload, as many as fit. */
void sdo_block_send(struct application *application);

#endif
