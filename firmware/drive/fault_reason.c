#include "firmware/drive/fault_reason.h"

#include "firmware/interface/dictionary.h"

enum { DIGITS = 6 };

void fault_reason_put(struct text *text, const struct drive *drive)
{
    const struct fault_row *row = fault_at(drive->supervision.fault);
    const struct setting *limit = fault_limit(drive->supervision.fault);

    text_put(text, row->name);
    text_put(text, ": ");
    text_put(text, row->cause);
    if (limit != NULL) {
        text_put(text, " ");
        text_number(text, setting_get(&drive->settings, limit, 0), DIGITS);
        text_put(text, " ");
        text_put(text, limit->unit);
    }
}
