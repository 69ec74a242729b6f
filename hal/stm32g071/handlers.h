/* Exception handlers of this port that no other header declares, by the names of their lines. */
#ifndef STEADYSTEP_STM32G071_HANDLERS_H
#define STEADYSTEP_STM32G071_HANDLERS_H

int main(void);

void reset_handler(void);
void tim1_brk_up_trg_com_handler(void); /* FAULT */
void tim2_handler(void);                /* deadline missed */
void dma1_channel2_3_handler(void);     /* serial line */
void usart3_4_lpuart1_handler(void);    /* end of a received line */

#endif
