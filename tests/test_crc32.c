/* Tests the CRC-32 of .fxs files against known values and a plain bit-by-bit version. */
#include "src/base/crc32.h"

#include <string.h>

#include "check.h"

static fxs_crc32_table table;

static uint32_t bit_by_bit(const unsigned char *bytes, size_t count)
{
    uint32_t crc = ~0u;
    for (size_t i = 0; i < 8 * count; i++) {
        const uint32_t bit = (crc ^ bytes[i / 8] >> i % 8) & 1;
        crc = crc >> 1 ^ ((0u - bit) & 0xedb88320u);
    }
    return ~crc;
}

static void test_known(void)
{
    CHECK(fxs_crc32(&table, 0, "", 0) == 0);
    CHECK(fxs_crc32(&table, 0, "123456789", 9) == 0xcbf43926u);
    CHECK(fxs_crc32(&table, 0, "\0\0\0\0", 4) == 0x2144df1cu);
}

static void test_lengths(void)
{
    unsigned char bytes[100];
    for (size_t i = 0; i < sizeof bytes; i++)
        bytes[i] = (unsigned char)(i * i * 7 + 3 * i + 200);
    for (size_t first = 0; first < 9; first++)
        for (size_t count = 0; first + count <= sizeof bytes; count++) {
            const uint32_t whole = fxs_crc32(&table, 0, bytes + first, count);
            CHECK(whole == bit_by_bit(bytes + first, count));
            for (size_t part = 0; part <= count; part += 5) {
                const uint32_t crc = fxs_crc32(&table, 0, bytes + first, part);
                CHECK(fxs_crc32(&table, crc, bytes + first + part, count - part) == whole);
            }
        }
}

int main(void)
{
    fxs_crc32_fill(&table);
    RUN(test_known);
    RUN(test_lengths);
    return check_report();
}
