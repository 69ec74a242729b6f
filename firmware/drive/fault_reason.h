/* A fault in words. */
#ifndef STEADYSTEP_FAULT_REASON_H
#define STEADYSTEP_FAULT_REASON_H

#include "firmware/design/text.h"
#include "firmware/drive/drive.h"

/* Background: the drive's fault by name, and what it means: "overcurrent: a phase current beyond
   5.4 A". */
void fault_reason_put(struct text *text, const struct drive *drive);

#endif
