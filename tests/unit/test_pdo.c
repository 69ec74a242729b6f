/* Process data: what is mapped at first, what may be, and when it goes. */
#include "tests/unit/link_bench.h"

enum {
    SECOND = 10000 /* periods */,
    RPDO = 0x1400,
    RPDO_MAP = 0x1600,
    TPDO = 0x1800,
    TPDO_MAP = 0x1a00
};

enum { START = 1, PRE_OPERATIONAL = 0x80 };

static const uint32_t off = 0x80000000u, no_remote = 0x40000000u;

void setUp(void)
{
    link_bench_start();
    link_bench_open();
}

void tearDown(void)
{
}

/* Entries of a PDO that does not exist. */
static uint32_t put_entries(unsigned index, const uint32_t entries[])
{
    unsigned count = 0;

    TEST_ASSERT_EQUAL_HEX32(0, link_bench_put(index, 0, 1, 0));
    while (entries[count] != 0u) {
        const uint32_t abort = link_bench_put(index, count + 1u, 4, entries[count]);

        if (abort != 0u) {
            return abort;
        }
        count++;
    }
    return link_bench_put(index, 0, 1, count);
}

static void put_cob_id(unsigned index, uint32_t cob_id)
{
    TEST_ASSERT_EQUAL_HEX32(0, link_bench_put(index, 1, 4, cob_id));
}

/* Maps these objects, each index << 16 | sub << 8 | bits, up to a 0; the abort code. The PDO does
   not exist meanwhile. */
static uint32_t map(unsigned index, const uint32_t entries[])
{
    const unsigned parameters = index - 0x200u;
    const uint32_t cob_id = link_bench_get(parameters, 1);

    put_cob_id(parameters, cob_id | off);
    const uint32_t abort = put_entries(index, entries);

    put_cob_id(parameters, cob_id);
    return abort;
}

static void put_inhibit(uint32_t inhibit_100us)
{
    put_cob_id(TPDO, 0x181u | no_remote | off);
    TEST_ASSERT_EQUAL_HEX32(0, link_bench_put(TPDO, 3, 2, inhibit_100us));
    put_cob_id(TPDO, 0x181u | no_remote);
}

static void test_presets_are_those_of_the_profile_for_drives(void)
{
    static const uint32_t received[4] = {0, 0x60600008, 0x607a0020, 0x60ff0020};
    static const uint32_t sent[4] = {0, 0x60610008, 0x60640020, 0x606c0020};

    for (unsigned i = 0; i < 4u; i++) {
        const uint32_t valid = i == 0u ? 0u : off;

        TEST_ASSERT_EQUAL_HEX32(2, link_bench_get(RPDO + i, 0));
        TEST_ASSERT_EQUAL_HEX32((0x201u + 0x100u * i) | valid, link_bench_get(RPDO + i, 1));
        TEST_ASSERT_EQUAL_HEX32(255, link_bench_get(RPDO + i, 2));
        TEST_ASSERT_EQUAL_HEX32(i == 0u ? 1 : 2, link_bench_get(RPDO_MAP + i, 0));
        TEST_ASSERT_EQUAL_HEX32(0x60400010, link_bench_get(RPDO_MAP + i, 1));
        TEST_ASSERT_EQUAL_HEX32(received[i], link_bench_get(RPDO_MAP + i, 2));
        TEST_ASSERT_EQUAL_HEX32(5, link_bench_get(TPDO + i, 0));
        TEST_ASSERT_EQUAL_HEX32((0x181u + 0x100u * i) | valid | no_remote,
                                link_bench_get(TPDO + i, 1));
        TEST_ASSERT_EQUAL_HEX32(255, link_bench_get(TPDO + i, 2));
        TEST_ASSERT_EQUAL_HEX32(0, link_bench_get(TPDO + i, 3));
        TEST_ASSERT_EQUAL_HEX32(i == 0u ? 100 : 0, link_bench_get(TPDO + i, 5));
        TEST_ASSERT_EQUAL_HEX32(i == 0u ? 1 : 2, link_bench_get(TPDO_MAP + i, 0));
        TEST_ASSERT_EQUAL_HEX32(0x60410010, link_bench_get(TPDO_MAP + i, 1));
        TEST_ASSERT_EQUAL_HEX32(sent[i], link_bench_get(TPDO_MAP + i, 2));
        TEST_ASSERT_EQUAL_HEX32(0, link_bench_get(TPDO_MAP + i, 8));
    }
}

