/* test_store.c: the parameters in flash: whatever is cut off, the last good record is found. */
#include "store.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <string.h>

#include <cmocka.h>

enum { VALUES = 95 };

static uint32_t flash[STORE_WORDS];

static void erase(uint32_t area) {
    for (uint32_t i = 0; i < STORE_AREA; i++)
        flash[area * STORE_AREA + i] = STORE_BLANK;
}

static void erase_all(void) {
    for (uint32_t area = 0; area < STORE_AREAS; area++)
        erase(area);
}

/* As a board starts. */
static store start(void) {
    store s;
    const uint32_t area = store_to_erase(flash);
    if (area < STORE_AREAS)
        erase(area);
    store_open(&s, flash);
    return s;
}

/* Writes value + i at place i; the supply goes after so many words. False: it was cut, or there was no room.
 */
static bool save(store *s, uint32_t value, uint32_t words) {
    uint32_t at, word;
    if (!store_begin(s, VALUES))
        return false;
    while (store_step(s, value + store_wants(s), &at, &word)) {
        if (words-- == 0)
            return false;
        assert_true(at < STORE_WORDS);
        flash[at] &= word;
    }
    return !s->failed;
}

static void assert_holds(const store *s, uint32_t value) {
    uint32_t n = 0;
    const uint32_t *got = store_values(s, &n);
    assert_non_null(got);
    assert_int_equal(n, VALUES);
    for (uint32_t i = 0; i < n; i++)
        assert_int_equal(got[i], value + i);
}

static void test_check(void **state) {
    (void)state;
    assert_int_equal(store_check(0, 0x34333231), 0x9be3e0a3);                          /* CRC-32 of "1234" */
    assert_int_equal(store_check(store_check(0, 0x34333231), 0x38373635), 0x9ae0daaf); /* of "12345678" */
}

static void test_empty(void **state) {
    uint32_t n;
    (void)state;
    erase_all();
    store s = start();
    assert_null(store_values(&s, &n));
    assert_int_equal(s.bad, 0);
    assert_true(save(&s, 7, STORE_WORDS));
    assert_holds(&s, 7);
    s = start();
    assert_holds(&s, 7);
    store_open(&s, NULL);
    assert_null(store_values(&s, &n));
    assert_false(store_begin(&s, VALUES));
}

/* In one session twice six records fit where nothing was; from then on at least six after each start. */
static void test_room(void **state) {
    uint32_t value = 1000;
    (void)state;
    erase_all();
    for (int session = 0; session < 20; session++) {
        store s = start();
        int n = 0;
        if (session > 0)
            assert_holds(&s, value);
        while (save(&s, value + 1000, STORE_WORDS)) {
            value += 1000;
            n++;
            assert_holds(&s, value);
        }
        assert_int_equal(n, session == 0 ? 12 : 6);
        assert_int_equal(s.bad, 0);
    }
}

/* At every word of every record of a long life. */
static void test_cut(void **state) {
    (void)state;
    for (uint32_t cut = 0; cut < VALUES + 3; cut++) {
        uint32_t value = 5000;
        erase_all();
        store s = start();
        assert_true(save(&s, value, STORE_WORDS));
        for (int k = 0; k < 40; k++) {
            s = start();
            assert_holds(&s, value);
            const bool cuts = k % 3 != 2;
            if (save(&s, value + 100, cuts ? cut : STORE_WORDS))
                value += 100;
            else
                assert_true(cuts);
        }
        s = start();
        assert_holds(&s, value);
    }
}

/* An erasure that was cut off leaves anything in the area; it is begun again. */
static void test_cut_erasure(void **state) {
    (void)state;
    erase_all();
    store s = start();
    for (uint32_t k = 1; k <= 7; k++)
        assert_true(save(&s, 1000 * k, STORE_WORDS));
    assert_int_equal(s.good, STORE_AREA); /* in the second */
    assert_int_equal(store_to_erase(flash), 0);
    for (uint32_t i = 0; i < STORE_AREA; i += 3)
        flash[i] = STORE_BLANK;
    s = start();
    assert_holds(&s, 7000);
    assert_true(save(&s, 8000, STORE_WORDS));
    assert_holds(&s, 8000);
}

/* A bit that has fallen over is seen, and the record before it holds. */
static void test_damage(void **state) {
    uint32_t n;
    (void)state;
    for (uint32_t bit = 0; bit < 32 * (VALUES + 3); bit += 7) {
        erase_all();
        store s = start();
        assert_true(save(&s, 100, STORE_WORDS));
        assert_true(save(&s, 300, STORE_WORDS));
        flash[STORE_RECORD + bit / 32] ^= 1u << bit % 32;
        s = start();
        assert_holds(&s, 100);
        assert_int_equal(s.bad, 1);
        flash[bit / 32] ^= 1u << bit % 32;
        store_open(&s, flash);
        assert_null(store_values(&s, &n));
        assert_int_equal(s.bad, 2);
        s = start(); /* nothing good is left to keep */
        assert_true(save(&s, 900, STORE_WORDS));
        assert_holds(&s, 900);
    }
}

/* A word that does not take is noticed. */
static void test_worn_out(void **state) {
    (void)state;
    erase_all();
    store s = start();
    assert_true(save(&s, 100, STORE_WORDS));
    flash[STORE_RECORD + 9] = 0;
    assert_false(save(&s, 300, STORE_WORDS));
    assert_true(s.failed);
    assert_holds(&s, 100);
    assert_true(save(&s, 500, STORE_WORDS));
    assert_holds(&s, 500);
}

const struct CMUnitTest tests[] = {
    cmocka_unit_test(test_check),       cmocka_unit_test(test_empty),
    cmocka_unit_test(test_room),        cmocka_unit_test(test_cut),
    cmocka_unit_test(test_cut_erasure), cmocka_unit_test(test_damage),
    cmocka_unit_test(test_worn_out),    {0},
};
