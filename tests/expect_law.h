// A law's verdict as a test's expectation: what is wrong is said.
#pragma once

#include "tests/support/surface_laws.h"

#include <gtest/gtest.h>

#define EXPECT_LAW(verdict)                \
    do {                                   \
        const Verdict v = (verdict);       \
        EXPECT_TRUE(v.holds()) << v.fault; \
    } while (false)