static void test_what_is_put_is_what_is_read_of_each_for_itself(void)
{
    for (unsigned i = 0; i < 4u; i++) {
        put_cob_id(RPDO + i, off);
        put_cob_id(RPDO + i, 0x301u + i);
        TEST_ASSERT_EQUAL_HEX32(0, link_bench_put(RPDO + i, 2, 1, 1u + i));
        put_cob_id(TPDO + i, off);
        TEST_ASSERT_EQUAL_HEX32(0, link_bench_put(TPDO + i, 3, 2, 0x1001u + i));
        put_cob_id(TPDO + i, (0x401u + i) | no_remote);
        TEST_ASSERT_EQUAL_HEX32(0, link_bench_put(TPDO + i, 2, 1, 11u + i));
        TEST_ASSERT_EQUAL_HEX32(0, link_bench_put(TPDO + i, 5, 2, 0x2001u + i));
    }
    for (unsigned i = 0; i < 4u; i++) {
        TEST_ASSERT_EQUAL_HEX32(0x301u + i, link_bench_get(RPDO + i, 1));
        TEST_ASSERT_EQUAL_HEX32(1u + i, link_bench_get(RPDO + i, 2));
        TEST_ASSERT_EQUAL_HEX32((0x401u + i) | no_remote, link_bench_get(TPDO + i, 1));
        TEST_ASSERT_EQUAL_HEX32(11u + i, link_bench_get(TPDO + i, 2));
        TEST_ASSERT_EQUAL_HEX32(0x1001u + i, link_bench_get(TPDO + i, 3));
        TEST_ASSERT_EQUAL_HEX32(0x2001u + i, link_bench_get(TPDO + i, 5));
    }
}

static void test_there_are_four_each_way_of_eight_objects(void)
{
    static const char *const missing[] = {"4004140000000000", "4004180000000000",
                                          "4004160000000000", "40041A0000000000"};

    for (int i = 0; i < 4; i++) {
        TEST_ASSERT_EQUAL_STRING_LEN("00000206", &link_bench_sdo(missing[i])[8], 8);
    }
    TEST_ASSERT_EQUAL_STRING("8000160911000906", link_bench_sdo("4000160900000000"));
    TEST_ASSERT_EQUAL_STRING("80001A0911000906", link_bench_sdo("40001A0900000000"));
    TEST_ASSERT_EQUAL_STRING("8000140311000906", link_bench_sdo("4000140300000000"));
    TEST_ASSERT_EQUAL_STRING("8000180411000906", link_bench_sdo("4000180400000000"));
    TEST_ASSERT_EQUAL_STRING("8000180611000906", link_bench_sdo("4000180600000000"));
}

static void test_identifiers_have_eleven_bits(void)
{
    put_cob_id(RPDO, off);
    put_cob_id(RPDO, 0x57f);
    put_cob_id(RPDO, 0x57fu | off);
    put_cob_id(TPDO, 0x57fu | off | no_remote);
    TEST_ASSERT_EQUAL_HEX32(OBJECT_OUT_OF_RANGE, link_bench_put(RPDO, 1, 4, 0x800));
    TEST_ASSERT_EQUAL_HEX32(OBJECT_OUT_OF_RANGE, link_bench_put(RPDO, 1, 4, 0x20000201));
    TEST_ASSERT_EQUAL_HEX32(0x57fu | off, link_bench_get(RPDO, 1));
}

