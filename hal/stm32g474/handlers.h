/* Exception handlers of this port that no other header declares. */
#ifndef STEADYSTEP_STM32G474_HANDLERS_H
#define STEADYSTEP_STM32G474_HANDLERS_H

int main(void);

void reset_handler(void);
void fdcan_interrupt(void);       /* a frame has come */
void serial_line_interrupt(void); /* a line feed has come, or a byte with an error */

#endif
