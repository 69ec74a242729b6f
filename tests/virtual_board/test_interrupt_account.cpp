/* What the account of the control interrupt says of interrupts that control and of those that rest.
 */
#include <unity.h>

#include "sil/virtual_board/interrupt_account.h"

using virtual_board::CycleFigures;
using virtual_board::InterruptAccount;

namespace
{

constexpr unsigned sampling = 0, law = 1; /* stages */

InterruptAccount account_of_an_image()
{
    InterruptAccount account;
    account.set_stages({"sampling", "position law"});
    return account;
}

void interrupt(InterruptAccount &account, std::uint32_t sampling_cycles, std::uint32_t law_cycles)
{
    account.begin();
    account.add(sampling, {sampling_cycles, sampling_cycles, sampling_cycles});
    account.add(law, {law_cycles, law_cycles, law_cycles});
    account.end();
}

void means_are_of_the_interrupts_in_which_the_drive_controls()
{
    InterruptAccount account = account_of_an_image();
    interrupt(account, 100, 0);
    interrupt(account, 200, 700);
    interrupt(account, 120, 0);
    interrupt(account, 220, 800);

    const InterruptAccount::Summary summary = account.summary();
    TEST_ASSERT_EQUAL_UINT64(4, summary.interrupts);
    TEST_ASSERT_EQUAL_UINT64(2, summary.in_control);
    TEST_ASSERT_EQUAL_DOUBLE(960, summary.total.nominal.mean);
    TEST_ASSERT_EQUAL_DOUBLE(960, summary.total.worst.mean);
    TEST_ASSERT_EQUAL_DOUBLE(960, summary.total.flash.mean);
    TEST_ASSERT_EQUAL_DOUBLE(210, summary.stages[sampling].nominal.mean);
    TEST_ASSERT_EQUAL_DOUBLE(750, summary.stages[law].nominal.mean);
}

void least_and_worst_are_of_every_interrupt()
{
    InterruptAccount account = account_of_an_image();
    interrupt(account, 200, 700);
    interrupt(account, 5000, 0);
    interrupt(account, 100, 0);

    const InterruptAccount::Summary summary = account.summary();
    TEST_ASSERT_EQUAL_UINT64(100, summary.total.nominal.least);
    TEST_ASSERT_EQUAL_UINT64(5000, summary.total.nominal.worst);
    TEST_ASSERT_EQUAL_DOUBLE(900, summary.total.nominal.mean);
}

void a_drive_that_has_not_controlled_has_no_mean()
{
    InterruptAccount account = account_of_an_image();
    interrupt(account, 100, 0);
    TEST_ASSERT_EQUAL_UINT64(0, account.summary().in_control);
    TEST_ASSERT_EQUAL_DOUBLE(0, account.summary().total.nominal.mean);
}

void without_that_stage_means_are_of_every_interrupt()
{
    InterruptAccount account;
    account.set_stages({"other"});
    account.begin();
    account.add(0, {100, 100, 100});
    account.end();
    TEST_ASSERT_EQUAL_UINT64(1, account.summary().in_control);
    TEST_ASSERT_EQUAL_DOUBLE(100, account.summary().total.nominal.mean);
}

} // namespace

void setUp()
{
}

void tearDown()
{
}

int main()
{
    UNITY_BEGIN();
    RUN_TEST(means_are_of_the_interrupts_in_which_the_drive_controls);
    RUN_TEST(least_and_worst_are_of_every_interrupt);
    RUN_TEST(a_drive_that_has_not_controlled_has_no_mean);
    RUN_TEST(without_that_stage_means_are_of_every_interrupt);
    return UNITY_END();
}