/* Whoever changes a PDO takes it off first, as CiA 301 has it. */
static void test_while_a_pdo_exists_its_identifier_inhibit_time_and_mapping_stay(void)
{
    TEST_ASSERT_EQUAL_HEX32(OBJECT_OUT_OF_RANGE, link_bench_put(RPDO, 1, 4, 0x202));
    TEST_ASSERT_EQUAL_HEX32(OBJECT_OUT_OF_RANGE, link_bench_put(TPDO, 1, 4, 0x182u | no_remote));
    TEST_ASSERT_EQUAL_HEX32(OBJECT_OUT_OF_RANGE, link_bench_put(TPDO, 3, 2, 50));
    TEST_ASSERT_EQUAL_HEX32(OBJECT_WRONG_STATE, link_bench_put(RPDO_MAP, 0, 1, 0));
    TEST_ASSERT_EQUAL_HEX32(OBJECT_WRONG_STATE, link_bench_put(TPDO_MAP, 2, 4, 0x60610008));
    put_cob_id(RPDO, 0x201); /* as it is */
    put_cob_id(TPDO, 0x181u | no_remote);
    TEST_ASSERT_EQUAL_HEX32(1, link_bench_get(RPDO_MAP, 0));
    TEST_ASSERT_EQUAL_HEX32(0, link_bench_get(TPDO_MAP, 2));
    put_cob_id(RPDO, 0x202u | off);
    put_cob_id(RPDO, 0x203);
    (void)link_bench_nmt(START, 1);
    (void)link_bench_say("t20120600", 2);
    TEST_ASSERT_EQUAL_HEX32(0x0240, link_bench_get(0x6041, 0));
    (void)link_bench_say("t20320600", 2);
    TEST_ASSERT_EQUAL_HEX32(0x0221, link_bench_get(0x6041, 0));
}

/* Many a master writes the identifier alone. */
static void test_the_bit_of_remote_frames_may_be_left_out(void)
{
    put_cob_id(TPDO, 0x181u); /* as it is, but for that */
    TEST_ASSERT_EQUAL_HEX32(OBJECT_OUT_OF_RANGE, link_bench_put(TPDO, 1, 4, 0x182));
    put_cob_id(TPDO, 0x181u | off);
    put_cob_id(TPDO, 0x182u);
    TEST_ASSERT_EQUAL_HEX32(0x182u, link_bench_get(TPDO, 1));
}

static void test_transmission_types_between_240_and_254_mean_nothing(void)
{
    TEST_ASSERT_EQUAL_HEX32(0, link_bench_put(RPDO, 2, 1, 240));
    TEST_ASSERT_EQUAL_HEX32(OBJECT_OUT_OF_RANGE, link_bench_put(RPDO, 2, 1, 241));
    TEST_ASSERT_EQUAL_HEX32(OBJECT_OUT_OF_RANGE, link_bench_put(RPDO, 2, 1, 253));
    TEST_ASSERT_EQUAL_HEX32(240, link_bench_get(RPDO, 2));
    TEST_ASSERT_EQUAL_HEX32(0, link_bench_put(RPDO, 2, 1, 254));
}

static void test_eight_bytes_are_mapped_and_not_a_bit_more(void)
{
    static const uint32_t eight[] = {0x23000008, 0x23000008, 0x10010008, 0x60610008, 0x23000008,
                                     0x23000008, 0x23000008, 0x23000008, 0};
    static const uint32_t longer[] = {0x60640020, 0x60410010, 0x60610008, 0x60410010, 0};

    put_cob_id(TPDO, off);
    TEST_ASSERT_EQUAL_HEX32(0, map(TPDO_MAP, eight));
    TEST_ASSERT_EQUAL_HEX32(8, link_bench_get(TPDO_MAP, 0));
    TEST_ASSERT_EQUAL_HEX32(OBJECT_PDO_TOO_LONG, link_bench_put(TPDO_MAP, 0, 1, 9));
    TEST_ASSERT_EQUAL_HEX32(OBJECT_PDO_TOO_LONG, map(TPDO_MAP, longer)); /* 72 bits */
    TEST_ASSERT_EQUAL_HEX32(0, link_bench_get(TPDO_MAP, 0));
    TEST_ASSERT_EQUAL_HEX32(0, link_bench_put(TPDO_MAP, 4, 4, 0)); /* takes it out */
    TEST_ASSERT_EQUAL_HEX32(0, link_bench_get(TPDO_MAP, 4));
    TEST_ASSERT_EQUAL_HEX32(OBJECT_MISSING, link_bench_put(TPDO_MAP, 0, 1, 4));
    TEST_ASSERT_EQUAL_HEX32(0, link_bench_put(TPDO_MAP, 0, 1, 3));
}

static void test_what_is_received_may_be_written_and_what_is_sent_be_read(void)
{
    static const uint32_t status[] = {0x60410010, 0}, word[] = {0x60400010, 0};

    TEST_ASSERT_EQUAL_HEX32(OBJECT_NOT_MAPPABLE, map(RPDO_MAP + 1, status));
    TEST_ASSERT_EQUAL_HEX32(OBJECT_NOT_MAPPABLE, map(TPDO_MAP + 1, word));
    TEST_ASSERT_EQUAL_HEX32(0, map(RPDO_MAP + 1, word));
    TEST_ASSERT_EQUAL_HEX32(0, map(TPDO_MAP + 1, status));
}

