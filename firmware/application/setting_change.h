/*
 * What changes, keeps and restores the settings of an application: for the console's lines and for
 * a fieldbus. What is changed waits in `application->chosen` for the next enable
 * (application_command); in a drive that is ready, what may change in motion acts at once, and all
 * else is refused. Every refusal leaves its reason in `refusal`.
 */
#ifndef STEADYSTEP_SETTING_CHANGE_H
#define STEADYSTEP_SETTING_CHANGE_H

#include "firmware/drive/record_log.h"
#include "firmware/interface/settings.h"

struct application;

enum setting_change { SETTING_CHANGED, SETTING_OUT_OF_RANGE, SETTING_NOT_NOW };

/* An element by its number, from 0 on. NaN: not given. */
enum setting_change setting_change(struct application *application, const struct setting *setting,
                                   size_t element, double value, char refusal[DRIVE_ERROR_TEXT]);

/* Whether what is set waits for an enable. A disable that was asked for before counts: it acts
   before any enable that is asked for behind. */
bool setting_change_waits(const struct application *application);

/* All but the motor's back to their defaults. */
bool settings_restore(struct application *application, char refusal[DRIVE_ERROR_TEXT]);

/* Keeps what is set and what was learned, up to 60 ms. */
enum record_writing settings_store(struct application *application, char refusal[DRIVE_ERROR_TEXT]);

#endif
