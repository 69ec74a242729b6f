/*
 * The settings of a drive as TOML, by the rows of firmware/interface/settings_table.h: a scenario's
 * [drive], and a file of settings, which has the motor's as well. How it looks: sil/README.md.
 */
#ifndef STEADYSTEP_SCENARIO_SETTINGS_FILE_H
#define STEADYSTEP_SCENARIO_SETTINGS_FILE_H

#include <string>

#include "sil/board/board.h"
#include "sil/scenario/document.h"

namespace scenario
{

/*
 * Both put what the table gives into `drive`, in the order of the rows, and leave the rest as it
 * is; feedback and law bring their defaults with them. What one setting asks of another is left to
 * drive_settings_check. Throw InputError.
 */
void read_drive(const Value &table, drive_settings &drive); /* all but the motor's */
void read_settings(const Value &file, drive_settings &drive);

/* All of them as such a file: the same settings give the same bytes, the bytes the same settings.
 */
std::string settings_text(const drive_settings &drive);

} // namespace scenario

#endif