/* A frame that is too short for what is mapped is none; one that is longer is. */
static void test_a_received_frame_is_taken_apart_as_it_is_mapped(void)
{
    static const uint32_t mapped[] = {0x607a0020, 0x60600008, 0x60980008, 0};

    TEST_ASSERT_EQUAL_HEX32(0, map(RPDO_MAP + 2, mapped));
    (void)link_bench_nmt(START, 1);
    (void)link_bench_say("t401604030201"
                         "0323",
                         1);
    TEST_ASSERT_EQUAL_HEX32(0, link_bench_get(0x607a, 0)); /* off */
    TEST_ASSERT_EQUAL_HEX32(0, link_bench_put(RPDO + 2, 1, 4, 0x401));
    (void)link_bench_say("t401504030201"
                         "03",
                         1);
    TEST_ASSERT_EQUAL_HEX32(0, link_bench_get(0x607a, 0));
    (void)link_bench_say("t402604030201"
                         "0323",
                         1);
    TEST_ASSERT_EQUAL_HEX32(0, link_bench_get(0x607a, 0));
    (void)link_bench_say("t401604030201"
                         "0323",
                         1);
    TEST_ASSERT_EQUAL_HEX32(0x01020304, link_bench_get(0x607a, 0));
    TEST_ASSERT_EQUAL_HEX32(3, link_bench_get(0x6060, 0));
    TEST_ASSERT_EQUAL_HEX32(35, link_bench_get(0x6098, 0));
    (void)link_bench_say("t401814030201"
                         "06250000",
                         1);
    TEST_ASSERT_EQUAL_HEX32(0x01020314, link_bench_get(0x607a, 0));
    TEST_ASSERT_EQUAL_HEX32(37, link_bench_get(0x6098, 0));
    (void)link_bench_nmt(PRE_OPERATIONAL, 1);
    (void)link_bench_say("t401604030201"
                         "0323",
                         1);
    TEST_ASSERT_EQUAL_HEX32(0x01020314, link_bench_get(0x607a, 0));
}

static void test_a_sent_frame_is_put_together_as_it_is_mapped(void)
{
    put_cob_id(TPDO + 1, 0x281u | no_remote);
    const char *heard = link_bench_nmt(START, 12);

    link_bench_heard("t18124002\r", heard);
    link_bench_heard("t2813400201\r", heard);
    TEST_ASSERT_EQUAL_INT(1, link_bench_count("t281", heard));
    TEST_ASSERT_EQUAL_INT(0, link_bench_count("t381", heard));
}

static void test_the_status_comes_every_100_ms_and_the_rest_on_change(void)
{
    put_cob_id(TPDO + 1, 0x281u | no_remote);
    (void)link_bench_nmt(START, 50);
    const char *heard = link_bench_say("", SECOND);

    TEST_ASSERT_EQUAL_INT(10, link_bench_count("t181", heard));
    TEST_ASSERT_EQUAL_INT(0, link_bench_count("t281", heard));
    (void)link_bench_put(0x6060, 0, 1, 3);
    heard = link_bench_say("", 15);
    TEST_ASSERT_EQUAL_INT(1, link_bench_count("t281", heard));
    link_bench_heard("t2813400203\r", heard);
    (void)link_bench_nmt(START, 50); /* is operational already */
    heard = link_bench_say("", 15);
    TEST_ASSERT_EQUAL_INT(0, link_bench_count("t281", heard));
    (void)link_bench_nmt(PRE_OPERATIONAL, 50);
    TEST_ASSERT_EQUAL_INT(0, link_bench_count("t1812", link_bench_say("", SECOND)));
    TEST_ASSERT_EQUAL_INT(1, link_bench_count("t281", link_bench_nmt(START, 50)));
}

static void test_an_inhibit_time_keeps_what_changes_all_the_time_from_the_bus(void)
{
    static const uint32_t period[] = {0x23010020, 0};

    TEST_ASSERT_EQUAL_HEX32(0, link_bench_put(TPDO, 5, 2, 0));
    TEST_ASSERT_EQUAL_HEX32(0, map(TPDO_MAP, period));
    put_inhibit(50); /* 5 ms */
    (void)link_bench_nmt(START, 50);
    TEST_ASSERT_EQUAL_INT(10, link_bench_count("t181", link_bench_say("", 500)));
    put_inhibit(0);
    (void)link_bench_say("", 20);
    TEST_ASSERT_EQUAL_INT(50, link_bench_count("t181", link_bench_say("", 500)));
}

static void test_without_an_object_nothing_is_sent(void)
{
    static const uint32_t none[] = {0};

    TEST_ASSERT_EQUAL_HEX32(0, map(TPDO_MAP, none));
    TEST_ASSERT_EQUAL_INT(0, link_bench_count("t181", link_bench_nmt(START, SECOND)));
    TEST_ASSERT_EQUAL_HEX32(0, link_bench_put(TPDO, 2, 1, 1));
    TEST_ASSERT_EQUAL_STRING("z\r", link_bench_say("t0800", 20));
}

static void test_sync_sends_every_nth_time(void)
{
    int frames = 0;

    TEST_ASSERT_EQUAL_HEX32(0, link_bench_put(TPDO, 2, 1, 3));
    (void)link_bench_nmt(START, 50);
    for (int n = 1; n <= 9; n++) {
        const int here = link_bench_count("t1812", link_bench_say("t0800", 20));

        TEST_ASSERT_EQUAL_INT(n % 3 == 0 ? 1 : 0, here);
        frames += here;
    }
    TEST_ASSERT_EQUAL_INT(3, frames);
    (void)link_bench_say("t0800", 20);
    TEST_ASSERT_EQUAL_HEX32(0, link_bench_put(TPDO, 2, 1, 3)); /* counts anew */
    TEST_ASSERT_EQUAL_INT(0, link_bench_count("t1812", link_bench_say("t0800", 20)));
    TEST_ASSERT_EQUAL_INT(0, link_bench_count("t1812", link_bench_say("t0800", 20)));
    (void)link_bench_nmt(PRE_OPERATIONAL, 1);
    (void)link_bench_nmt(START, 1);
    TEST_ASSERT_EQUAL_INT(0, link_bench_count("t1812", link_bench_say("t0800", 20)));
    TEST_ASSERT_EQUAL_HEX32(0, link_bench_put(TPDO, 1, 4, 0x181u | off));
    TEST_ASSERT_EQUAL_INT(0, link_bench_count("t1812", link_bench_say("t0800", 20)));
    TEST_ASSERT_EQUAL_INT(0, link_bench_count("t1812", link_bench_say("t0800", 20)));
}

static void test_with_type_0_sync_sends_what_has_changed(void)
{
    TEST_ASSERT_EQUAL_HEX32(0, link_bench_put(TPDO, 2, 1, 0));
    (void)link_bench_nmt(START, 50);
    TEST_ASSERT_EQUAL_INT(1, link_bench_count("t181", link_bench_say("t0800", 20)));
    TEST_ASSERT_EQUAL_INT(0, link_bench_count("t181", link_bench_say("t0800", 20)));
    (void)link_bench_put(0x6040, 0, 2, 6);
    TEST_ASSERT_EQUAL_INT(0, link_bench_count("t181", link_bench_say("", SECOND)));
    link_bench_heard("t18122102\r", link_bench_say("t0800", 20));
}

/* The later of two frames counts, and it acts once. */
static void test_what_waits_for_sync_acts_with_it_and_once(void)
{
    TEST_ASSERT_EQUAL_HEX32(0, link_bench_put(RPDO, 2, 1, 240));
    (void)link_bench_nmt(START, 1);
    (void)link_bench_say("t20120000", 2);
    (void)link_bench_say("t20120600", 2);
    TEST_ASSERT_EQUAL_HEX32(0x0240, link_bench_get(0x6041, 0));
    (void)link_bench_say("t0800", 2);
    TEST_ASSERT_EQUAL_HEX32(0x0221, link_bench_get(0x6041, 0));
    (void)link_bench_put(0x6040, 0, 2, 0);
    (void)link_bench_say("t0800", 2);
    TEST_ASSERT_EQUAL_HEX32(0x0240, link_bench_get(0x6041, 0));
    (void)link_bench_say("t20120600", 2);
    TEST_ASSERT_EQUAL_HEX32(0x06090030, link_bench_put(RPDO, 2, 1, 242)); /* changes nothing */
    TEST_ASSERT_TRUE(bench_link.pdos.received[0].waits);
    (void)link_bench_nmt(PRE_OPERATIONAL, 1);
    (void)link_bench_nmt(START, 1); /* what waited is forgotten */
    (void)link_bench_say("t0800", 2);
    TEST_ASSERT_EQUAL_HEX32(0x0240, link_bench_get(0x6041, 0));
    (void)link_bench_put(RPDO, 2, 1, 254);
    (void)link_bench_say("t20120600", 2);
    TEST_ASSERT_EQUAL_HEX32(0x0221, link_bench_get(0x6041, 0));
}

/* Not before the node is operational, and by its own identifier. */
static void test_sync_is_what_1005h_says(void)
{
    TEST_ASSERT_EQUAL_HEX32(0, link_bench_put(TPDO, 2, 1, 1));
    TEST_ASSERT_EQUAL_HEX32(0, link_bench_put(0x1005, 0, 4, 0x90));
    TEST_ASSERT_EQUAL_INT(0, link_bench_count("t1812", link_bench_say("t0900", 2)));
    (void)link_bench_nmt(START, 2);
    TEST_ASSERT_EQUAL_INT(0, link_bench_count("t1812", link_bench_say("t0800", 2)));
    TEST_ASSERT_EQUAL_INT(1, link_bench_count("t1812", link_bench_say("t0900", 2)));
    TEST_ASSERT_EQUAL_HEX32(0, link_bench_put(0x1005, 0, 4, 0x80000080)); /* as old masters do */
    TEST_ASSERT_EQUAL_INT(1, link_bench_count("t1812", link_bench_say("t0800", 2)));
    TEST_ASSERT_EQUAL_HEX32(0x06090030, link_bench_put(0x1005, 0, 4, 0x40000080)); /* makes none */
}

static void test_a_node_of_another_number_has_its_own_identifiers(void)
{
    bench.application.chosen.node_id = 5;
    (void)link_bench_say("C", 1);
    TEST_ASSERT_EQUAL_STRING("\rt705100\r", link_bench_say("O", 2));
    (void)link_bench_say("t00020105", 20);
    TEST_ASSERT_EQUAL_INT(1,
                          link_bench_count("t185", link_bench_say("t60584041600000000000", 1000)));
    TEST_ASSERT_EQUAL_INT(
        1, link_bench_count("t58584B41600040020000\r", link_bench_say("t60584041600000000000", 2)));
    (void)link_bench_say("t20520600", 2);
    TEST_ASSERT_EQUAL_INT(
        1, link_bench_count("t58584B41600021020000\r", link_bench_say("t60584041600000000000", 2)));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_presets_are_those_of_the_profile_for_drives);
    RUN_TEST(test_what_is_put_is_what_is_read_of_each_for_itself);
    RUN_TEST(test_there_are_four_each_way_of_eight_objects);
    RUN_TEST(test_identifiers_have_eleven_bits);
    RUN_TEST(test_while_a_pdo_exists_its_identifier_inhibit_time_and_mapping_stay);
    RUN_TEST(test_the_bit_of_remote_frames_may_be_left_out);
    RUN_TEST(test_transmission_types_between_240_and_254_mean_nothing);
    RUN_TEST(test_eight_bytes_are_mapped_and_not_a_bit_more);
    RUN_TEST(test_what_is_received_may_be_written_and_what_is_sent_be_read);
    RUN_TEST(test_a_received_frame_is_taken_apart_as_it_is_mapped);
    RUN_TEST(test_a_sent_frame_is_put_together_as_it_is_mapped);
    RUN_TEST(test_the_status_comes_every_100_ms_and_the_rest_on_change);
    RUN_TEST(test_an_inhibit_time_keeps_what_changes_all_the_time_from_the_bus);
    RUN_TEST(test_without_an_object_nothing_is_sent);
    RUN_TEST(test_sync_sends_every_nth_time);
    RUN_TEST(test_with_type_0_sync_sends_what_has_changed);
    RUN_TEST(test_what_waits_for_sync_acts_with_it_and_once);
    RUN_TEST(test_sync_is_what_1005h_says);
    RUN_TEST(test_a_node_of_another_number_has_its_own_identifiers);
    return UNITY_END();
}
